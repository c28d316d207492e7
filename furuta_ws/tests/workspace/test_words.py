"""Options, help, values and keys of results use the words of the table in CONTRIBUTING."""

import re
from collections.abc import Iterator, Mapping
from typing import Any

import click
import pytest
from processes.conftest import commands
from sources import ROOT

import furuta
from furuta_bringup.main import furuta as furuta_command

TABLE = re.search(
    r"\| word \| meaning \| not \|\n\|---.*\n((?:\|.*\n)+)", (ROOT / "CONTRIBUTING.md").read_text()
)
# Keys that have one of the words in another sense.
KEYS = {"rotation_rate_rad_s", "rotations", "velocity_amplitude_rad_s"}


def unwanted() -> list[str]:
    """The words at the right of the table."""
    assert TABLE is not None
    rows = [row.strip("| ").split(" | ") for row in TABLE[1].splitlines()]
    return [word for *_, words in rows for word in words.split(", ")]


def texts() -> Iterator[str]:
    """Help and values of all commands."""
    for names, command in commands(furuta_command):
        yield command.get_help(click.Context(command, info_name=" ".join(names)))
        for option in command.params:
            if isinstance(option.type, click.Choice):
                yield from map(str, option.type.choices)


def words_in(values: Any) -> Iterator[str]:
    """Keys of a result, and text in it."""
    if isinstance(values, Mapping):
        for key, value in values.items():
            yield "" if key in KEYS else str(key)
            yield from words_in(value)
    elif isinstance(values, list):
        for each in values:
            yield from words_in(each)
    elif isinstance(values, str):
        yield values


def found_in(texts: Iterator[str]) -> list[str]:
    """The unwanted words among them."""
    text = " ".join(texts).lower().replace("_", " ")
    return [word for word in unwanted() if re.search(rf"\b{word}s?\b", text)]


def test_help_has_the_words_of_the_table() -> None:
    assert len(unwanted()) > 10
    assert not found_in(texts())


@pytest.mark.parametrize("gain", [None, [0.0, -7.0, -60.0, -20.0], [0.0, 0.0, -60.0, -20.0]])
def test_results_have_the_words_of_the_table(gain: list[float] | None) -> None:
    loop = furuta.make_loop({} if gain is None else {"gain": gain})
    cycle, model = furuta.limit_cycle(loop), furuta.linear_model(loop, nyquist=True)
    results = [cycle, model, furuta.predict_cycles(loop), furuta.simulate(loop, 5.0)]
    assert not found_in(words_in([each.to_dict() for each in results]))
    kinds = ("limit_cycle", "steady", "rest", "unbounded", "irregular")
    assert cycle.kind in kinds

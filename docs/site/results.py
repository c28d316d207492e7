"""Writes the tables of docs/results.md anew: ``python docs/site/results.py``.

Limit cycles and the table of truths are computed. The benchmarks are read from ``output/``: call
``make bench`` before. Text, heads and the selection of
compensations and benchmarks stay as the page has them.
"""

import json
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import furuta

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "results.md"
LAWS = ("coulomb", "stiction", "stribeck", "lugre", "dahl")


def renewed(page: str, heading: str, rows: Iterable[Iterable[str]]) -> str:
    """The page with these rows in the table below a heading."""
    lines = "".join(f"| {' | '.join(row)} |\n" for row in rows)
    table = re.compile(rf"(^## {heading}\n.*?^\|---.*?\n)(?:\|.*?\n)*", re.DOTALL | re.MULTILINE)
    return table.sub(lambda found: found[1] + lines, page)


def cycle_rows() -> Iterator[list[str]]:
    """Exact and predicted limit cycles of every law."""
    for law in LAWS:
        cycle = furuta.limit_cycle(law=law)
        (predicted,) = furuta.predict_cycles(law=law).cycles
        amplitudes = (
            predicted.phi_peak_to_peak_rad,
            cycle.phi_peak_to_peak_rad,
            cycle.theta_peak_to_peak_rad,
        )
        values = map(number, (*amplitudes, cycle.period_s))
        yield [law, *values, f"{cycle.stuck_fraction:.0%}"]


def truth_rows(page: str) -> Iterator[list[str]]:
    """Residual of the compensations on the truths that the page names, in mrad; best bandwidth."""
    command = [str(ROOT / "furuta"), "compare", "--truths", "--json"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    report = json.loads(done.stdout)
    best = {row["rig"]: row for row in report["best_bandwidths"]}
    residuals: dict[str, dict[str, Any]] = {}
    for row in report["rows"]:
        residuals.setdefault(row["rig"], {})[row["candidate"]] = row["phi_peak_to_peak_rad"]
    (names,) = re.findall(r"^\| truth \| (.*) \| best bandwidth \| with it \|$", page, re.MULTILINE)
    table = page[page.index("| truth |") :]
    for truth, values in residuals.items():
        if f"\n| {truth} |" not in table:
            continue
        values["with it"] = best[truth]["residual_at_best_rad"]
        *others, last = (milliradians(values[name]) for name in (*names.split(" | "), "with it"))
        yield [truth, *others, number(best[truth]["best_bandwidth"]), last]


def speed_rows(page: str) -> Iterator[list[str]]:
    """The last benchmark's figures, of those that the page names."""
    figures = output("bench.json")
    for name, meaning in re.findall(r"^\| `(\w+)` \| .*? \| (.*) \|$", page, re.MULTILINE):
        yield [f"`{name}`", number(figures[name]), meaning]


def output(name: str) -> Any:
    """What ``make bench`` has written."""
    file = ROOT / "output" / name
    if not file.exists():
        sys.exit(f"error: no {file}: call make bench before")
    return json.loads(file.read_text())


def number(value: float | None) -> str:
    """A number with four digits; a dash for none."""
    return "–" if value is None else f"{value:.4g}"


def milliradians(value: float | None) -> str:
    """An angle [rad] in mrad; a fall has none."""
    return "falls" if value is None else f"{1000.0 * value:.1f}"


if __name__ == "__main__":
    text = PAGE.read_text()
    text = renewed(text, "Speed", speed_rows(text))
    text = renewed(text, "Predicted and exact limit cycles", cycle_rows())
    PAGE.write_text(renewed(text, "Compensations on truths.*?", truth_rows(text)))

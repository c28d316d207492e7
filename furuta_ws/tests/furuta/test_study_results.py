"""Results of studies: what is said first, their dictionaries, and what their figures show."""

from math import inf
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest

import furuta
from furuta.results.studies import Comparison, SwingUp
from furuta.studies.comparison.candidates import Candidate
from furuta.studies.comparison.comparison import Table
from furuta.studies.swing_up import Knocks, SwingUpRun, starts_summary

mpl.use("Agg")
COUNT = 0.025


def comparison(sizes: dict[str, list[float]], steps: list[float]) -> Comparison:
    """Candidates with these residuals, and steps of the command."""
    residual = np.array(list(sizes.values()))
    commands = np.broadcast_to(steps, residual.T.shape).T
    rigs = [f"rig {k}" for k in range(residual.shape[1])]
    survived = np.empty((*residual.shape, 0), bool)
    beside = len(sizes) * [0.05], len(sizes) * [0.002]
    three = commands, commands, commands
    found = Table(list(sizes), rigs, residual, *three, survived, residual[0], *beside)
    return Comparison(found, COUNT, [Candidate(name, {"a": name}) for name in sizes], {})


def test_best_here_is_told_from_the_setting_recommended() -> None:
    """The smoothest within a count; a fall is no number; named rigs are listed."""
    sizes = {"none": 3 * [0.5], "recommended": 3 * [0.01], "smooth": 3 * [0.02]}
    found = comparison(sizes | {"falls": [0.1, 0.1, inf]}, [1.0, 0.9, 0.1, 0.0])
    text = " ".join(found.sentence().split())
    assert text.startswith(
        "Best here: smooth. On 95 % of 3 rigs the arm swings by at most 0.02 rad"
    )
    assert "The setting named recommended is in place 1 of 4, with 0.01 rad (0.573°)." in text
    result = found.to_dict()
    assert (result["recommended"], result["recommended_settings"]) == ("smooth", {"a": "smooth"})
    assert [row["candidate"] for row in result["ranking"]] == [
        "recommended",
        "smooth",
        "none",
        "falls",
    ]
    assert "rows" not in result
    found.by_rig = True
    assert found.to_dict()["rows"][3] == {
        "rig": "rig 0",
        "candidate": "falls",
        "phi_peak_to_peak_rad": 0.1,
    }
    found.every_column = True
    assert "delay margin" in " ".join(found.report().split())
    lines = found.report().splitlines()
    assert lines[-1].split() == ["rig", "2", "0.5", "0.01", "0.02", "–"]
    alone = comparison({"recommended": 2 * [0.01]}, [1.0]).sentence()
    assert "place" not in alone
    assert comparison({"lugre": [0.01, inf]}, [1.0]).sentence().startswith("None is best here")


def test_a_sweep_says_where_the_arm_swings_least_and_most() -> None:
    """Also what is impossible; rows that are not kept cannot be drawn."""
    values: dict[str, Any] = {"plant.friction.alpha0": [0.1, 0.2, -1.0]}
    runs = furuta.sweep(values, seconds=5.0)
    result = runs.to_dict()
    sizes = runs["phi_peak_to_peak_rad"][:2]
    assert (result["runs"], result["fell"], result["impossible"]) == (3, 0, 1)
    assert result["smallest"]["phi_peak_to_peak_rad"] == min(sizes)
    assert result["largest"]["phi_peak_to_peak_rad"] == max(sizes)
    assert len(result["rows"]) == 3
    text = " ".join(runs.report().split())
    assert text.startswith("3 runs; 1 impossible: friction.alpha0 must be 0 to 100000 V, given -1.")
    rest = furuta.sweep(values, seconds=5.0, keep_runs=False)
    assert (rest.rows, rest.sentence()) == (0, runs.sentence())
    with pytest.raises(furuta.ParameterError, match="not kept"):
        rest.plot()


def test_a_sweep_is_drawn_as_curves_or_as_a_map() -> None:
    """A curve has the runs of a text or of few numbers; more combinations are a map of two."""
    texts = furuta.sweep(["omega1=6:8:3", "compensation=none,coulomb"], seconds=1.0)
    axis = texts.plot()
    assert [line.get_label() for line in axis.lines] == ["none", "coulomb"]
    drawn = texts["phi_peak_to_peak_rad"][texts["compensation"] == "coulomb"]
    assert axis.lines[1].get_ydata() == pytest.approx(drawn)
    alone = furuta.sweep({"omega1": [6.0, 7.0, 8.0]}, seconds=0.1).plot()
    assert [len(line.get_xdata()) for line in alone.lines] == [3]
    grid = furuta.sweep(
        {"omega1": np.linspace(6, 8, 11), "omega2": np.linspace(4, 6, 12)}, None, 0.1
    )
    (mesh,) = grid.plot().collections
    cells = np.reshape(mesh.get_array(), (11, 12))  # omega2 has more values: it is across
    assert np.asarray(cells) == pytest.approx(grid["phi_peak_to_peak_rad"].reshape(11, 12))
    many = {"seed": range(11), "omega1": [6.0, 7.0], "omega2": np.linspace(4, 6, 6)}
    with pytest.raises(furuta.ParameterError, match="at most 10 curves"):
        furuta.sweep(many, seconds=0.02).plot()


def test_swing_ups_are_counted_and_drawn() -> None:
    """A start that is never upright lowers the curve's end."""
    theta = np.linspace(np.pi, 0.0, 10)
    runs = [SwingUpRun(t, t > 3, 0.5, 0.6, theta) for t in (2.0, 4.0)]
    runs.append(SwingUpRun(float("nan"), False, 0.9, 1.0, np.empty(0)))
    found = SwingUp(**vars(starts_summary(runs)), runs=runs, knocks=Knocks(5, 4, 3, 50.0))
    assert found.sentence() == (
        "2 of 3 starts are upright within 10 s, half of them within 3 s; 1 beyond a limit. "
        "After 5 pushes the pendulum fell 4 times and swung up 3 times."
    )
    assert found.to_dict()["swing_ups"] == 3
    angle, upright, arm = found.plot()
    assert len(angle.lines) == 2
    assert np.nanmax(upright.lines[0].get_ydata()) == pytest.approx(2 / 3)
    assert len(arm.lines[0].get_xdata()) == 3

"""``furuta nyquist``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
import numpy as np

from furuta.limit_cycles.ideal_loop import IdealLoop
from furuta.studies.analysis_options import AnalysisOptions
from furuta.studies.loop_note import loop_note
from furuta_bringup.file_types import FIGURE
from furuta_bringup.options import ideal_options, json_option, model_options, print_json
from furuta_model.parameters import ParameterError
from furuta_model.transfer import FIGURE_4, open_loop_poles, transfer


@click.command()
@click.option("--figure-4", is_flag=True, help="Use the paper's four feedbacks.")
@click.option("--out", type=FIGURE, help="Draw the Nyquist plot.")
@ideal_options
@model_options
@json_option
def command(
    figure_4: bool,
    out: Path | None,
    feedback: tuple[float, float, float, float] | None,
    law: str | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compute G(s) from -F to the arm's speed, eq. (10), and its crossings of the real axis.

    Limit cycles are possible where G crosses the negative real axis: -1/N of Coulomb friction
    covers it.
    """
    if figure_4 and feedback is not None:
        raise ParameterError("--figure-4 cannot be combined with --feedback")
    given = AnalysisOptions(files, assignments, law, feedback).checked_loop()
    cases = {"": given}
    if figure_4:
        cases = {case: given.with_gains(each) for case, each in FIGURE_4.items()}
    if out is not None:
        _draw(cases, out)
    results = {case: _result(each) for case, each in cases.items()}
    if as_json:
        print_json(_joined(results) if figure_4 else results[""])
        return
    for case, result in results.items():
        _print(case, result)


def _draw(cases: dict[str, IdealLoop], out: Path) -> None:
    from furuta.figures.nyquist import draw_nyquist

    draw_nyquist(cases, out)


def _result(given: IdealLoop) -> dict[str, Any]:
    g = transfer(given.body, given.gains)
    return {
        "feedback": given.gains,
        "numerator": g.numerator,
        "denominator": g.denominator,
        "open_loop_poles": _pairs(open_loop_poles(given.body)),
        "poles": _pairs(g.poles),
        "stable_without_friction": g.stable,
        "crossings": [crossing._asdict() for crossing in g.crossings],
        "note": loop_note(given.body, given.gains, given.law),
    }


def _joined(results: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """All crossings in one list, each with its case, and the results by case."""
    crossings = [
        {"case": case, **crossing}
        for case, result in results.items()
        for crossing in result["crossings"]
    ]
    return {"crossings": crossings, "cases": results}


def _pairs(poles: np.ndarray) -> list[list[float]]:
    return [[float(pole.real), float(pole.imag)] for pole in np.asarray(poles, complex)]


def _print(case: str, result: dict[str, Any]) -> None:
    l1, l2, l3, l4 = result["feedback"]
    title = f"{case}) " if case else ""
    print(f"{title}u = {l1:.4g} φ {l2:+.4g} φ̇ {l3:+.4g} θ {l4:+.4g} θ̇")
    print("  poles: " + ", ".join(f"{re:.4g}{im:+.4g}j" for re, im in result["poles"]))
    print(f"  stable without friction: {'yes' if result['stable_without_friction'] else 'no'}")
    for crossing in result["crossings"]:
        print(f"  crosses at ω = {crossing['omega_rad_s']:.5g} rad/s: G = {crossing['real']:.5g}")
    if not result["crossings"]:
        print("  does not cross the negative real axis")
    print(f"  {result['note']}")

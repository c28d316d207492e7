"""``furuta describing-function``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from furuta.describing_functions.predicted_cycles import Prediction, predict_cycles
from furuta.describing_functions.steady_rotation import steady_rotations
from furuta.limit_cycles.ideal_loop import IdealLoop
from furuta.studies.analysis_options import AnalysisOptions
from furuta.studies.loop_note import loop_note
from furuta_bringup.file_types import FIGURE
from furuta_bringup.options import ideal_options, json_option, model_options, print_json
from furuta_model.friction.parameters import Friction
from furuta_model.transfer import transfer

INCOMPLETE = "The winding number does not match the cycles found; some may be missing."


@click.command()
@click.option("--out", type=FIGURE, help="Draw G and -1/N.")
@click.option("--curves", type=FIGURE, help="Draw friction over speed for all laws.")
@click.option("--presliding", type=FIGURE, help="Draw presliding, with Maxwell slip.")
@ideal_options
@model_options
@json_option
def command(
    out: Path | None,
    curves: Path | None,
    presliding: Path | None,
    feedback: tuple[float, float, float, float] | None,
    law: str | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Predict limit cycles with the describing function of friction: 1 + G(jω) N(A, ω) = 0.

    The prediction uses first harmonics only; `furuta limit-cycle` is exact.
    """
    given = AnalysisOptions(files, assignments, law, feedback).checked_loop()
    prediction = predict_cycles(transfer(given.body, given.gains), given.law)
    _draw(given, prediction, out)
    _draw_laws(given.law.parameters, curves, presliding)
    result = _result(given, prediction)
    if as_json:
        print_json(result)
    else:
        _print(result)


def _draw(given: IdealLoop, prediction: Prediction, out: Path | None) -> None:
    if out is not None:
        from furuta.figures.describing_function import draw_describing_function

        draw_describing_function(given, prediction, out)


def _draw_laws(p: Friction, curves: Path | None, presliding: Path | None) -> None:
    if curves is not None:
        from furuta.figures.friction_laws import draw_friction_laws

        draw_friction_laws(p, curves)
    if presliding is not None:
        from furuta.figures.presliding import draw_presliding

        draw_presliding(p, presliding)


def _result(given: IdealLoop, prediction: Prediction) -> dict[str, Any]:
    note = loop_note(given.body, given.gains, given.law)
    return {
        "law": given.law.name,
        "feedback": given.gains,
        "stable_without_friction": transfer(given.body, given.gains).stable,
        "cycles": [cycle._asdict() for cycle in prediction.cycles],
        "rotations": [
            each._asdict() for each in steady_rotations(given.body, given.gains, given.law)
        ],
        "searched": {
            "omega_rad_s": prediction.omega_range_rad_s,
            "phi_amplitude_rad": prediction.phi_amplitude_range_rad,
        },
        "complete": prediction.complete,
        "note": note if prediction.complete else f"{INCOMPLETE} {note}",
    }


def _print(result: dict[str, Any]) -> None:
    l1, l2, l3, l4 = result["feedback"]
    print(f"{result['law']}, u = {l1:.4g} φ {l2:+.4g} φ̇ {l3:+.4g} θ {l4:+.4g} θ̇")
    for cycle in result["cycles"]:
        kind = "stable" if cycle["stable"] else "unstable"
        print(
            f"  {kind} limit cycle: arm {cycle['phi_peak_to_peak_rad']:.4f} rad peak to peak, "
            f"period {cycle['period_s']:.4f} s, ω = {cycle['omega_rad_s']:.4f} rad/s, "
            f"A = {cycle['velocity_amplitude_rad_s']:.4f} rad/s"
        )
    if not result["cycles"]:
        print("  no limit cycle")
    for rotation in result["rotations"]:
        kind = "stable" if rotation["stable"] else "unstable"
        print(f"  {kind} rotation at {rotation['rate_rad_s']:.4g} rad/s")
    print(f"  {result['note']}")

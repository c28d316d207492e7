"""``furuta convergence``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
import numpy as np

from furuta.convergence.convergence import Convergence, convergence
from furuta.convergence.error_loop import ErrorLoop, error_loop, error_loop_for
from furuta.convergence.friction_passivity import friction_passivity
from furuta.convergence.passive_error import passive_error
from furuta.limit_cycles.ideal_loop import IdealLoop
from furuta.studies.analysis_options import AnalysisOptions
from furuta_bringup.file_types import FIGURE
from furuta_bringup.options import feedback_option, json_option, model_options, print_json
from furuta_sim.settings.settings import load_settings, loop
from furuta_sim.simulation.closed_loop import Loop

NEVER_SATISFIED = (
    "No L and no K satisfies the condition with the arm angle alone as the error: G then has the "
    "zero √(δ/β) of the pendulum in the right half plane."
)
MODEL_MISMATCH = (
    "The condition assumes the true model; here the nodes' model or friction differs from the "
    "plant's."
)


@click.command()
@click.option("--out", type=FIGURE, help="Draw G.")
@feedback_option
@model_options
@json_option
def command(
    out: Path | None,
    feedback: tuple[float, float, float, float] | None,
    files: tuple[Path, ...],
    assignments: tuple[str, ...],
    as_json: bool,
) -> None:
    """Check the passivity condition for convergence of the LuGre observer.

    The condition depends on the plant's model and friction, on the controller's gain L or
    --feedback, and on the observer's gain K (--set observer_gain=0.1).
    """
    ideal = AnalysisOptions(files, assignments, "lugre", feedback).checked_loop()
    nominal = loop(load_settings(files, assignments))
    gain, friction = nominal.observer.observer_gain, ideal.law.parameters
    g = error_loop(ideal.body, ideal.gains, friction)
    verdict = convergence(g, gain, friction)
    c = passive_error(ideal.body, ideal.gains, friction)
    other = None
    if c is not None:
        other = error_loop_for(ideal.body, ideal.gains, friction, c.tolist())
    if out is not None:
        from furuta.figures.convergence import draw_convergence

        draw_convergence(g, other, gain, verdict, out)
    result = {
        **_result(ideal, gain, g, verdict, _model_is_exact(nominal)),
        **_friction(ideal),
        "passive_error": None if other is None else _passive(c, other, ideal),
    }
    if as_json:
        print_json(result)
    else:
        _print(result)


def _model_is_exact(nominal: Loop) -> bool:
    """Whether observer and controller have the plant's friction and model."""
    same_friction = nominal.observer.friction == nominal.plant.friction.parameters
    return same_friction and nominal.controller.model == nominal.plant.model


def _result(
    ideal: IdealLoop, gain: float, g: ErrorLoop, verdict: Convergence, exact: bool
) -> dict[str, Any]:
    fields = verdict._asdict()
    positive, negative = verdict.largest_stable_gain
    return {
        **fields,
        "reason": f"{verdict.reason}. {NEVER_SATISFIED}" + ("" if exact else f" {MODEL_MISMATCH}"),
        "L": [-each for each in ideal.gains],
        "K": gain,
        "exact_model": exact,
        "numerator": g.numerator.tolist(),
        "denominator": g.denominator.tolist(),
        "zeros": _pairs(g.zeros),
        "poles": _pairs(g.poles),
        "static_gain": g.static_gain,
        "high_frequency_gain": g.high_frequency_gain,
        "relative_degree": g.relative_degree,
        "largest_stable_gain": {"positive": positive, "negative": negative},
    }


def _friction(ideal: IdealLoop) -> dict[str, Any]:
    passivity = friction_passivity(ideal.law.parameters)
    return {
        "friction_passive": passivity.passive,
        "friction_passive_viscous": passivity.viscous_needed,
        "friction_dissipates_up_to_rad_s": passivity.up_to_rad_s,
    }


def _passive(c: Any, other: ErrorLoop, ideal: IdealLoop) -> dict[str, Any]:
    verdict = convergence(other, 1.0, ideal.law.parameters)
    return {
        "c": np.asarray(c).tolist(),
        "smallest_real_part": verdict.smallest_real_part,
        "at_omega_rad_s": verdict.at_omega_rad_s,
    }


def _pairs(roots: np.ndarray) -> list[list[float]]:
    return [[float(each.real), float(each.imag)] for each in np.asarray(roots, complex)]


def _print(result: dict[str, Any]) -> None:
    verdict = "satisfied" if result["satisfied"] else "not satisfied"
    print(f"passivity condition {verdict} for K = {result['K']:.4g} 1/s")
    print(f"  {result['reason']}")
    for name in ("zeros", "poles"):
        print(f"  {name}: " + ", ".join(f"{re:.4g}{im:+.4g}j" for re, im in result[name]))
    print(f"  static gain {result['static_gain']:.4g}")
    if np.isfinite(result["smallest_real_part"]):
        print(
            f"  smallest real part, with the sign of K: {result['smallest_real_part']:.4g} at ω = "
            f"{result['at_omega_rad_s']:.4g} rad/s"
        )
        for low, high in result["violated_rad_s"]:
            print(f"  negative for ω from {low:.4g} to {high:.4g} rad/s")
        print(f"  satisfied while the arm is faster than {result['holds_above_rad_s']:.3g} rad/s")
    limits = result["largest_stable_gain"]
    print(
        f"  near rest, without leak, stable up to |K| = {limits['positive']:.4g} for K > 0 and "
        f"{limits['negative']:.4g} for K < 0; rightmost pole at this K "
        f"{result['fastest_growth']:.4g} 1/s"
    )
    print(
        f"  without correction the error decays by the factor e over "
        f"{result['forgetting_travel_rad']:.4g} rad"
    )
    print(
        f"  friction passive: {'yes' if result['friction_passive'] else 'no'} (needs viscous >= "
        f"{result['friction_passive_viscous']:.4g} V s/rad); dissipates up to "
        f"{result['friction_dissipates_up_to_rad_s']:.4g} rad/s"
    )
    if result["passive_error"] is not None:
        c = ", ".join(f"{each:.4g}" for each in result["passive_error"]["c"])
        print(f"  an error c·x that satisfies it: c = ({c})")

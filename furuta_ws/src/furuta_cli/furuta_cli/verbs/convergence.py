"""``furuta convergence``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
import numpy as np

from furuta_analysis.convergence.convergence import (
    Convergence,
    ErrorLoop,
    convergence,
    error_loop,
    error_loop_of,
)
from furuta_analysis.convergence.friction_passivity import friction_passivity
from furuta_analysis.convergence.passive_error import passive_error
from furuta_analysis.limit_cycles.ideal_loop import IdealLoop
from furuta_analysis.simulation.closed_loop import Loop
from furuta_cli.options import feedback_option, json_option, model_options, print_json
from furuta_graph.settings import load_settings, loop
from furuta_studies.ideal_loop import LoopOptions

NEVER = (
    "No L and no K satisfies the condition with an error of the arm angle alone: G then has the "
    "zero √(δ/β) in the right half plane, which is a property of the pendulum."
)
INEXACT = (
    "The condition assumes an exact model; here the nodes' model or friction differs from the "
    "plant's."
)


@click.command()
@click.option("--out", type=click.Path(path_type=Path), metavar="FILE.png", help="Draw G.")
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
    """Does the LuGre observer satisfy the passivity condition for convergence, [4], [6], [10]?

    For the plant's model and friction, the controller's gain L or --feedback, and the observer's
    gain K (--set observer_gain=0.1).
    """
    given = LoopOptions(files, assignments, "lugre", feedback).checked_loop()
    made = loop(load_settings(files, assignments))
    gain, friction = made.observer.observer_gain, given.law.parameters
    g = error_loop(given.body, given.gains, friction)
    verdict = convergence(g, gain, friction)
    c = passive_error(given.body, given.gains, friction)
    other = None
    if c is not None:
        other = error_loop_of(given.body, given.gains, friction, c.tolist())
    if out is not None:
        from furuta_figures.convergence import draw

        draw(g, other, gain, verdict, out)
    result = {
        **_result(given, gain, g, verdict, _exact(made)),
        **_friction(given),
        "passive_error": None if other is None else _passive(c, other, given),
    }
    if as_json:
        print_json(result)
    else:
        _print(result)


def _exact(made: Loop) -> bool:
    """Whether observer and controller have the plant's own model and friction."""
    known = made.observer.friction == made.plant.friction
    return known and made.controller.model == made.plant.model


def _result(
    given: IdealLoop, gain: float, g: ErrorLoop, verdict: Convergence, exact: bool
) -> dict[str, Any]:
    fields = verdict._asdict()
    positive, negative = verdict.largest_stable_gain
    return {
        **fields,
        "reason": f"{verdict.reason}. {NEVER}" + ("" if exact else f" {INEXACT}"),
        "L": [-each for each in given.gains],
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


def _friction(given: IdealLoop) -> dict[str, Any]:
    passivity = friction_passivity(given.law.parameters)
    return {
        "friction_passive": passivity.passive,
        "friction_passive_viscous": passivity.viscous_needed,
        "friction_dissipates_up_to_rad_s": passivity.up_to_rad_s,
    }


def _passive(c: Any, other: ErrorLoop, given: IdealLoop) -> dict[str, Any]:
    verdict = convergence(other, 1.0, given.law.parameters)
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
            f"  smallest real part, sign of K: {result['smallest_real_part']:.4g} at ω = "
            f"{result['at_omega_rad_s']:.4g} rad/s"
        )
        for low, high in result["violated_rad_s"]:
            print(f"  negative for ω from {low:.4g} to {high:.4g} rad/s")
        print(f"  holds while the arm is faster than {result['holds_above_rad_s']:.3g} rad/s")
    limits = result["largest_stable_gain"]
    print(
        f"  about rest, without leak, stable up to |K| = {limits['positive']:.4g} for K > 0 and "
        f"{limits['negative']:.4g} for K < 0; rightmost pole at this K "
        f"{result['fastest_growth']:.4g} 1/s"
    )
    print(
        f"  without correction the error falls by e over {result['forgetting_travel_rad']:.4g} rad"
    )
    print(
        f"  friction passive: {'yes' if result['friction_passive'] else 'no'} (needs viscous >= "
        f"{result['friction_passive_viscous']:.4g} V s/rad); dissipates up to "
        f"{result['friction_dissipates_up_to_rad_s']:.4g} rad/s"
    )
    if result["passive_error"] is not None:
        c = ", ".join(f"{each:.4g}" for each in result["passive_error"]["c"])
        print(f"  an error c·x that satisfies it: c = ({c})")

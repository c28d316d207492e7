"""Reports on the linear loop with friction: Nyquist plot, predicted cycles, and what they mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from furuta.describing_functions.predicted_cycles import Prediction
from furuta.describing_functions.steady_rotation import steady_rotations
from furuta.limit_cycles.ideal_loop import IdealLoop
from furuta.margins import pairs
from furuta_model.friction.laws import FrictionLaw
from furuta_model.pendulum import FurutaPendulum
from furuta_model.transfer import Transfer, transfer

ARM_FEEDBACK = "φ is fed back: the curve starts and ends at 0 and only its crossings count."
CREEPS_TO_REST = (
    "The slowest pole is real: the sliding arm may creep to l1 φ = F without a reversal and rest "
    "there against friction, instead of oscillating."
)


INCOMPLETE = "The winding number does not match the cycles found; some may be missing."


def nyquist_report(cases: Mapping[str, IdealLoop]) -> dict[str, Any]:
    """Crossings of the negative real axis by G of every loop, and G by the name of the case."""
    responses = {case: transfer(loop.body, loop.gains) for case, loop in cases.items()}
    return {
        "crossings": [
            {"case": case, **crossing._asdict()}
            for case, g in responses.items()
            for crossing in g.crossings
        ],
        "nyquist": {case: _response(loop, responses[case]) for case, loop in cases.items()},
    }


def _response(loop: IdealLoop, g: Transfer) -> dict[str, Any]:
    return {
        "feedback": loop.gains,
        "numerator": g.numerator,
        "denominator": g.denominator,
        "poles": pairs(g.poles),
        "stable_without_friction": g.stable,
        "note": loop_note(loop.body, loop.gains, loop.law),
    }


def prediction_report(loop: IdealLoop, prediction: Prediction) -> dict[str, Any]:
    """The predicted cycles and rotations of a loop, and what was searched."""
    note = loop_note(loop.body, loop.gains, loop.law)
    rotations = steady_rotations(loop.body, loop.gains, loop.law)
    return {
        "law": loop.law.name,
        "feedback": loop.gains,
        "stable_without_friction": transfer(loop.body, loop.gains).stable,
        "cycles": [cycle._asdict() for cycle in prediction.cycles],
        "rotations": [rotation._asdict() for rotation in rotations],
        "searched": {
            "omega_rad_s": prediction.omega_range_rad_s,
            "phi_amplitude_rad": prediction.phi_amplitude_range_rad,
        },
        "complete": prediction.complete,
        "note": note if prediction.complete else f"{INCOMPLETE} {note}",
    }


def loop_note(p: FurutaPendulum, feedback: Sequence[float], law: FrictionLaw) -> str:
    """What happens at ω = 0, and whether the loop is stable without friction."""
    g = transfer(p, feedback)
    parts = [] if g.stable or _only_speed_drifts(g) else [_unstable(g)]
    if feedback[0] != 0.0:
        parts.append(ARM_FEEDBACK)
        if g.stable and _slowest_pole(g).imag == 0.0:
            parts.append(CREEPS_TO_REST)
    elif feedback[1] == 0.0:
        parts.append(_acceleration(p, g, law))
    else:
        parts.append(_rotation(p, feedback, law))
    return " ".join(parts)


def _slowest_pole(g: Transfer) -> complex:
    return complex(max(g.poles, key=lambda pole: pole.real))


def _only_speed_drifts(g: Transfer) -> bool:
    """Whether the loop is unstable only because the arm speed is not fed back."""
    rest = g.poles[abs(g.poles) > 0.0]
    return len(rest) == len(g.poles) - 1 and bool((rest.real < 0.0).all())


def _unstable(g: Transfer) -> str:
    growth = max(g.poles.real)
    return (
        f"Without friction this loop is unstable (a pole with real part {growth:.3g} 1/s): "
        "large motions grow with any friction."
    )


def _rotation(p: FurutaPendulum, feedback: Sequence[float], law: FrictionLaw) -> str:
    rotations = steady_rotations(p, feedback, law)
    start = f"φ is not fed back: the curve starts at G(0) = -1/l2 = {-1 / feedback[1]:.4g}"
    if not rotations:
        return (
            f"{start}. Friction exceeds l2 v at every speed, so there is no steady rotation: a "
            "stuck arm is moved only by the falling pendulum."
        )
    rates = ", ".join(f"{r.rate_rad_s:.4g} rad/s" for r in rotations)
    kind = "stable" if all(r.stable for r in rotations) else "unstable"
    return (
        f"{start}, which predicts no oscillation but a steady rotation: at {rates} the positive "
        f"feedback l2 v cancels friction with the pendulum upright. This rotation is {kind}."
    )


def _acceleration(p: FurutaPendulum, g: Transfer, law: FrictionLaw) -> str:
    start = "Neither φ nor its speed is fed back: G has an integrator and is infinite at ω = 0."
    if g.denominator[2] <= 0.0:
        return start
    acceleration = law.parameters.alpha0 * p.delta / g.denominator[2]
    return (
        f"{start} Friction tilts the pendulum, and the tilt accelerates the arm in the direction "
        f"of motion without bound, initially by {acceleration:.3g} rad/s²."
    )

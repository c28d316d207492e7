"""What a Nyquist plot means for the arm, in words."""

from __future__ import annotations

from collections.abc import Sequence

from furuta_analysis.describing_functions.steady_rotation import steady_rotations
from furuta_analysis.describing_functions.transfer import Transfer, transfer
from furuta_model.friction.laws import FrictionLaw
from furuta_model.pendulum import FurutaPendulum

HELD = "φ is fed back: the curve starts and ends at 0 and only its crossings count."
LEANS = (
    "The slowest pole is real: the sliding arm may creep up to l1 φ = F without ever turning, and "
    "rest there against friction instead of the cycle."
)


def loop_note(p: FurutaPendulum, feedback: Sequence[float], law: FrictionLaw) -> str:
    """What happens at ω = 0, and whether the loop stands at all without friction."""
    g = transfer(p, feedback)
    parts = [] if g.stable or _drifts(g) else [_unstable(g)]
    if feedback[0] != 0.0:
        parts.append(HELD)
        if g.stable and _slowest_pole(g).imag == 0.0:
            parts.append(LEANS)
    elif feedback[1] == 0.0:
        parts.append(_acceleration(p, g, law))
    else:
        parts.append(_rotation(p, feedback, law))
    return " ".join(parts)


def _slowest_pole(g: Transfer) -> complex:
    return complex(max(g.poles, key=lambda pole: pole.real))


def _drifts(g: Transfer) -> bool:
    """Whether a speed that nothing feeds back is all that keeps the loop from being stable."""
    rest = g.poles[abs(g.poles) > 0.0]
    return len(rest) == len(g.poles) - 1 and bool((rest.real < 0.0).all())


def _unstable(g: Transfer) -> str:
    worst = max(g.poles.real)
    return (
        f"Without friction this loop is unstable (a pole with real part {worst:.3g} 1/s): "
        "large motions grow whatever the friction."
    )


def _rotation(p: FurutaPendulum, feedback: Sequence[float], law: FrictionLaw) -> str:
    rotations = steady_rotations(p, feedback, law)
    start = f"φ is not fed back: the curve starts at G(0) = -1/l2 = {-1 / feedback[1]:.4g}"
    if not rotations:
        return (
            f"{start}. Friction exceeds l2 v at every speed, so no steady rotation: once stuck, "
            "the arm is moved by the falling pendulum alone."
        )
    rates = ", ".join(f"{r.rate_rad_s:.4g} rad/s" for r in rotations)
    kind = "stable" if all(r.stable for r in rotations) else "unstable"
    return (
        f"{start}, which predicts no oscillation but steady rotation: at {rates} the positive "
        f"feedback l2 v cancels friction with the pendulum upright. This rotation is {kind}."
    )


def _acceleration(p: FurutaPendulum, g: Transfer, law: FrictionLaw) -> str:
    start = (
        "Neither φ nor its speed is fed back: G has an integrator, and ω = 0 gives nothing finite."
    )
    if g.denominator[2] <= 0.0:
        return start
    acceleration = law.parameters.alpha0 * p.delta / g.denominator[2]
    return (
        f"{start} Friction tilts the pendulum and the tilt drives the arm on, faster by "
        f"{acceleration:.3g} rad/s² at first, in the direction of motion and without bound."
    )

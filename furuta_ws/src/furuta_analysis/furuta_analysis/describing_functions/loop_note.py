"""Explains in words what a Nyquist plot means for the arm."""

from __future__ import annotations

from collections.abc import Sequence

from furuta_analysis.describing_functions.steady_rotation import steady_rotations
from furuta_analysis.describing_functions.transfer import Transfer, transfer
from furuta_model.friction.laws import FrictionLaw
from furuta_model.pendulum import FurutaPendulum

ONLY_CROSSINGS = "φ is fed back: the curve starts and ends at 0, and only its crossings matter."
SLIDES_WITHOUT_REVERSAL = (
    "The slowest pole is real: the arm may slide to l1 φ = F without reversing and stay there, "
    "held by friction, instead of oscillating."
)


def loop_note(p: FurutaPendulum, feedback: Sequence[float], law: FrictionLaw) -> str:
    """What happens at ω = 0, and whether the loop without friction is stable."""
    g = transfer(p, feedback)
    parts = [] if g.stable or _drifts(g) else [_unstable(g)]
    if feedback[0] != 0.0:
        parts.append(ONLY_CROSSINGS)
        if g.stable and _slowest_pole(g).imag == 0.0:
            parts.append(SLIDES_WITHOUT_REVERSAL)
    elif feedback[1] == 0.0:
        parts.append(_acceleration(p, g, law))
    else:
        parts.append(_rotation(p, feedback, law))
    return " ".join(parts)


def _slowest_pole(g: Transfer) -> complex:
    return complex(max(g.poles, key=lambda pole: pole.real))


def _drifts(g: Transfer) -> bool:
    """Whether the loop is stable except for an arm speed that is not fed back."""
    rest = g.poles[abs(g.poles) > 0.0]
    return len(rest) == len(g.poles) - 1 and bool((rest.real < 0.0).all())


def _unstable(g: Transfer) -> str:
    worst = max(g.poles.real)
    return (
        f"Without friction this loop is unstable (a pole with real part {worst:.3g} 1/s): "
        "large motions grow, whatever the friction is."
    )


def _rotation(p: FurutaPendulum, feedback: Sequence[float], law: FrictionLaw) -> str:
    rotations = steady_rotations(p, feedback, law)
    start = f"φ is not fed back: the curve starts at G(0) = -1/l2 = {-1 / feedback[1]:.4g}"
    if not rotations:
        return (
            f"{start}. Friction exceeds l2 v at every speed, so there is no steady rotation: once "
            "the arm sticks, only the falling pendulum moves it."
        )
    rates = ", ".join(f"{r.rate_rad_s:.4g} rad/s" for r in rotations)
    kind = "stable" if all(r.stable for r in rotations) else "unstable"
    return (
        f"{start}, which predicts no oscillation but steady rotation: at {rates} the positive "
        f"feedback l2 v balances friction, with the pendulum upright. This rotation is {kind}."
    )


def _acceleration(p: FurutaPendulum, g: Transfer, law: FrictionLaw) -> str:
    start = "Neither φ nor its speed is fed back: G has an integrator and is not finite at ω = 0."
    if g.denominator[2] <= 0.0:
        return start
    acceleration = law.parameters.alpha0 * p.delta / g.denominator[2]
    return (
        f"{start} Friction tilts the pendulum, and feedback of the tilt accelerates the arm in its "
        f"direction of motion without bound, by {acceleration:.3g} rad/s² at first."
    )

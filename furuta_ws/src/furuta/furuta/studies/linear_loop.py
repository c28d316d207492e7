"""Reports on the linear loop with friction: the Nyquist plot, and the predicted cycles."""

from collections.abc import Mapping
from typing import Any

from furuta.describing_functions.predicted_cycles import Prediction
from furuta.describing_functions.steady_rotation import steady_rotations
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.margins import pairs
from furuta.transfer import transfer


def nyquist_report(cases: Mapping[str, IdealLoop]) -> dict[str, Any]:
    """Crossings of the negative real axis by G of every loop, and G by the name of the case."""
    responses = {case: transfer(loop.body, loop.gains) for case, loop in cases.items()}
    return {
        "crossings": [
            {"case": case, **crossing._asdict()}
            for case, g in responses.items()
            for crossing in g.crossings
        ],
        "nyquist": {
            case: {
                "feedback": cases[case].gains,
                "numerator": g.numerator,
                "denominator": g.denominator,
                "poles": pairs(g.poles),
                "stable_without_friction": g.stable,
            }
            for case, g in responses.items()
        },
    }


def prediction_report(loop: IdealLoop, prediction: Prediction) -> dict[str, Any]:
    """The predicted cycles and rotations of a loop, and what was searched."""
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
    }

"""How well a model follows recordings, those it was fitted to and others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from furuta_identification.preparation.preparation import Options, prepare
from furuta_identification.shooting.shooting import Shooting, stretches
from furuta_model.state import THETA
from furuta_recordings.recording import CHANNELS, Recording

if TYPE_CHECKING:
    from furuta_identification.fitting.model import Model

# Size of a series [rad, rad/s] below which nothing moves in it.
STILL = 1e-6
# Rest angle [rad] off the model's by which a recording has another zero.
OTHER_ZERO = 0.03


def fit_percent(measured: np.ndarray, predicted: np.ndarray) -> float:
    """100·(1 − ‖y − ŷ‖/‖y − ȳ‖) [%], NaN for a series (n,) that is missing or does not move."""
    here = np.isfinite(measured)
    y, y_hat = measured[here], predicted[here]
    if not len(y) or np.std(y) < STILL:
        return float("nan")
    return float(100.0 * (1.0 - np.linalg.norm(y - y_hat) / np.linalg.norm(y - np.mean(y))))


def pendulum_fit(shooting: Shooting, vector: np.ndarray) -> float:
    """The worst fit of the pendulum's angle [%] over the recordings."""
    return min(
        fit_percent(part.recording.measured[:, THETA], predicted[:, THETA])
        for part, predicted in zip(shooting.parts, shooting.predictions(vector), strict=True)
    )


class Followed:
    """A recording beside what a model says of it: ``predicted`` (n, 4)."""

    def __init__(self, recording: Recording, predicted: np.ndarray) -> None:
        self.recording, self.predicted = recording, predicted

    def fits(self, seconds: float = np.inf) -> dict[str, float]:
        """Fit [%] of each channel over the first ``seconds``."""
        chosen = self.recording.time - self.recording.time[0] < seconds
        return {
            name: fit_percent(self.recording.measured[chosen, k], self.predicted[chosen, k])
            for k, name in enumerate(CHANNELS)
        }


def follow(model: Model, recording: Recording) -> Followed:
    """Run the model along a prepared recording, freely or in the stretches it was fitted in.

    In stretches, the state at the start of each is fitted, and that of a free run where it starts
    in motion; from rest, a free run starts from the state measured there.
    """
    names = [name for name in model.names if name not in ("coulomb",)]
    shooting = Shooting(
        [stretches(recording, model.window, model.scale, model.guess)], names, model.guess
    )
    return Followed(recording, shooting.predictions(model.guess.vector(names))[0])


def held_out(model: Model, recording: Recording, options: Options) -> tuple[Followed, list[str]]:
    """Run the model along a recording that it was not fitted to.

    Where the pendulum rests at another angle than the model's zero allows, its encoder was
    started elsewhere, and its zero is taken from that rest.
    """
    ready, findings = prepare(recording, options)
    if model.command_negated:
        ready = ready.with_command_negated()
    ready = ready.with_delayed_command(model.shift)
    at_rest = ready.between(ready.time[0], ready.time[0] + 0.1).measured[:, THETA]
    if np.isinf(model.window) and np.ptp(at_rest) < OTHER_ZERO:
        g = model.guess
        phi = float(ready.measured[0, 0])
        off = float(np.mean(at_rest)) + g["zero"] - np.pi
        # Hanging, sinθ ≈ −(θ − π) and cosθ ≈ −1 balance the tilt's part.
        due = g["tilt_y"] * np.cos(phi) - g["tilt_x"] * np.sin(phi)
        off = (off - due + np.pi) % (2 * np.pi) - np.pi
        if abs(off) > OTHER_ZERO:
            model = model._replace(guess=g.changed(["zero"], [g["zero"] - off]))
            findings.append(f"{recording.name}: its pendulum's zero is off by {off:.3f} rad: moved")
    return follow(model, ready), findings

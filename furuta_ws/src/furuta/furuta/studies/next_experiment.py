r"""Proposes the experiment that tells most about a rig, by its Fisher information.

The pendulum hangs and is driven in open loop. Each candidate signal is simulated on the rig. The
slopes S of the angles φ and θ in the uncertain values give the information, and with the covariance
C before the experiment the covariance after it:

.. math:: C' = (C^{-1} + S^T S / (\mathit{scale}^2\, n))^{-1}

Errors of the model dominate those of encoders: ``scale`` is a part of each angle's motion, and n
samples next to each other count as one.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import NamedTuple

import numpy as np

from furuta_control.excitation import ExcitationParameters
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.uncertainty import Uncertainty, changed_rig
from furuta_model.state import PHI, PHI_DOT, THETA
from furuta_sim.settings.settings import loop, rig_settings
from furuta_sim.simulation.closed_loop import simulate

KINDS = ("steps", "sine", "multisine")
# Amplitudes as parts of the largest voltage, and periods as multiples of the hanging pendulum's.
AMPLITUDES, PERIODS = (0.05, 0.1, 0.2, 0.4), (1.5, 3.0, 6.0)
# Part of the rig's limits that a proposed motion may use, and largest swing of the pendulum [rad]:
# the motion of a faster one is nearly chaotic, and its slopes say nothing.
GUARD, LARGEST_SWING = 0.8, 1.2
# Error of the model as a part of the motion, and samples that count as one.
MODEL_ERROR, CORRELATED_SAMPLES = 0.01, 100.0
# Difference for the slopes, in standard errors.
STEP = 0.05
# Angle off hanging at the start [rad].
RELEASE = 0.01
UNLIMITED = 1e3


class Proposal(NamedTuple):
    """A signal, what it moves, and the standard errors before and after it."""

    kind: str
    amplitude_v: float
    period_s: float
    seconds: float
    arm_travel_rad: float
    arm_speed_rad_s: float
    before: dict[str, float]
    after: dict[str, float]

    @property
    def gain(self) -> float:
        """Sum of the logarithms of the factors by which the errors become smaller."""
        pairs = zip(self.before.values(), self.after.values(), strict=True)
        return float(sum(np.log(before / after) for before, after in pairs if before > 0.0))


def propose(rig: Rig, uncertainty: Uncertainty, seconds: float) -> Proposal | None:
    """The best signal of ``seconds`` within the rig's limits; None if none stays within them."""
    found = [_proposal(rig, uncertainty, each, seconds) for each in _signals(rig)]
    within = [each for each in found if each is not None]
    return max(within, key=lambda each: each.gain, default=None)


def _signals(rig: Rig) -> Iterator[ExcitationParameters]:
    period = 2.0 * pi * np.sqrt(rig.model.beta / rig.model.delta)
    for kind in KINDS:
        for part in AMPLITUDES:
            for multiple in PERIODS:
                amplitude = round(part * rig.limits.voltage, 3)
                yield ExcitationParameters(
                    kind, amplitude, round(multiple * period, 2), 3.0, UNLIMITED, UNLIMITED
                )


def _proposal(
    rig: Rig, uncertainty: Uncertainty, signal: ExcitationParameters, seconds: float
) -> Proposal | None:
    motion = _motion(rig, signal, seconds)
    travel, speed = np.abs(motion[:, PHI]).max(), np.abs(motion[:, PHI_DOT]).max()
    too_far = travel > GUARD * rig.limits.arm_angle or speed > GUARD * rig.limits.arm_speed
    if too_far or np.abs(motion[:, THETA] - pi).max() > LARGEST_SWING:
        return None
    before = uncertainty.standard_errors
    scale = MODEL_ERROR * np.maximum(motion[:, [PHI, THETA]].std(axis=0), MODEL_ERROR)
    columns = []
    for index, error in enumerate(before.values()):
        change = np.zeros(len(before))
        change[index] = STEP * error
        changed = _motion(changed_rig(rig, uncertainty.names, change), signal, seconds)
        # Slopes in units of the standard error.
        columns.append(((changed - motion)[:, [PHI, THETA]] / scale / STEP).ravel())
    slopes = np.column_stack(columns)
    sizes = np.array([each or 1.0 for each in before.values()])
    known = np.linalg.pinv(uncertainty.covariance / np.outer(sizes, sizes), rcond=1e-9)
    after = np.linalg.pinv(known + slopes.T @ slopes / CORRELATED_SAMPLES)
    errors = np.sqrt(np.maximum(np.diag(after), 0.0)) * sizes
    return Proposal(
        signal.kind,
        signal.amplitude,
        signal.period,
        seconds,
        float(travel),
        float(speed),
        before,
        dict(zip(before, (float(each) for each in errors), strict=True)),
    )


def _motion(rig: Rig, signal: ExcitationParameters, seconds: float) -> np.ndarray:
    """The states (n, 4) of the hanging pendulum under the signal."""
    made = loop(rig_settings(rig))
    initial = made.plant.initial._replace(theta=pi - RELEASE)
    controller = made.controller._replace(mode="open_loop", excitation=signal)
    plant = made.plant._replace(initial=initial)
    return simulate(made._replace(plant=plant, controller=controller), seconds).state

"""Simulates the model along a recording, in segments that each start from a given state."""

from math import ceil, exp

import numpy as np

from furuta_identification.shooting.parameter_values import ParameterValues
from furuta_identification.shooting.rig_model import (
    RigModel,
    longest_step,
    move,
    rig_accelerations,
)
from furuta_model.compiled import compiled
from furuta_model.elementary import sin_cos
from furuta_model.state import BRISTLE, PHI, PHI_DOT, PLANT_STATES, RIGID_STATES, THETA, THETA_DOT
from furuta_recordings.recording import Recording

# Speed [rad/s] that no rig reaches: beyond it a simulation has diverged.
DIVERGED = 1e4
# Rounding error of differences between large times, as a part of a step.
ROUNDING = 1e-3


def predict(
    recording: Recording,
    starts: np.ndarray,
    initial: np.ndarray,
    values: ParameterValues,
) -> np.ndarray:
    """Outputs (n, 4) at the recording's times, from ``initial`` (s, 5) at each of ``starts`` (s,).

    The command, limited by the drive's ceiling, acts after a delay. Speeds pass a tracking loop
    with two equal poles, which makes them lag.
    """
    model, ceiling = values.model, values["ceiling"]
    predicted = np.empty((len(recording.time), RIGID_STATES))
    _predict(
        recording.time,
        recording.command_time + values["delay"],
        np.clip(recording.command, -ceiling, ceiling),
        np.append(starts, len(recording.time)),
        initial,
        model,
        longest_step(model),
        values["lag"],
        predicted,
    )
    return predicted


@compiled
def _predict(
    time: np.ndarray,
    command_time: np.ndarray,
    command: np.ndarray,
    bounds: np.ndarray,
    initial: np.ndarray,
    model: RigModel,
    step: float,
    lag: float,
    predicted: np.ndarray,
) -> None:
    x = np.empty(PLANT_STATES)
    upcoming = 0  # index of the next command
    for segment in range(len(bounds) - 1):
        first, end = bounds[segment], bounds[segment + 1]
        x[:] = initial[segment]
        while upcoming < len(command) and command_time[upcoming] <= time[first]:
            upcoming += 1
        u = command[upcoming - 1] if upcoming > 0 else 0.0
        torque = u - model.friction.sigma0 * x[BRISTLE] - model.friction.viscous * x[PHI_DOT]
        sine, cosine = sin_cos(x[THETA])
        rates = rig_accelerations(x[PHI], x[PHI_DOT], sine, cosine, x[THETA_DOT], torque, model)
        # States of the tracking loop after a long time at these accelerations.
        arm1, arm2 = x[PHI_DOT] - 0.5 * lag * rates[0], x[PHI_DOT] - lag * rates[0]
        pendulum1, pendulum2 = x[THETA_DOT] - 0.5 * lag * rates[1], x[THETA_DOT] - lag * rates[1]
        for k in range(first, end):
            predicted[k, PHI], predicted[k, PHI_DOT] = x[PHI], arm2
            predicted[k, THETA], predicted[k, THETA_DOT] = x[THETA], pendulum2
            if k + 1 == end:
                break
            now = time[k]
            while now < time[k + 1]:
                then = time[k + 1]
                if upcoming < len(command) and command_time[upcoming] < then:
                    then = command_time[upcoming]
                if then > now:
                    v, w = x[PHI_DOT], x[THETA_DOT]
                    steps = max(1, ceil((then - now) / step - ROUNDING))
                    move(x, u, then - now, steps, model)
                    arm1, arm2 = _track(arm1, arm2, v, x[PHI_DOT], then - now, lag)
                    pendulum1, pendulum2 = _track(
                        pendulum1, pendulum2, w, x[THETA_DOT], then - now, lag
                    )
                now = then
                while upcoming < len(command) and command_time[upcoming] <= now:
                    u = command[upcoming]
                    upcoming += 1
            if not abs(x[PHI_DOT]) + abs(x[THETA_DOT]) < DIVERGED:
                predicted[k + 1 : end] = DIVERGED
                break


@compiled
def _track(
    first: float, second: float, before: float, now: float, dt: float, lag: float
) -> tuple[float, float]:
    """The tracking loop's two states after the speed has changed from ``before`` to ``now``."""
    if lag <= 0.0:
        return now, now
    a = 2.0 * dt / lag
    decay = exp(-a)
    slope = (1.0 - decay) / a
    first_now = now + (first - before) * decay - (now - before) * slope
    return first_now, first_now + (second - first) * decay - (first_now - first) * slope

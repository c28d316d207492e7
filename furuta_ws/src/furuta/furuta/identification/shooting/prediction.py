"""The model that is fitted, and its simulation along a recording.

Body, LuGre friction, tilt, waves of the torque and integrator are those of the simulated rig
(:mod:`furuta_model.parts.motion`). One thing differs: the Coulomb friction of the pendulum's joint
is f tanh(θ̇/w₀), because a joint that truly sticks forgets its speed, and with it how the motion
depends on the parameters.
"""

from math import ceil, exp
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.elementary import sin_cos, tanh
from furuta_model.friction.laws import LUGRE, FrictionLaw, bristle_force
from furuta_model.friction.parameters import Friction
from furuta_model.integration import Point, integrator, substeps_for
from furuta_model.parts.disturbances import Push, Tilt, push_torques, wave_torque
from furuta_model.parts.motion import PendulumFriction, mobilities
from furuta_model.pendulum import FurutaPendulum, accelerations_at
from furuta_model.state import BRISTLE, PHI, PHI_DOT, PLANT_STATES, RIGID_STATES, THETA, THETA_DOT
from furuta_recordings.recording import Recording

# Pendulum speed w₀ [rad/s] over which its joint's Coulomb friction changes its sign.
JOINT_SPEED = 0.05
# Longest integration step [s]: a hundredth of the fastest motion of interest.
LONGEST_STEP = 1e-3
# Shortest step [s]: a model that needs a shorter one does not describe a real rig.
SHORTEST_STEP = 3e-5
# Speed [rad/s] that no rig reaches: beyond it a simulation has diverged.
DIVERGED = 1e4
# Rounding error of differences between large times, as a part of a step.
ROUNDING = 1e-3


class RigModel(NamedTuple):
    """Parameters of the model.

    ``waves`` (k, 3): order, cosine and sine amplitude [V] of each wave of the torque; ``delay``
    [s] of the command, ``lag`` [s] of the measured speeds, ``ceiling`` of the drive [V].
    """

    body: FurutaPendulum
    friction: Friction
    pendulum_friction: PendulumFriction
    tilt: Tilt
    waves: np.ndarray
    delay: float
    lag: float
    ceiling: float


@inlined
def rig_accelerations(
    phi: float, v: float, sine: float, cosine: float, w: float, torque: float, rig: RigModel
) -> tuple[float, float]:
    """(φ̈, θ̈) [rad/s²]; ``torque`` is u − F of the arm [V], sine and cosine are those of θ."""
    tilted = Push(0.0, 0.0, rig.tilt.x, rig.tilt.y)
    arm, joint = push_torques(phi, sine, cosine, rig.body.delta, tilted)
    joint -= rig.pendulum_friction.damping * w
    if rig.pendulum_friction.coulomb != 0.0:
        joint -= rig.pendulum_friction.coulomb * tanh(w / JOINT_SPEED)
    torque += arm + wave_torque(phi, rig.waves)
    v_dot, w_dot = accelerations_at(v, sine, cosine, w, torque, rig.body)
    # (1) has no torque on the joint; it acts through the inverse of the inertia matrix.
    _, coupling, joint_mobility = mobilities(sine, cosine, rig.body)
    return v_dot + coupling * joint, w_dot + joint_mobility * joint


@inlined
def _stage(
    at: Point,
    start_speed: float,
    u: float,
    memory: float,
    h: float,
    rig: RigModel,
    law: FrictionLaw,
) -> tuple[float, float, float]:
    """A stage of the integration (:func:`furuta_model.integration.integrator`)."""
    phi, v, sine, cosine, w = at
    friction, end = bristle_force(v, memory, h, law)
    torque = u - law.parameters.viscous * v - friction
    v_dot, w_dot = rig_accelerations(phi, v, sine, cosine, w, torque, rig)
    return v_dot, w_dot, end


_advance = integrator(_stage)


@compiled
def move(x: np.ndarray, u: float, dt: float, steps: int, rig: RigModel) -> None:
    """Move ``x`` (5,), in place, over ``dt`` [s] under ``u`` [V] by the plant's integrator."""
    _advance(x, u, dt, steps, rig, FrictionLaw(LUGRE, rig.friction, 0, 0, True, False))


def longest_step(rig: RigModel) -> float:
    """Integration step [s] that resolves the vibration of a stuck arm on its bristle."""
    resolved = 0.01 / substeps_for(0.01, rig.body, rig.friction)
    return min(LONGEST_STEP, max(resolved, SHORTEST_STEP))


def predict(
    recording: Recording, starts: np.ndarray, initial: np.ndarray, rig: RigModel
) -> np.ndarray:
    """Outputs (n, 4) at the recording's times, from ``initial`` (s, 5) at each of ``starts`` (s,).

    The command, limited by the drive's ceiling, acts after a delay. Speeds pass a tracking loop
    with two equal poles, which makes them lag.
    """
    predicted = np.empty((len(recording.time), RIGID_STATES))
    _predict(
        recording.time,
        recording.command_time + rig.delay,
        np.clip(recording.command, -rig.ceiling, rig.ceiling),
        np.append(starts, len(recording.time)),
        initial,
        rig,
        longest_step(rig),
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
    rig: RigModel,
    step: float,
    predicted: np.ndarray,
) -> None:
    lag = rig.lag
    x = np.empty(PLANT_STATES)
    upcoming = 0  # index of the next command
    for segment in range(len(bounds) - 1):
        first, end = bounds[segment], bounds[segment + 1]
        x[:] = initial[segment]
        while upcoming < len(command) and command_time[upcoming] <= time[first]:
            upcoming += 1
        u = command[upcoming - 1] if upcoming > 0 else 0.0
        torque = u - rig.friction.sigma0 * x[BRISTLE] - rig.friction.viscous * x[PHI_DOT]
        sine, cosine = sin_cos(x[THETA])
        rates = rig_accelerations(x[PHI], x[PHI_DOT], sine, cosine, x[THETA_DOT], torque, rig)
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
                    move(x, u, then - now, steps, rig)
                    arm1, arm2 = track(arm1, arm2, v, x[PHI_DOT], then - now, lag)
                    pendulum1, pendulum2 = track(
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
def track(
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

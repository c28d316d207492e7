"""The rig with an elastic coupling, simulated along the segments of a rigid fit.

Motion, friction and coupling are those of the simulated rig (:mod:`furuta_model.parts`). The
command is averaged over each sampling interval.
"""

import numpy as np

from furuta_identification.shooting.prediction import LUGRE, track
from furuta_identification.shooting.unknowns import ParameterValues
from furuta_model.block import new_memory
from furuta_model.compiled import compiled
from furuta_model.friction.laws import FrictionLaw
from furuta_model.parts.coupling import Coupling, ElasticRig, advance_elastic, design_coupling
from furuta_model.parts.disturbances import Push, Tilt, with_tilt
from furuta_model.parts.motion import Body, Cogging, PendulumFriction
from furuta_model.parts.plant_memory import PlantMemory
from furuta_model.parts.varied_friction import FrictionVariation
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import BRISTLE, PHI, PHI_DOT, RIGID_STATES, THETA, THETA_DOT
from furuta_recordings.recording import Recording

# Substeps as a part of those of the simulated rig: the frequency is then off by below 0.05 %.
COARSER = 0.4


def predict_elastic(
    recording: Recording,
    starts: np.ndarray,
    initial: np.ndarray,
    values: ParameterValues,
    coupling: Coupling,
) -> np.ndarray:
    """Outputs (n, 4) at the recording's times, from ``initial`` (s, 5) at each of ``starts`` (s,).

    The initial states are those of a rigid arm. They set the common motion of motor and arm at each
    start; twist and bristle of the motor go on.
    """
    rig, interval = values.model, recording.interval
    law = FrictionLaw(LUGRE, rig.friction, 0, 0, True, False, False)
    elastic = design_coupling(coupling, rig.body, law, interval)
    elastic = elastic._replace(substeps=max(1, round(COARSER * elastic.substeps)))
    predicted = np.empty((len(recording.time), RIGID_STATES))
    _predict(
        recording.time,
        mean_commands(recording, rig.delay, rig.ceiling),
        np.append(starts, len(recording.time)),
        initial,
        rig.body,
        rig.pendulum_friction,
        FrictionVariation(),
        rig.tilt,
        rig.waves,
        rig.lag,
        elastic,
        coupling.motor_inertia,
        coupling.senses_motor,
        new_memory(PlantMemory),
        predicted,
    )
    return predicted


def mean_commands(recording: Recording, delay: float, ceiling: float) -> np.ndarray:
    """Mean of the command [V] over each sampling interval (n - 1,)."""
    time = recording.time
    edges = np.append(recording.command_time + delay, max(time[-1], recording.command_time[-1]) + 1)
    held = np.clip(recording.command, -ceiling, ceiling) * np.diff(edges)
    integral = np.interp(time, edges, np.append(0.0, np.cumsum(held)))
    mean: np.ndarray = np.diff(integral) / np.diff(time)
    return mean


@compiled
def _predict(
    time: np.ndarray,
    command: np.ndarray,
    bounds: np.ndarray,
    initial: np.ndarray,
    model: FurutaPendulum,
    pendulum_friction: PendulumFriction,
    variation: FrictionVariation,
    tilt: Tilt,
    waves: np.ndarray,
    lag: float,
    p: ElasticRig,
    share: float,
    senses_motor: bool,
    memories: np.ndarray,
    predicted: np.ndarray,
) -> None:
    memory = memories[0]
    x, motor = memory.x, memory.motor
    body = Body(
        model=model,
        variation=variation,
        cogging=Cogging(0.0, 1, 0.0),
        pendulum_friction=pendulum_friction,
        springs=1,
        push=with_tilt(Push(0.0, 0.0, 0.0, 0.0), tilt),
        waves=waves,
        memory=memory,
    )
    motor.bristle = initial[0, BRISTLE]
    arm1 = arm2 = initial[0, PHI_DOT]
    pendulum1 = pendulum2 = initial[0, THETA_DOT]
    for segment in range(len(bounds) - 1):
        twist, twist_rate = motor.angle - x[PHI], motor.speed - x[PHI_DOT]
        x[:] = initial[segment]
        x[PHI] -= share * twist
        x[PHI_DOT] -= share * twist_rate
        motor.angle, motor.speed = x[PHI] + twist, x[PHI_DOT] + twist_rate
        for k in range(bounds[segment], bounds[segment + 1]):
            predicted[k, PHI] = motor.angle if senses_motor else x[PHI]
            predicted[k, PHI_DOT], predicted[k, THETA] = arm2, x[THETA]
            predicted[k, THETA_DOT] = pendulum2
            if k + 1 == len(time):
                break
            dt = time[k + 1] - time[k]
            v = motor.speed if senses_motor else x[PHI_DOT]
            w = x[THETA_DOT]
            advance_elastic(x, command[k], dt, body, p)
            after = motor.speed if senses_motor else x[PHI_DOT]
            arm1, arm2 = track(arm1, arm2, v, after, dt, lag)
            pendulum1, pendulum2 = track(pendulum1, pendulum2, w, x[THETA_DOT], dt, lag)

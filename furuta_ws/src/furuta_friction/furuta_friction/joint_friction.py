"""The friction of a joint other than the arm, sample by sample as its states arrive."""

from math import isnan

import numpy as np

from furuta_friction.joint_observer import (
    JointMemory,
    ObserverNodeParameters,
    design_joint,
    joint_friction,
    predict,
    reset,
)
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled, for_types_of
from furuta_model.state import is_possible
from furuta_ros.time_stamps import NANOSECONDS, starts_anew

# Position, speed, effort, and speed of the reference.
JointSample = tuple[float, float, float, float]
NO_SAMPLE: JointSample = (0.0, 0.0, 0.0, 0.0)


class JointFriction:
    """Friction of a joint, from its position and effort."""

    NEEDS = "effort in joint_states, and axis.inertia"

    def __init__(self) -> None:
        self._memory = new_memory(JointMemory)
        self._effort, self._observes = 0.0, True

    @property
    def compensation(self) -> np.ndarray:
        """The memory of the compensators."""
        return self._memory["compensation"]

    def design(self, parameters: ObserverNodeParameters) -> None:
        """Switch to the observer that the parameters describe; the memory is kept."""
        self._design = block(design_joint(parameters))
        self._observes = parameters.axis.inertia > 0.0
        self._sample_time = parameters.observer.sample_time * NANOSECONDS
        self._step = for_types_of(_step, self._memory, NO_SAMPLE, self._design, 0)

    def estimate(self, x: JointSample, interval: int) -> float:
        """F̂ for a sample an ``interval`` [ns] after the last one; NaN if it is impossible."""
        samples = 0 if starts_anew(interval) else max(round(interval / self._sample_time), 1)
        self._effort = x[2]
        return self._step(self._memory, x, self._design, samples)

    def is_blind(self) -> bool:
        """Whether no friction is observed."""
        return isnan(self._effort) or not self._observes


@compiled
def _step(memory: np.ndarray, x: JointSample, design: np.ndarray, samples: int) -> float:
    """F̂ a number of ``samples`` after the last one, 0 anew; NaN if a number is impossible."""
    if not is_possible(np.array(x)):
        return np.nan
    if samples == 0:
        reset(memory[0])
    for _ in range(samples - 1):
        predict(memory[0], design[0])
    position, speed, effort, reference_speed = x
    return joint_friction(memory[0], position, speed, effort, reference_speed, design[0])

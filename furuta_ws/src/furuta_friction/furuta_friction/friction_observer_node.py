"""Node ``friction_observer``: joint_states → friction_estimate."""

import sys
from collections.abc import Sequence
from math import isnan, nan
from typing import Any

import numpy as np
from rclpy.parameter import Parameter

from furuta_friction import compensation, joint_observer
from furuta_friction.compensation import CompensationMemory
from furuta_friction.joint_observer import (
    ARM,
    NO_SAMPLE,
    JointMemory,
    JointSample,
    ObserverNodeParameters,
    joint_step,
)
from furuta_friction.vibration import is_sustained
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled, for_types_of
from furuta_model.state import LARGEST_VALUE, is_possible
from furuta_ros.messages import RefusedError, joint_numbers, typed_joint_state
from furuta_ros.node import BEST_EFFORT, FurutaNode, LoopPublisher
from furuta_ros.reduction_status import ReductionStatus, vibration_reason
from furuta_ros.spinning import run_node
from furuta_ros.time_stamps import NANOSECONDS, NEVER, starts_anew
from furuta_ros.topics import FRICTION_ESTIMATE, JOINT_STATES, REFERENCE
from furuta_ros.wire import NO_SIGNALS, Signals, unpack_joint_state, value_bytes

# Time between two checks of what the compensation needs, and of the adapted levels [s].
CHECK_PERIOD = 5.0
# Age from which the speed of a reference does not count any more [s].
REFERENCE_AGE = 0.1
# Part of the sample time by which the mean time between states may differ from it.
WRONG_RATE = 0.2
# What the observed friction comes from.
ARM_NEEDS = "effort (applied torque) in joint_states"
JOINT_NEEDS = "effort in joint_states, and axis.inertia"


class FrictionObserverNode(FurutaNode[ObserverNodeParameters]):
    """Estimates the friction in the arm's joint, or in any other joint.

    Subscribes to ``joint_states``, publishes ``friction_estimate`` [V, or the unit of the joint's
    effort], one for each state of the joint. If a state is repeated (same stamp), the last estimate
    is published again without a new step. For a joint other than the arm it also subscribes to
    ``reference``.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        super().__init__("friction_observer", ObserverNodeParameters, overrides)
        self._stamp, self._friction = NEVER, 0.0
        self._states, self._checked = 0, NEVER
        self._reference, self._reference_age = nan, 0
        self._publisher = LoopPublisher(self, FRICTION_ESTIMATE)
        self._is_arm = self.parameters.joint == ARM
        self._memory = new_memory(CompensationMemory if self._is_arm else JointMemory)
        self._x: Signals | JointSample = NO_SIGNALS if self._is_arm else NO_SAMPLE
        self.design_by(self._design)
        if self._is_arm:
            self.subscribe_to(JOINT_STATES, self.on_state)
        else:
            self.subscribe_to(JOINT_STATES, self.on_joint, BEST_EFFORT)
            self.subscribe_to(REFERENCE, self.on_reference, BEST_EFFORT)
            if not self.parameters.axis.inertia:
                self.get_logger().info(
                    f"axis.inertia of joint {self.parameters.joint} is 0: the measured speed is "
                    "used, and no friction is observed"
                )
        self._reduction = ReductionStatus(self, self._reduction_reason)
        self.steady_timer(CHECK_PERIOD, self._check)

    def _design(self, p: ObserverNodeParameters) -> None:
        """Redesign the observer; its memory is kept."""
        self._sample_time = p.observer.sample_time * NANOSECONDS
        step: Any = _arm_step if self._is_arm else _joint_step
        if self._is_arm:
            self._observer = block(compensation.design_compensator(p.observer))
        else:
            self._observer = block(joint_observer.design_joint(p))
        self._step = for_types_of(step, self._memory, self._x, self._observer, 0)

    def on_state(self, data: bytes) -> None:
        """Estimate the friction of the arm and publish it."""
        stamp, x = unpack_joint_state(data) or typed_joint_state(data)
        self._answer(stamp, x)

    def on_joint(self, data: bytes) -> None:
        """Estimate the friction of the joint and publish it; other joints are ignored."""
        if found := joint_numbers(data, self.parameters.joint):
            stamp, (position, speed, effort) = found
            if isnan(position):
                raise RefusedError(f"no position of joint {self.parameters.joint}")
            self._states += 1
            self._reference_age += 1
            sample_time = self.parameters.observer.sample_time
            old = self._reference_age * sample_time > max(REFERENCE_AGE, 1.5 * sample_time)
            self._answer(stamp, (position, speed, effort, nan if old else self._reference))

    def on_reference(self, data: bytes) -> None:
        """Remember the speed of the joint's reference."""
        if found := joint_numbers(data, self.parameters.joint):
            _, (_, speed, _) = found
            if isnan(speed):
                raise RefusedError(f"no velocity of joint {self.parameters.joint}")
            self._reference, self._reference_age = speed, 0

    def _answer(self, stamp: int, x: Signals | JointSample) -> None:
        if stamp != self._stamp:
            friction, is_reduced = self._step(self._memory, x, self._observer, self._samples(stamp))
            if isnan(friction):
                raise RefusedError(f"no value may be larger than {LARGEST_VALUE:g}, given {x}")
            self._x, self._stamp, self._friction = x, stamp, friction
            if is_reduced:
                self._reduction.report()
        self._publisher.publish(value_bytes(self._friction), stamp)

    def _samples(self, stamp: int) -> int:
        """Number of samples since the last one; 0 if this one begins anew."""
        interval = stamp - self._stamp
        if starts_anew(interval):
            return 0
        return 1 if self._is_arm else max(round(interval / self._sample_time), 1)

    def _is_blind(self) -> bool:
        """Whether the newest state is known, and no friction is observed."""
        if self._is_arm:
            *x, torque = self._x
            return isnan(torque) and not isnan(sum(x))
        return isnan(self._x[2]) or not self.parameters.axis.inertia

    def _reduction_reason(self) -> str:
        memory = self._memory if self._is_arm else self._memory["compensation"]
        part = float(memory["observation"]["vibration"]["part"][0])
        return vibration_reason("the observed friction", part)

    def _check(self) -> None:
        """Warn if the compensation cannot do what is asked of it."""
        chosen, log = self.parameters.observer.chosen, self.get_logger()
        if chosen.needs_observed_friction and self._is_blind():
            needs = ARM_NEEDS if self._is_arm else JOINT_NEEDS
            log.warning(f"compensation {chosen.name} needs {needs}")
        memory = self._memory if self._is_arm else self._memory["compensation"]
        if compensation.beyond_adaptation(memory, self.parameters.observer):
            log.warning(
                "compensation adaptive: a level is at its limit, a third or three times what "
                "alpha0 and alpha1 say; the friction is not as the parameters describe it"
            )
        self._check_rate()

    def _check_rate(self) -> None:
        """Warn if the states of a joint do not come every sample time."""
        states, before = self._states, self._checked
        self._states, self._checked = 0, self._stamp
        given = self.parameters.observer.sample_time
        mean = (self._stamp - before) / NANOSECONDS / max(states, 1)
        if states > 1 and before != NEVER and abs(mean / given - 1.0) > WRONG_RATE:
            self.get_logger().warning(
                f"joint {self.parameters.joint} comes every {mean:.3g} s, but sample_time is "
                f"{given:g} s: set it to that"
            )


@compiled
def _arm_step(
    memory: np.ndarray, state: Signals, design: np.ndarray, samples: int
) -> tuple[float, bool]:
    """F̂ [V] of the arm, anew if ``samples`` is 0, and whether a vibration has reduced it.

    F̂ is NaN, without a step, if a number is impossible.
    """
    x = np.array(state)
    if not is_possible(x):
        return np.nan, False
    if samples == 0:
        compensation.reset(memory[0])
    vibration = memory[0].observation.vibration
    swings = vibration.swings
    friction = compensation.estimate_friction(memory[0], x, design[0])
    return friction, vibration.swings > swings and is_sustained(vibration)


@compiled
def _joint_step(
    memory: np.ndarray, x: JointSample, design: np.ndarray, samples: int
) -> tuple[float, bool]:
    """The same for a joint; see :func:`joint_step`."""
    vibration = memory[0].compensation.observation.vibration
    swings = vibration.swings
    friction = joint_step(memory, x, design, samples)
    return friction, vibration.swings > swings and is_sustained(vibration)


def main() -> None:
    """Entry point of the executable ``friction_observer``."""
    sys.exit(run_node(FrictionObserverNode))

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
from furuta_friction.learned_friction import LARGEST_LEVEL
from furuta_friction.vibration import is_sustained
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled, for_types_of
from furuta_model.parameters import shortened
from furuta_model.state import LARGEST_VALUE, is_possible
from furuta_ros.messages import RefusedError, deserialized, joint_numbers, typed_joint_state
from furuta_ros.node import BEST_EFFORT, FurutaNode, LoopPublisher
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
        self._without_joint = b""  # the newest message that does not name the joint
        self._problems: list[str] = []  # at the last check
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
        found = joint_numbers(data, self.parameters.joint)
        if found is None:
            self._without_joint = data
        else:
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
            if isnan(friction) and not is_possible(np.array(x)):
                raise RefusedError(f"no value may be larger than {LARGEST_VALUE:g}, given {x}")
            if not abs(friction) <= LARGEST_VALUE:
                name = self.parameters.observer.compensation
                raise RefusedError(
                    f"compensation {name} gives {friction:g} for it, must be finite and at most "
                    f"{LARGEST_VALUE:g}"
                )
            self._x, self._stamp, self._friction = x, stamp, friction
            if is_reduced and self.warn("reduction", self._reduction()):
                self.publish_status()
        self._publisher.publish(value_bytes(self._friction), stamp)

    def _samples(self, stamp: int) -> int:
        """Number of samples since the last one; 0 if this one begins anew."""
        interval = stamp - self._stamp
        if starts_anew(interval):
            return 0
        return max(round(interval / self._sample_time), 1)

    def _is_blind(self) -> bool:
        """Whether the newest state is known, and no friction is observed."""
        if self._is_arm:
            *x, torque = self._x
            return isnan(torque) and not isnan(sum(x))
        return isnan(self._x[2]) or not self.parameters.axis.inertia

    @property
    def _of_compensation(self) -> np.ndarray:
        """Its part of the memory."""
        return self._memory if self._is_arm else self._memory["compensation"]

    def _reduction(self) -> str:
        """Why only a part of the observed friction acts; empty if all of it does."""
        part = float(self._of_compensation["observation"]["vibration"]["part"][0])
        if part >= 1.0:
            return ""
        return (
            "a sustained vibration above 15 Hz has reduced the observed friction to "
            f"{part:.0%}; it recovers by itself. Motor and arm may be coupled elastically, or a "
            "delay is too long"
        )

    def problem(self) -> str:
        """Why the compensation cannot do what is asked of it."""
        return self._reduction() or "; ".join(self._problems)

    def statistics(self) -> dict[str, object]:
        """Also what the recommended compensation has learned, in units of the parameters."""
        design = self._observer if self._is_arm else self._observer["compensation"]
        return super().statistics() | compensation.learned(self._of_compensation, design)

    def _check(self) -> None:
        """Warn if the compensation cannot do what is asked of it."""
        found = (self._missing_input(), self._limit(), self._missing_joint(), self._wrong_rate())
        self._problems = [problem for problem in found if problem]
        for problem in self._problems:
            self.get_logger().warning(problem)

    def _missing_input(self) -> str:
        chosen = self.parameters.observer.chosen
        if not (chosen.needs_observed_friction and self._is_blind()):
            return ""
        return f"compensation {chosen.name} needs {ARM_NEEDS if self._is_arm else JOINT_NEEDS}"

    def _limit(self) -> str:
        p = self.parameters.observer
        if compensation.beyond_adaptation(self._of_compensation, p):
            return (
                "compensation adaptive: a level is at its limit, a third or three times what "
                "alpha0 and alpha1 say; the friction is not as the parameters describe it"
            )
        if p.compensation != "recommended":
            return ""
        if p.friction.alpha0 + p.friction.alpha1 == 0.0:
            return "compensation recommended: alpha0 and alpha1 are 0, so it only observes friction"
        if self._of_compensation["predictive"]["learned"]["level"][0] >= LARGEST_LEVEL:
            return (
                f"compensation recommended: its level is at its limit, {LARGEST_LEVEL:g} times "
                "alpha0 and alpha1; the friction is larger than that"
            )
        return ""

    def _missing_joint(self) -> str:
        """Whether messages came since the last check, and none of them names the joint."""
        data, self._without_joint = self._without_joint, b""
        if self._states or not data:
            return ""
        names = shortened(list(deserialized(data, JOINT_STATES.message).name))
        return f"no message on joint_states has the joint {self.parameters.joint}; one has {names}"

    def _wrong_rate(self) -> str:
        """Whether the states of a joint do not come every sample time."""
        states, before = self._states, self._checked
        self._states, self._checked = 0, self._stamp
        given = self.parameters.observer.sample_time
        mean = (self._stamp - before) / NANOSECONDS / max(states, 1)
        if states <= 1 or before == NEVER or abs(mean / given - 1.0) <= WRONG_RATE:
            return ""
        return (
            f"joint {self.parameters.joint} comes every {mean:.3g} s, but sample_time is "
            f"{given:g} s: set it to that"
        )


@compiled
def _arm_step(
    memory: np.ndarray, state: Signals, design: np.ndarray, samples: int
) -> tuple[float, bool]:
    """F̂ [V] of the arm, and whether a vibration has reduced it.

    The state is ``samples`` after the last one, or begins anew if that is 0. F̂ is NaN,
    without a step, if a number is impossible.
    """
    x = np.array(state)
    if not is_possible(x):
        return np.nan, False
    if samples == 0:
        compensation.reset(memory[0])
    vibration = memory[0].observation.vibration
    swings = vibration.swings
    for _ in range(samples - 1):
        compensation.pass_missing(memory[0], x, design[0])
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

"""Node ``friction_observer``: joint_states → friction_estimate."""

import sys
from collections.abc import Sequence
from math import isnan

import numpy as np
from rclpy.parameter import Parameter

from furuta_friction.compensation import (
    CompensationMemory,
    ObserverParameters,
    beyond_adaptation,
    design_compensator,
    estimate_friction,
    reset,
)
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled, for_types_of
from furuta_model.state import LARGEST_VALUE, is_possible
from furuta_ros.loop_publisher import LoopPublisher
from furuta_ros.messages import RefusedError, typed_joint_state
from furuta_ros.node import FurutaNode
from furuta_ros.spinning import run_node
from furuta_ros.time_stamps import NEVER, starts_anew
from furuta_ros.topics import FRICTION_ESTIMATE, JOINT_STATES
from furuta_ros.wire import NO_SIGNALS, Signals, unpack_joint_state, value_bytes

# Time between two checks of what the compensation needs, and of the adapted levels [s].
CHECK_PERIOD = 5.0


class FrictionObserverNode(FurutaNode[ObserverParameters]):
    """Estimates the friction in the arm's joint.

    Subscribes to ``joint_states``, publishes ``friction_estimate`` [V], one for each state. If a
    state is repeated (same stamp), the last estimate is published again without a new step.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        super().__init__("friction_observer", ObserverParameters, overrides)
        self._memory = new_memory(CompensationMemory)
        self._x, self._stamp, self._friction = NO_SIGNALS, NEVER, 0.0
        self.design_by(self._design)
        self._publisher = LoopPublisher(self, FRICTION_ESTIMATE)
        self.subscribe_to(JOINT_STATES, self.on_state)
        self.steady_timer(CHECK_PERIOD, self._check)

    def _design(self, parameters: ObserverParameters) -> None:
        """Switch to the compensator that the parameters describe; the memory is kept."""
        self._compensator = block(design_compensator(parameters))
        self._step = for_types_of(_step, self._memory, self._x, self._compensator, False)

    def on_state(self, data: bytes) -> None:
        """Estimate the friction and publish it."""
        stamp, x = unpack_joint_state(data) or typed_joint_state(data)
        if stamp != self._stamp:
            anew = starts_anew(stamp - self._stamp)
            friction = self._step(self._memory, x, self._compensator, anew)
            if isnan(friction):
                raise RefusedError(f"no value may be larger than {LARGEST_VALUE:g}, given {x}")
            self._stamp, self._x, self._friction = stamp, x, friction
        self._publisher.publish(value_bytes(self._friction), stamp)

    def _check(self) -> None:
        """Warn if the compensation cannot do what is asked of it."""
        chosen, log = self.parameters.chosen, self.get_logger()
        if chosen.needs_observed_friction and self._is_blind():
            log.warning(
                f"compensation {chosen.name} needs effort (observed friction) in joint_states; "
                "use an estimator that observes it (method kalman)"
            )
        if beyond_adaptation(self._memory, self.parameters):
            log.warning(
                "compensation adaptive: a level is at its limit, a third or three times what "
                "alpha0 and alpha1 say; the friction is not as the parameters describe it"
            )

    def _is_blind(self) -> bool:
        """Whether the newest state is known, and without its observed friction."""
        *x, observed = self._x
        return isnan(observed) and not isnan(sum(x))


@compiled
def _step(memory: np.ndarray, state: Signals, compensator: np.ndarray, anew: bool) -> float:
    """F̂ [V]; NaN, without a step, if a number is impossible."""
    x = np.array(state)
    if not is_possible(x):
        return np.nan
    if anew:
        reset(memory[0])
    return estimate_friction(memory[0], x, compensator[0])


def main() -> None:
    """Entry point of the executable ``friction_observer``."""
    sys.exit(run_node(FrictionObserverNode))

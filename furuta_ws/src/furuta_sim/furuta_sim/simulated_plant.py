"""The simulated rig as a node, without what decides when its samples begin."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter, parameter_value_to_python
from std_srvs.srv import Trigger

from furuta_model.block import block
from furuta_model.compiled import for_types_of
from furuta_model.parameters import ParameterError, build, shortened
from furuta_ros.node import LATCHED, QOS, FurutaNode, LoopPublisher, sender
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import GROUND_TRUTH, INITIAL_STATE, MEASUREMENT
from furuta_ros.wire import joint_state_bytes
from furuta_sim.parameters import InitialState, PlantNodeParameters
from furuta_sim.plant import (
    NOISE_CHANNELS,
    Noise,
    changed_plant,
    initial_plant,
    move_block,
    read_block,
)

# Time that a reset takes [s]. Longer than NEW_START_AFTER, so that the other nodes start anew.
RESET_TIME = 0.2
# What the service set_state leaves out is 0.
AT_REST = dict.fromkeys(InitialState._fields, 0.0)
# Time between two looks whether somebody wants the true state, by the stamps [ns].
LOOK_PERIOD = NANOSECONDS // 100


class SimulatedPlant(FurutaNode[PlantNodeParameters]):
    """Simulates the rig: publishes its samples and moves it from one to the next.

    It is held in its initial state until the first command arrives, and again after the service
    ``~/reset``. ``~/set_state`` does the same with another state. A reset takes ``RESET_TIME``, in
    which nothing is measured: from the gap the other nodes see that the motion does not continue.
    ``initial_state`` tells the new state, and by its stamp when the new motion begins.

    Attributes:
        sample: Number of the current sample.
        period: Sample time [ns].
        start: Time stamp of sample 0 [ns].
        held: Whether the rig is held in its initial state.
    """

    one_per_graph = True

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        super().__init__("plant", PlantNodeParameters, overrides)
        self._rig = self.parameters.plant
        self.sample = self.start = 0
        self.period = round(self._rig.sample_time * NANOSECONDS)
        self.held, self._is_resetting = True, False
        self._is_measured = False  # whether there is a measurement of the current sample
        self._memory, self._noise = initial_plant(self._rig), Noise(self._rig.seed)
        self._torque, self._message = 0.0, b""
        self._send = sender(self.create_publisher(MEASUREMENT.message, MEASUREMENT.name, QOS))
        self._truth = LoopPublisher(self, GROUND_TRUTH)
        self._look_at, self._is_truth_wanted = 0, False
        self._begun = self.create_publisher(INITIAL_STATE.message, INITIAL_STATE.name, LATCHED)
        self.create_service(Trigger, "~/reset", self._reset)
        self.create_service(SetParametersAtomically, "~/set_state", self._set_state)
        self.design_by(self._design)

    def _design(self, parameters: PlantNodeParameters) -> None:
        """Apply the new parameters between two samples."""
        self._plant = block(changed_plant(self._memory, self._rig, parameters.plant))
        self._rig = parameters.plant
        no_noise = np.zeros(NOISE_CHANNELS)
        self._read = for_types_of(read_block, self._memory, no_noise, 0.0, self._plant)
        self._move = for_types_of(move_block, self._memory, 0.0, self._plant)
        self._paused_from = parameters.run_until * NANOSECONDS / self.period - 0.5

    @property
    def x(self) -> np.ndarray:
        """Plant state (5,)."""
        state: np.ndarray = self._memory["x"][0]
        return state

    @property
    def time(self) -> float:
        """Time since the start [s]."""
        return self.sample * self.period / NANOSECONDS

    @property
    def stamp(self) -> int:
        """Time stamp of this sample [ns]."""
        return self.start + self.sample * self.period

    @property
    def paused(self) -> bool:
        """Whether ``run_until`` is reached."""
        return self.sample >= self._paused_from

    def statistics(self) -> dict[str, object]:
        """What the rig does, samples and time."""
        state = "held" if self.held else "paused" if self.paused else "moving"
        counts = {"rig": state, "samples": self.sample, "time [s]": f"{self.time:.3f}"}
        return counts | super().statistics()

    def publish_sample(self) -> None:
        """Read the sensors and publish the measurement and the true state."""
        stamp = self.stamp
        measurement, truth = self._read(self._memory, self._noise(), self._torque, self._plant)
        self._is_resetting = False
        if stamp >= self._look_at:
            self._look_at, self._is_truth_wanted = stamp + LOOK_PERIOD, self._truth.is_wanted()
        if self._is_truth_wanted:
            self._truth.publish(joint_state_bytes(stamp, truth), stamp)
        self._message, self._is_measured = joint_state_bytes(stamp, measurement), True
        self._send(self._message)

    def repeat_measurement(self) -> None:
        """Publish the measurement of this sample again, or now if that has failed."""
        if self._is_measured:
            self._send(self._message)
        else:
            self.publish_sample()

    def move(self, command: float) -> None:
        """Move the rig by one sample under ``command`` [V]."""
        if not self.held:
            self._torque = self._move(self._memory, command, self._plant)
        self.sample += 1
        self._is_measured = False

    def _reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._begin(self._rig.initial)
        response.success = True
        response.message = "held in the initial state until the next command"
        return response

    def _set_state(
        self, request: SetParametersAtomically.Request, response: SetParametersAtomically.Response
    ) -> SetParametersAtomically.Response:
        """Reset to the state that the request names, in the units and ranges of ``initial``."""
        try:
            self._begin(_state_of(request.parameters))
        except ParameterError as error:
            response.result.reason = str(error)
        else:
            response.result.successful = True
        return response

    def _begin(self, initial: InitialState) -> None:
        """Begin a new motion in a state."""
        self._memory = initial_plant(self._rig._replace(initial=initial))
        self.held = self._is_resetting = True
        self._torque = 0.0
        self.sample += round(RESET_TIME * NANOSECONDS / self.period)
        phi, phi_dot, theta, theta_dot = initial
        state = phi, phi_dot, theta, theta_dot, 0.0
        # A sample that was published moves on once more before the next one.
        first = self.stamp + self._is_measured * self.period
        self._begun.publish(joint_state_bytes(first, state))


def _state_of(parameters: Sequence[Any]) -> InitialState:
    """The state that parameter messages name. Raises ParameterError for any other content."""
    try:
        given = {each.name: parameter_value_to_python(each.value) for each in parameters}
    except RuntimeError:
        raise ParameterError("a value has a type that ROS does not know") from None
    unknown = sorted(given.keys() - AT_REST)
    if unknown:
        raise ParameterError(f"a state has {', '.join(AT_REST)}, given {shortened(unknown)}")
    return build(InitialState, AT_REST | given)

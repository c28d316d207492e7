"""The simulated rig as a node, without what decides when its samples begin."""

from collections.abc import Sequence

import numpy as np
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from furuta_model.block import block
from furuta_model.compiled import for_types_of
from furuta_ros.node import QOS, FurutaNode, LoopPublisher, sender
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import GROUND_TRUTH, MEASUREMENT
from furuta_ros.wire import joint_state_bytes
from furuta_sim.parameters import PlantNodeParameters
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
# Time between two looks whether somebody wants the true state, by the stamps [ns].
LOOK_PERIOD = NANOSECONDS // 100


class SimulatedPlant(FurutaNode[PlantNodeParameters]):
    """Simulates the rig: publishes its samples and moves it from one to the next.

    It is held in its initial state until the first command arrives, and again after the service
    ``~/reset``. A reset takes ``RESET_TIME``, in which nothing is measured: from the gap the other
    nodes see that the motion does not continue.

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
        self._memory, self._noise = initial_plant(self._rig), Noise(self._rig.seed)
        self._torque, self._message = 0.0, b""
        self._send = sender(self.create_publisher(MEASUREMENT.message, MEASUREMENT.name, QOS))
        self._truth = LoopPublisher(self, GROUND_TRUTH)
        self._look_at, self._is_truth_wanted = 0, False
        self.create_service(Trigger, "~/reset", self._reset)
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

    def publish_sample(self) -> None:
        """Read the sensors and publish the measurement and the true state."""
        stamp = self.stamp
        measurement, truth = self._read(self._memory, self._noise(), self._torque, self._plant)
        self._is_resetting = False
        if stamp >= self._look_at:
            self._look_at, self._is_truth_wanted = stamp + LOOK_PERIOD, self._truth.is_wanted()
        if self._is_truth_wanted:
            self._truth.publish(joint_state_bytes(stamp, truth), stamp)
        self._message = joint_state_bytes(stamp, measurement)
        self._send(self._message)

    def repeat_measurement(self) -> None:
        """Publish the measurement of this sample again."""
        self._send(self._message)

    def move(self, command: float) -> None:
        """Move the rig by one sample under ``command`` [V]."""
        if not self.held:
            self._torque = self._move(self._memory, command, self._plant)
        self.sample += 1

    def _reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._memory = initial_plant(self._rig)
        self.held = self._is_resetting = True
        self._torque = 0.0
        self.sample += round(RESET_TIME * NANOSECONDS / self.period)
        response.success = True
        response.message = "held in the initial state until the next command"
        return response

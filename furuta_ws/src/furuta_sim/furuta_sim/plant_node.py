"""Node ``plant``: command → measurement and ground_truth, in real time or in lock-step."""

import sys
from collections.abc import Sequence

import numpy as np
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled, for_types_of
from furuta_model.parts.plant_memory import PlantMemory
from furuta_model.state import SIGNALS
from furuta_ros.loop_publisher import LoopPublisher, sender
from furuta_ros.messages import read_value
from furuta_ros.spinning import run_node
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import COMMAND, GROUND_TRUTH, MEASUREMENT
from furuta_ros.wire import new_joint_state, write_joint_state
from furuta_sim.lockstep import LockStep
from furuta_sim.paced_node import PacedNode
from furuta_sim.parameters import PlantNodeParameters, PlantParameters
from furuta_sim.plant import (
    NOISE_CHANNELS,
    Noise,
    design_plant,
    initial_plant,
    move,
    read,
    true_friction,
)
from furuta_sim.realtime import RealTime

# Time that a reset takes [s]. Longer than NEW_START_AFTER, so that the other nodes start anew.
RESET_TIME = 0.2


class PlantNode(PacedNode):
    """Simulates the rig.

    Publishes ``measurement`` (NaN without a sensor; effort of the arm: the torque applied since
    the last one [V]) and ``ground_truth`` (effort: the true friction [V]); subscribes to
    ``command`` [V]. The rig is held in its initial state until the first command arrives, and
    again after the service ``~/reset``. A reset takes ``RESET_TIME``, in which nothing is measured:
    from the gap the other nodes see that the motion does not continue. :class:`RealTime` or
    :class:`LockStep` starts the samples.
    """

    def __init__(self, overrides: Sequence[Parameter] = ()) -> None:
        self._measurement = np.zeros(SIGNALS)
        self._messages = new_joint_state(), new_joint_state()  # measurement and true state
        self._torque = 0.0
        self._resetting = False
        self._rig, self._memory = PlantParameters(), new_memory(PlantMemory)
        super().__init__("plant", overrides)
        self.watch_parameters(self.parameters_changed)
        self._noise = Noise(self.parameters.plant.seed)
        self._memory = initial_plant(self.parameters.plant)
        self._send_measurement = sender(self.publish_on(MEASUREMENT))
        self._truth_publisher = LoopPublisher(self, GROUND_TRUTH)
        self.create_service(Trigger, "~/reset", self._reset)
        lockstep = self.parameters.clock == "lockstep"
        self.parameter_service.limited = not lockstep  # run_until may be set for every step
        self.pacing = (LockStep if lockstep else RealTime)(self)
        self.subscribe_to(COMMAND, self._on_command, raw=True)

    def parameters_changed(self, parameters: PlantNodeParameters) -> None:
        """Apply the new parameters between two samples."""
        if parameters.plant.pushes != self._rig.pushes:
            self._memory["pushed_from"] = self._memory["moved"]
        self._rig = parameters.plant
        self._block = block(design_plant(self._rig))
        self._read = for_types_of(
            _read,
            self._memory,
            np.zeros(NOISE_CHANNELS),
            self._block,
            self._measurement,
            self._torque,
            0,
            *self._messages,
        )
        self._move = for_types_of(_move, self._memory, 0.0, self._block)
        self.paused_from = parameters.run_until * NANOSECONDS / self.period - 0.5
        self.on_change()

    @property
    def x(self) -> np.ndarray:
        """Plant state (5,)."""
        state: np.ndarray = self._memory["x"][0]
        return state

    def publish_sample(self) -> None:
        """Read the sensors and publish the measurement and the true state."""
        measurement, truth = self._messages
        stamp, noise = self.stamp, self._noise()
        self._read(
            self._memory,
            noise,
            self._block,
            self._measurement,
            self._torque,
            stamp,
            measurement,
            truth,
        )
        self._resetting = False
        self._truth_publisher.publish_if_observed(truth.tobytes(), stamp)
        self.repeat_measurement()

    def repeat_measurement(self) -> None:
        """Publish the measurement of this sample, first or again."""
        self._send_measurement(self._messages[0].tobytes())

    def move(self, command: float) -> None:
        """Move the rig by one sample under ``command`` [V]."""
        if not self.held:
            self._torque = self._move(self._memory, command, self._block)
        self.sample += 1

    def _on_command(self, data: bytes) -> None:
        command = read_value(data)
        # A command during a reset belongs to a measurement from before it.
        self.held = self._resetting
        self.pacing.on_command(command)

    def _reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._memory = initial_plant(self._rig)
        self.held = self._resetting = True
        self._torque = 0.0
        self.sample += round(RESET_TIME * NANOSECONDS / self.period)
        response.success = True
        response.message = "held in the initial state until the next command"
        return response


@compiled
def _read(
    memory: np.ndarray,
    noise: np.ndarray,
    plant: np.ndarray,
    measurement: np.ndarray,
    torque: float,
    stamp: int,
    measurement_message: np.ndarray,
    truth_message: np.ndarray,
) -> None:
    """Read the sensors and write the messages of this sample."""
    read(memory[0], noise, plant[0], measurement)
    friction = true_friction(memory[0], plant[0])
    write_joint_state(measurement_message[0], stamp, measurement, torque)
    write_joint_state(truth_message[0], stamp, memory[0].x, friction)


@compiled
def _move(memory: np.ndarray, command: float, plant: np.ndarray) -> float:
    return move(memory[0], command, plant[0])


def main() -> None:
    """Entry point of the executable ``plant``."""
    sys.exit(run_node(PlantNode))

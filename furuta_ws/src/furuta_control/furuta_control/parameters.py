"""Parameters of the estimator and of the controller."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from furuta_control.excitation import ExcitationParameters
from furuta_model.linear import DesiredPoles
from furuta_model.parameters import INLINE, About, EarlierName, ParameterError
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors


class EstimatorParameters(NamedTuple):
    """Parameters of the node ``estimator``."""

    method: Annotated[
        str,
        About(
            "kalman: fuses all sensors with the applied torque and tells the friction too; "
            "lowpass: the paper's filter on the potentiometer, arm as measured",
            choices=("kalman", "lowpass"),
        ),
    ] = "kalman"
    model: FurutaPendulum = FurutaPendulum()
    sensors: Sensors = Sensors()
    friction_process_noise: Annotated[
        float,
        About(
            "kalman: how far friction walks in a second, grows as √t",
            "V/√s",
            1e-3,
            1e3,
            earlier_names=(EarlierName("friction_spread"),),
        ),
    ] = 0.3
    pendulum_process_noise: Annotated[
        float,
        About(
            "kalman: how far the pendulum's speed walks from the model",
            "rad/s/√s",
            1e-3,
            1e3,
            earlier_names=(EarlierName("pendulum_spread"),),
        ),
    ] = 0.1
    filter_bandwidth: Annotated[
        float, About("natural frequency of the potentiometer's filter", "rad/s", 0.1, 1e5)
    ] = 200.0
    filter_damping: Annotated[
        float, About("damping ratio of the potentiometer's filter", "", 0.1, 10.0)
    ] = 0.7
    sample_time: Annotated[
        float, About("time between measurements", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001


class ControllerParameters(NamedTuple):
    """Parameters of the node ``controller``."""

    enabled: Annotated[bool, About("drive the arm; 0 V where false")] = True
    poles: Annotated[DesiredPoles, INLINE] = DesiredPoles()
    gain: Annotated[
        tuple[float, ...],
        About("explicit L of u = -Lx in place of pole placement: four numbers, or empty", "V/x"),
    ] = ()
    model: FurutaPendulum = FurutaPendulum()
    voltage_limit: Annotated[float, About("largest command", "V", 0.0, 1e3)] = 10.0
    fall_angle: Annotated[
        float, About("pendulum angle beyond which the controller gives up: 0 V", "rad", 0.01, 3.0)
    ] = 0.7
    catch_angle: Annotated[
        float, About("pendulum angle within which it takes over again", "rad", 0.0, 3.0)
    ] = 0.2
    friction_timeout: Annotated[
        float,
        About("how long a friction estimate serves when no newer one comes, then 0 V", "s", 0, 10),
    ] = 0.01
    excitation: ExcitationParameters = ExcitationParameters()
    sample_time: Annotated[
        float, About("time between commands", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001

    def check(self) -> None:
        """Refuse a gain of the wrong length and angles in the wrong order."""
        if len(self.gain) not in (0, 4):
            raise ParameterError(
                "gain must be empty or four numbers (phi, phi_dot, theta, theta_dot), "
                f"given {len(self.gain)}"
            )
        if self.catch_angle > self.fall_angle:
            raise ParameterError(
                f"catch_angle must not exceed fall_angle, given {self.catch_angle:g} > "
                f"{self.fall_angle:g}"
            )

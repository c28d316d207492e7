"""Parameters of the simulated rig: true pendulum, true friction, sensors, drive and other parts.

The defaults are those of the paper's rig (Section 4).
"""

from math import pi
from typing import Annotated, NamedTuple

from furuta_model.friction.laws import LAWS, find_law
from furuta_model.friction.maxwell_slip import MAX_SPRINGS
from furuta_model.friction.parameters import Friction
from furuta_model.integration import MAX_SUBSTEPS, substeps_for
from furuta_model.late_drive import Drive
from furuta_model.parameters import INLINE, About, ParameterError
from furuta_model.parts.coupling import Coupling
from furuta_model.parts.disturbances import Pushes, Tilt, TorqueWaves
from furuta_model.parts.motion import Cogging, PendulumFriction
from furuta_model.parts.sensor_faults import SensorFaults
from furuta_model.parts.varied_friction import FrictionVariation
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Actuator, Sensors

CLOCKS = ("realtime", "lockstep")


class InitialState(NamedTuple):
    """State in which the rig is held until the first command arrives."""

    phi: Annotated[float, About("arm angle", "rad", -100, 100, read_only=True)] = 0.0
    phi_dot: Annotated[float, About("arm speed", "rad/s", -100, 100, read_only=True)] = 0.0
    theta: Annotated[float, About("pendulum angle, 0 upright", "rad", -pi, pi, read_only=True)] = (
        0.05
    )
    theta_dot: Annotated[float, About("pendulum speed", "rad/s", -100, 100, read_only=True)] = 0.0


class PlantFriction(NamedTuple):
    """Friction in the arm's joint: the law, the parameters that all laws share, and variation."""

    law: Annotated[str, About("friction law of the simulated arm", choices=LAWS, own=True)] = (
        "lugre"
    )
    parameters: Annotated[Friction, INLINE] = Friction()
    springs: Annotated[
        int, About("number of springs of maxwell_slip", "", 1, MAX_SPRINGS, shape=True)
    ] = 4
    variation: FrictionVariation = FrictionVariation()

    def check(self) -> None:
        """Reject an own law that cannot be compiled."""
        find_law(self.law)


class PlantParameters(NamedTuple):
    """The simulated rig."""

    model: FurutaPendulum = FurutaPendulum()
    friction: PlantFriction = PlantFriction()
    sensors: Sensors = Sensors()
    actuator: Actuator = Actuator()
    drive: Drive = Drive()
    coupling: Coupling = Coupling()
    cogging: Cogging = Cogging()
    pendulum_friction: PendulumFriction = PendulumFriction()
    sensor_faults: SensorFaults = SensorFaults()
    pushes: Pushes = Pushes()
    waves: TorqueWaves = TorqueWaves()
    tilt: Tilt = Tilt()
    initial: InitialState = InitialState()
    sample_time: Annotated[float, About("time between samples", "s", 1e-5, 0.1, read_only=True)] = (
        0.001
    )
    seed: Annotated[int, About("seed of the sensors' noise", "", 0, 2**62, read_only=True)] = 0

    def check(self) -> None:
        """Reject a rig that is too stiff to simulate at its sample time."""
        if not substeps_for(self.sample_time, self.model, self.friction.parameters) <= MAX_SUBSTEPS:
            raise ParameterError(
                f"this rig needs more than {MAX_SUBSTEPS} integration steps per sample of "
                f"{self.sample_time:g} s: alpha * beta is too close to gamma², or sigma0, sigma1 "
                "or viscous is too large"
            )


class PlantNodeParameters(NamedTuple):
    """Parameters of the node ``plant``: the rig and its pacing."""

    plant: Annotated[PlantParameters, INLINE] = PlantParameters()
    clock: Annotated[
        str,
        About(
            "realtime: samples at absolute deadlines; lockstep: the next sample starts when the "
            "command for this one has arrived",
            choices=CLOCKS,
            read_only=True,
        ),
    ] = "realtime"
    run_until: Annotated[
        float,
        About("time at which the plant pauses until you raise this value", "s", 0, 1e9),
    ] = 1e9
    command_timeout: Annotated[
        float, About("realtime: age beyond which a command is replaced by 0 V", "s", 1e-3, 10.0)
    ] = 0.05

"""Library for the Furuta pendulum: models, simulation, limit cycles, identification, tuning.

It needs no ROS. The state is x = (φ, φ̇, θ, θ̇) everywhere: arm angle and speed, pendulum angle (zero
upright) and speed [rad, rad/s]. Torque and friction are in volts at the drive [V].

    >>> import furuta
    >>> loop = furuta.make_loop({"omega1": 7.0})
    >>> run = furuta.simulate(loop, seconds=60.0)
    >>> cycle = furuta.limit_cycle(loop)
    >>> print(f"{cycle.phi_peak_to_peak_rad:.3f} rad, {cycle.period_s:.2f} s")
    0.511 rad, 2.37 s
"""

from importlib import import_module
from inspect import isfunction
from typing import TYPE_CHECKING, Any

from furuta.lazy import public_names

# The public names. Type checkers read this list, and so does the code below: a module is imported
# when one of its names is first used. A study that only simulates needs neither scipy's optimisers
# nor the readers of recordings.
if TYPE_CHECKING:
    from furuta.axis.axis import Axis as Axis
    from furuta.axis.axis import Cascade as Cascade
    from furuta.axis.axis import Pid as Pid
    from furuta.axis.joint_file import read_joint_file as read_joint_file
    from furuta.bodies import AxisBody as AxisBody
    from furuta.bodies import JointBody as JointBody
    from furuta.bodies import PendulumBody as PendulumBody
    from furuta.bodies import ServoBody as ServoBody
    from furuta.cycles import cycle_branch as cycle_branch
    from furuta.cycles import cycle_map as cycle_map
    from furuta.cycles import friction_joint as friction_joint
    from furuta.cycles import limit_cycle as limit_cycle
    from furuta.cycles import predict_cycles as predict_cycles
    from furuta.exports import export_c as export_c
    from furuta.exports import export_joint as export_joint
    from furuta.identified_models import identified_rig as identified_rig
    from furuta.identified_models import identify as identify
    from furuta.loops import load_rig as load_rig
    from furuta.loops import make_loop as make_loop
    from furuta.models import friction_law as friction_law
    from furuta.models import friction_nonlinearity as friction_nonlinearity
    from furuta.models import linear_model as linear_model
    from furuta.models import linearize as linearize
    from furuta.models import place_poles as place_poles
    from furuta.motions import measure as measure
    from furuta.motions import simulate as simulate
    from furuta.motions import tune as tune
    from furuta.recordings import load_series as load_series
    from furuta.recordings import read_recording as read_recording
    from furuta.servo_axes import servo_cycle as servo_cycle
    from furuta.servo_axes import simulate_axis as simulate_axis
    from furuta.servo_axes import study_axis as study_axis
    from furuta.tables import compare as compare
    from furuta.tables import random_rigs as random_rigs
    from furuta.tables import sweep as sweep
    from furuta.tables import swing_up as swing_up
    from furuta_hw.rigs.rig import Rig as Rig
    from furuta_model.friction.law import Law as Law
    from furuta_model.friction.parameters import Friction as Friction
    from furuta_model.linear import DesiredPoles as DesiredPoles
    from furuta_model.parameters import ParameterError as ParameterError
    from furuta_model.pendulum import FurutaPendulum as FurutaPendulum
    from furuta_recordings.readers import read_axis as read_axis
    from furuta_recordings.recording import Recording as Recording
    from furuta_sim.simulation.closed_loop import Loop as Loop

    __version__: str

_MODULE_OF = public_names(__file__)
__all__ = list(_MODULE_OF)


def __getattr__(name: str) -> Any:
    """The value of a name when it is first used; PEP 562."""
    if name not in (*__all__, "__version__"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return globals().setdefault(name, _found(name))


def __dir__() -> list[str]:
    """The names in use and those that nobody has used yet."""
    return sorted({*globals(), *__all__})


def _found(name: str) -> Any:
    """A public name. A function rejects an argument that its annotation does not allow.

    Inside the library none does, so loops over a function cost nothing.
    """
    if name == "__version__":
        return import_module("importlib.metadata").version(__name__)
    value = getattr(import_module(_MODULE_OF[name]), name)
    if isfunction(value):
        value = import_module("furuta.arguments").checked(value)
        value.__module__ = __name__  # where pickle finds it
    return value

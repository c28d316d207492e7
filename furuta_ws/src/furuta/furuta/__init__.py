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

if TYPE_CHECKING:
    from furuta.axis.axis import Axis, Cascade, Pid, servo_cycle, servo_motions
    from furuta.axis.compensations import compare_on_axis
    from furuta.axis.draws import consequences, drawn_axes, identified_axis
    from furuta.axis.simulation import simulate_axis
    from furuta.describing_functions.describing_function import describing_function
    from furuta.limit_cycles.joint import Joint, JointCycle, branch
    from furuta.limit_cycles.pendulum_loop import IdealLoop
    from furuta.limit_cycles.periodic_orbit import LimitCycle
    from furuta.loops import ideal_loop, load_rig, make_loop, rig_names
    from furuta.models import friction_law, friction_nonlinearity, linearize, place_poles
    from furuta.motions import (
        friction_joint,
        limit_cycle,
        measure,
        predict_cycles,
        simulate,
        trace_cycle,
        tune,
    )
    from furuta.recordings import (
        identified_values,
        identify,
        load_series,
        read_recording,
        simulated_series,
        write_series,
    )
    from furuta.tables import compare, random_rigs, sweep
    from furuta_hw.rigs.rig import Rig
    from furuta_identification.axis.identify import identify_axis
    from furuta_model.friction.law import Law
    from furuta_model.friction.parameters import Friction
    from furuta_model.linear import DesiredPoles
    from furuta_model.parameters import ParameterError
    from furuta_model.pendulum import FurutaPendulum
    from furuta_recordings.readers import read_axis
    from furuta_recordings.recording import Recording
    from furuta_recordings.series_columns import COLUMNS
    from furuta_sim.simulation.closed_loop import Loop, Record

    __version__: str

__all__ = [
    "COLUMNS",
    "Axis",
    "Cascade",
    "DesiredPoles",
    "Friction",
    "FurutaPendulum",
    "IdealLoop",
    "Joint",
    "JointCycle",
    "Law",
    "LimitCycle",
    "Loop",
    "ParameterError",
    "Pid",
    "Record",
    "Recording",
    "Rig",
    "__version__",
    "branch",
    "compare",
    "compare_on_axis",
    "consequences",
    "describing_function",
    "drawn_axes",
    "friction_joint",
    "friction_law",
    "friction_nonlinearity",
    "ideal_loop",
    "identified_axis",
    "identified_values",
    "identify",
    "identify_axis",
    "limit_cycle",
    "linearize",
    "load_rig",
    "load_series",
    "make_loop",
    "measure",
    "place_poles",
    "predict_cycles",
    "random_rigs",
    "read_axis",
    "read_recording",
    "rig_names",
    "servo_cycle",
    "servo_motions",
    "simulate",
    "simulate_axis",
    "simulated_series",
    "sweep",
    "trace_cycle",
    "tune",
    "write_series",
]

# Where each name comes from. A module is imported when one of its names is first used: a study that
# only simulates needs neither scipy's optimisers nor the readers of recordings.
_MODULES = {
    "furuta.axis.axis": "Axis Cascade Pid servo_cycle servo_motions",
    "furuta.axis.compensations": "compare_on_axis",
    "furuta.axis.draws": "consequences drawn_axes identified_axis",
    "furuta.axis.simulation": "simulate_axis",
    "furuta.describing_functions.describing_function": "describing_function",
    "furuta.limit_cycles.joint": "Joint JointCycle branch",
    "furuta.limit_cycles.pendulum_loop": "IdealLoop",
    "furuta.limit_cycles.periodic_orbit": "LimitCycle",
    "furuta.loops": "ideal_loop load_rig make_loop rig_names",
    "furuta.models": "friction_law friction_nonlinearity linearize place_poles",
    "furuta.motions": "friction_joint limit_cycle measure predict_cycles simulate trace_cycle tune",
    "furuta.recordings": (
        "identified_values identify load_series read_recording simulated_series write_series"
    ),
    "furuta.tables": "compare random_rigs sweep",
    "furuta_hw.rigs.rig": "Rig",
    "furuta_identification.axis.identify": "identify_axis",
    "furuta_model.friction.law": "Law",
    "furuta_model.friction.parameters": "Friction",
    "furuta_model.linear": "DesiredPoles",
    "furuta_model.parameters": "ParameterError",
    "furuta_model.pendulum": "FurutaPendulum",
    "furuta_recordings.readers": "read_axis",
    "furuta_recordings.recording": "Recording",
    "furuta_recordings.series_columns": "COLUMNS",
    "furuta_sim.simulation.closed_loop": "Loop Record",
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names.split()}


def __getattr__(name: str) -> Any:
    """The value of a name when it is first used; PEP 562."""
    if name not in __all__:
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
        value = import_module("furuta_model.arguments").checked(value)
        value.__module__ = __name__  # where pickle finds it
    return value

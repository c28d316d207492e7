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

from importlib.metadata import version
from inspect import isfunction

from furuta.axis.axis import Axis, Cascade, Pid, servo_cycle, servo_motions
from furuta.axis.compensations import compare_on_axis
from furuta.axis.draws import consequences, drawn_axes
from furuta.axis.identification import identified_axis
from furuta.axis.simulation import simulate_axis
from furuta.describing_functions.describing_function import describing_function
from furuta.limit_cycles.joint import Joint, JointCycle
from furuta.limit_cycles.joint import joint_branch as branch
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import LimitCycle
from furuta.loops import ideal_loop, load_rig, make_loop, rig_names
from furuta.models import friction_law, linearize, place_poles
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
from furuta_model.arguments import checked
from furuta_model.friction.law import Law
from furuta_model.friction.parameters import Friction
from furuta_model.linear import DesiredPoles
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum
from furuta_recordings.readers.axis_table import read_axis
from furuta_recordings.recording import Recording
from furuta_recordings.series_columns import COLUMNS
from furuta_sim.simulation.closed_loop import Loop, Record

__version__ = version("furuta")

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

# Every function rejects an argument that its annotation does not allow. Inside the library none
# does, so loops over a function cost nothing.
for _name in __all__:
    if isfunction(globals()[_name]):
        globals()[_name] = checked(globals()[_name])
        globals()[_name].__module__ = __name__  # where pickle finds it

"""What the functions of the library return: each as a dictionary, as text and as a figure."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from furuta.lazy import public_names

if TYPE_CHECKING:
    from furuta.axis.identified_axis import IdentifiedAxis as IdentifiedAxis
    from furuta.identification.axis.fit import AxisFit as AxisFit
    from furuta.identification.fitted import Fitted as Fitted
    from furuta.identification.fitting.free_swing import FreeSwing as FreeSwing
    from furuta.limit_cycles.joint import JointCycle as JointCycle
    from furuta.limit_cycles.periodic_orbit import LimitCycle as LimitCycle
    from furuta.outcomes import Outcome as Outcome
    from furuta.results.cycles import Branch as Branch
    from furuta.results.cycles import CycleMap as CycleMap
    from furuta.results.cycles import Prediction as Prediction
    from furuta.results.files import Files as Files
    from furuta.results.identified import Fits as Fits
    from furuta.results.linear import LinearModel as LinearModel
    from furuta.results.motion import Run as Run
    from furuta.results.result import Result as Result
    from furuta.results.rig_friction import MeasuredFriction as MeasuredFriction
    from furuta.results.rig_models import RigModel as RigModel
    from furuta.results.servo_axes import AxisRun as AxisRun
    from furuta.results.servo_axes import AxisStudy as AxisStudy
    from furuta.results.studies import Comparison as Comparison
    from furuta.results.studies import Demo as Demo
    from furuta.results.studies import Runs as Runs
    from furuta.results.studies import SwingUp as SwingUp
    from furuta.results.studies import Tuning as Tuning
    from furuta.results.table import Series as Series
    from furuta.results.table import Table as Table

_MODULE_OF = public_names(__file__)
__all__ = list(_MODULE_OF)


def __getattr__(name: str) -> Any:
    """The class of a result when it is first used; PEP 562."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return globals().setdefault(name, getattr(import_module(_MODULE_OF[name]), name))


def __dir__() -> list[str]:
    """The classes in use and those that nobody has used yet."""
    return sorted({*globals(), *__all__})

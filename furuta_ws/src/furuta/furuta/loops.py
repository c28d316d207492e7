"""Makes closed loops from parameters by name and from rigs."""

from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.transfer import checked_feedback, transfer
from furuta_hw.rigs.rig import Rig
from furuta_model.accepted_parts import part_name
from furuta_model.friction.law import Law
from furuta_model.friction.laws import analysed_law
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError, declared, shortened, validated, values
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import PARTS, Loop

# Parameters of the plant that the ideal loop has, and what is ideal in it: sensors, sampling and
# converter. It is released by its user. It refuses all others unless they change nothing.
HAS = ("model.", "friction.law", *(f"friction.{name}" for name in Friction._fields))
IDEAL = ("sensors.", "sensor_faults.", "actuator.", "sample_time", "seed", "initial.", "pushes.")
LACKS = {
    each.name: each.default
    for each in declared(PlantParameters)
    if not (each.about.shape or each.name.startswith((*HAS, *IDEAL)))
}

# Gains of u = l·x, which have names here although they are no parameters of a node.
GAINS = ("l1", "l2", "l3", "l4")

# A function of the user's own, or a law made of some.
Part = Callable[..., Any] | Law


def load_rig(name: str | Path) -> Rig:
    """A rig by name, or from a rig file.

    Args:
        name: A rig of the library, such as paper or qube_servo_2 (the error for another name lists
            them all), or the path of a file that ends in .yaml.

    Returns:
        Model, friction, calibration, line and safety limits; each field has its unit.

    Raises:
        ParameterError: There is no such rig, or its file has an error.
    """
    from furuta_hw.rigs.known_rigs import find_rig

    return find_rig(str(name))


def make_loop(
    values: Mapping[str, Any] | Iterable[str] | None = None,
    *,
    rig: Rig | str | Path | None = None,
    files: Iterable[str | Path] = (),
) -> Loop:
    """A closed loop from parameters by name, a rig and parameter files.

    Args:
        values: Parameters by name, in the units of the installed parameter files. ``alpha0`` sets
            the parameter wherever it occurs, ``plant.friction.alpha0`` only the true friction. A
            choice of a part, such as ``friction.law``, can be a function or :class:`furuta.Law`. Or
            texts NAME=VALUE, as of ``--set`` on the command line.
        rig: A rig, its name or its file; by default the rig of the paper.
        files: ROS parameter files. Later ones take precedence, ``values`` over all of them.

    Returns:
        The loop, as :func:`furuta.simulate` and :func:`furuta.limit_cycle` take it.

    Raises:
        ParameterError: A name is unknown, a value is not allowed, or a file has an error.
    """
    from furuta.settings.settings import rig_settings

    if rig is not None and not isinstance(rig, Rig):
        rig = load_rig(rig)
    return loop_from(None if rig is None else rig_settings(rig), values, files)


def loop_from(
    base: Any, values: Mapping[str, Any] | Iterable[str] | None, files: Iterable[str | Path]
) -> Loop:
    """A loop from settings, None for the defaults; the rest is as of :func:`make_loop`."""
    from furuta.settings import settings

    if values is not None and not isinstance(values, Mapping):
        return settings.loop(settings.load_settings(map(Path, files), values, base))
    given = settings.collect_settings(map(Path, files), [], base)
    return settings.loop_with(given, {k: plain_value(value) for k, value in (values or {}).items()})


@lru_cache
def checked_loop(loop: Loop | None) -> Loop:
    """The loop, by default the paper's; ParameterError if a value is out of its range."""
    parts: Any = loop or Loop()
    return Loop(*map(validated, parts))


def with_parts(
    loop: Loop | None,
    friction: Part | None = None,
    compensation: Part | None = None,
    controller: Part | None = None,
    estimator: Part | None = None,
) -> Loop:
    """The loop with parts of one's own, which :func:`furuta.simulate` describes."""
    plant, estimation, observer, control = checked_loop(loop)
    if friction is not None:
        law = plant.friction._replace(law=part_name(friction))
        plant = plant._replace(friction=law)
    if compensation is not None:
        observer = observer._replace(compensation=part_name(compensation))
    if controller is not None:
        control = control._replace(mode=part_name(controller))
    if estimator is not None:
        estimation = estimation._replace(method=part_name(estimator))
    return Loop(plant, estimation, observer, control)


def ideal_loop(
    loop: Loop | None = None,
    values: Mapping[str, float] | None = None,
    law: str | None = None,
    feedback: Iterable[float] | None = None,
    linear: bool = False,
) -> IdealLoop:
    """A loop with all states measured, without sampling and saturation.

    ``values`` are those of parameters by name, or of the gains :data:`GAINS`, which come last. The
    rest is as of :func:`furuta.limit_cycle`. The feedback need not stabilise the pendulum.

    Raises :class:`ParameterError` if the law is not analysed, the plant has what the ideal loop
    lacks, or the feedback is not four finite numbers.
    """
    from furuta.settings.settings import loop_settings, loop_with

    loop, values = checked_loop(loop), values or {}
    named = {name: float(value) for name, value in values.items() if name not in GAINS}
    if named:
        loop = loop_with(loop_settings(loop), named)
    _require_plain(loop.plant)
    friction = loop.plant.friction
    analysed = analysed_law(law or friction.law, friction.parameters)
    gains = [-gain for gain in loop.controller.feedback_gain] if feedback is None else feedback
    usual = zip(GAINS, checked_feedback(list(gains)), strict=True)
    l1, l2, l3, l4 = (float(values.get(*pair)) for pair in usual)
    return IdealLoop(loop.plant.model, analysed, l1, l2, l3, l4, linear)


def value_of(loop: Loop, name: str, feedback: Iterable[float] | None = None) -> float | None:
    """The value of a parameter or gain in a loop, None if nodes have different values."""
    from furuta.settings.parameter_names import parameters_named
    from furuta.settings.settings import loop_settings

    if name in GAINS:
        return float(getattr(ideal_loop(loop, feedback=feedback), name))
    settings = loop_settings(loop)
    found = {
        settings[node].get(declared.name, declared.default)
        for node, declared in parameters_named(name)
    }
    return float(found.pop()) if len(found) == 1 else None


def require_varied(name: str) -> None:
    """Reject a name that is no number of the ideal loop."""
    from furuta.settings.parameter_names import parameters_named

    for node, parameter in () if name in GAINS else parameters_named(name):
        if node == PARTS[0] and parameter.name in LACKS:
            raise ParameterError(f"the ideal loop has no plant.{parameter.name} to vary")
        if parameter.kind not in (float, int):
            raise ParameterError(f"{name} is not a number")


def _require_plain(plant: PlantParameters) -> None:
    """Reject a plant that has what the ideal loop lacks."""
    given = values(plant)
    acting = [name for name, off in LACKS.items() if np.any(np.array(given[name]) != off)]
    if acting:
        raise ParameterError(
            "exact cycles and describing functions leave out "
            + ", ".join(f"plant.{name} = {shortened(given[name])}" for name in acting)
            + f": simulate, or set {'it' if len(acting) == 1 else 'them'} to 0"
        )


def left_out(loop: Loop) -> tuple[str, ...]:
    """Names of the parameters that the ideal loop idealises, where they are not the default."""
    given, usual = values(loop.plant), values(PlantParameters())
    changed = [name for name in usual if name.startswith(IDEAL) and given[name] != usual[name]]
    compensated = ["friction_observer.compensation"] * (loop.observer.compensation != "none")
    return (*(f"plant.{name}" for name in changed), *compensated)


def require_stabilising(ideal: IdealLoop) -> None:
    """Reject a feedback whose loop is unstable without friction."""
    poles = transfer(ideal.body, ideal.gains).poles
    worst = poles[np.argmax(poles.real)]
    if worst.real > 1e-6:
        raise ParameterError(
            f"the feedback does not stabilise the pendulum even without friction: pole at "
            f"{worst.real:.4g}{worst.imag:+.4g}j 1/s"
        )


def plain_value(value: Any) -> Any:
    """A value without numpy: text, or a number or list. A part is its name."""
    if isinstance(value, str):
        return str(value)
    if callable(value) or isinstance(value, Law):
        return part_name(value)
    plain = np.asarray(value).tolist()
    if plain is None or isinstance(plain, (dict, complex)):
        raise ParameterError(
            f"a parameter must be a number, text or list, given {shortened(value)}"
        )
    return plain

"""Joint files: ROS parameter files with what compensates the friction of identified joints.

Each joint has a section for its node ``friction_observer``, in the namespace of its name, and one
with its controller if that is known. A recording does not show bristle, noise and rates. They are
those of the paper's arm, in the units in which the joint resembles it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from furuta.axis.axis import NO_RULE, Cascade, Controller, IntegralRule, Pid
from furuta.axis.draws import identified_axis, left_out
from furuta.axis.identified_axis import IdentifiedAxis
from furuta.axis.servo import POLES, observer_parameters, paper_units
from furuta.settings.nodes import CONTROLLER, FRICTION_OBSERVER
from furuta.settings.parameter_names import parameters_in
from furuta_model.parameters import ParameterError, build, number_from_text, shortened, values
from furuta_ros.parameter_files import PARAMETERS, is_of_ros, read_sections
from furuta_ros.whole_files import whole_file

# The section that no node reads: what studies need of the fit.
IDENTIFIED = "identified"
CONTROLLERS: dict[str, type[Pid] | type[Cascade]] = {"pid": Pid, "cascade": Cascade}
# Found values by their names in a fit. Those of the axis have the prefix ``axis.`` in the file.
OF_FRICTION = ("alpha0", "alpha1", "stribeck_velocity", "asymmetry")
OF_LOAD = ("offset", "gravity_sin", "gravity_cos")
OF_AXIS = ("inertia", "viscous", *OF_LOAD)
# Compensation if no controller is known with which others could be compared. LuGre can hunt where
# the true level is a fourth below that of the file; what learns the level does not.
USUAL = "recommended"
# What a joint must have: the defaults of these are the pendulum's.
NEEDED = ("sample_time", "alpha0", "alpha1", "stribeck_velocity", "sigma0", "sigma1")
# Digits that are written for people, and that a number has.
DIGITS, EXACT = 6, 17


class JointFile(NamedTuple):
    """What a joint file says of one joint: its parameters by full name, its controller and rule.

    ``identified`` is the axis, if the file has it, for :func:`furuta.study_axis`.
    """

    joint: str
    parameters: dict[str, Any]
    controller: Controller | None
    rule: IntegralRule = NO_RULE
    identified: IdentifiedAxis | None = None

    def axis(self) -> IdentifiedAxis:
        """The identified axis.

        Raises:
            ParameterError: The file does not have it.
        """
        if self.identified is None:
            raise ParameterError(f"the joint file has no section {IDENTIFIED} of {self.joint}")
        return self.identified

    def known(self) -> Controller:
        """The controller.

        Raises:
            ParameterError: The file does not have it.
        """
        if self.controller is None:
            raise ParameterError(f"the file has no controller of {self.joint}: give --pid")
        return self.controller


def joint_parameters(
    fit: IdentifiedAxis,
    joint: str,
    sample_time: float,
    controller: Controller | None = None,
    recommended: str | None = None,
) -> dict[str, Any]:
    """Parameters of the node ``friction_observer`` for an identified joint, by full name.

    Raises :class:`ParameterError` if no friction was found.
    """
    if not fit.values.get("alpha0", 0.0) > 0.0:
        raise ParameterError(f"{joint}: no dry friction found, so there is nothing to compensate")
    axis, compensation = identified_axis(fit), recommended or USUAL
    units = paper_units(axis, controller)
    delay = max(fit.values.get("delay", 0.0), 0.0)
    suited = observer_parameters(axis, units, compensation, fit.resolution, sample_time, delay)
    load = {name: fit.values.get(name, 0.0) for name in OF_LOAD}
    return values(suited._replace(joint=joint, axis=suited.axis._replace(**load)))


def write_joint_file(
    path: str | Path,
    fits: Mapping[str, IdentifiedAxis],
    controller: Controller | None = None,
    recommended: str | None = None,
    rule: IntegralRule = NO_RULE,
) -> None:
    """Write identified joints, by name, to a joint file, with a controller if it is known.

    Raises :class:`ParameterError` if no friction was found, or two names are one for ROS.
    """
    spaces = {namespace_of(joint): joint for joint in fits}
    if len(spaces) < len(fits):
        raise ParameterError(f"joints have the same name in ROS: {', '.join(fits)}")
    lines = ["# Joint file of furuta axis. Units: N m, rad, kg m² and s, or N, m, kg and s."]
    for space, joint in spaces.items():
        fit = fits[joint]
        sample_time = float(f"{fit.interval:.4g}")
        written = joint_parameters(fit, joint, sample_time, controller, recommended)
        lines += _about(fit, controller)
        lines += _section(f"/{space}/{FRICTION_OBSERVER}", written, _comments(fit))
        if controller is not None:
            name = type(controller).__name__.lower()
            gains = [*controller[:3], *filter(None, controller[3:])]
            changed = rule._asdict() if rule != NO_RULE else {}
            lines += _section(f"/{space}/{CONTROLLER}", {name: gains} | changed, {})
        lines += _section(f"/{space}/{IDENTIFIED}", fit.kept(), {}, EXACT)
    with whole_file(Path(path)) as file:
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def namespace_of(joint: str) -> str:
    """The joint's name with ``_`` for what ROS does not allow in a namespace."""
    name = re.sub(r"\W", "_", joint, flags=re.ASCII)
    return name if re.match("[A-Za-z_]", name) else f"_{name}"


def _about(fit: IdentifiedAxis, controller: Controller | None) -> Iterator[str]:
    """Where the values of a joint are from, as comments."""
    yield f"# Usable: {_one_line(fit.verdict.sentence())}."
    yield from (f"# {_one_line(finding)}." for finding in fit.findings)
    suited = "the controller below" if controller else f"poles at about {POLES:g} 1/s"
    yield f"# Found values have their standard errors. Those of bristle and rates suit {suited}."
    unused = [name for name in left_out(fit) if name not in OF_AXIS]
    if unused:
        yield f"# Found, but not compensated: {', '.join(unused)}."


def _comments(fit: IdentifiedAxis) -> dict[str, str]:
    """Standard errors by the names of the file, or why there is no value."""
    names = {name: name for name in OF_FRICTION} | {f"axis.{name}": name for name in OF_AXIS}
    errors = {name: f"± {error:.2g}" for name, error in fit.standard_errors.items()}
    about = fit.undetermined | errors
    if about.get("stribeck_velocity") == about.get("alpha1"):
        del names["stribeck_velocity"]
    return {name: about[own] for name, own in names.items() if own in about}


def _section(
    key: str, parameters: Mapping[str, Any], about: Mapping[str, str], digits: int = DIGITS
) -> Iterator[str]:
    yield f"{key}:"
    yield f"  {PARAMETERS}:"
    for name, value in parameters.items():
        comment = f"  # {_one_line(about[name])}" if name in about else ""
        yield f"    {name}: {_text(value, digits)}{comment}"


def _text(value: Any, digits: int) -> str:
    """A value in YAML, on one line; a number with so many ``digits``."""
    plain = float(f"{value:.{digits}g}") if isinstance(value, float) else value
    return str(yaml.safe_dump(plain, default_flow_style=True, width=np.inf)).splitlines()[0]


def _one_line(text: str) -> str:
    return " ".join(text.split())


def read_joint_file(path: str | Path, joint: str | None = None) -> JointFile:
    """A joint of a joint file.

    Args:
        path: The file.
        joint: Name of the joint; needed if the file has several.

    Raises:
        ParameterError: The file has no such joint, it is no joint file, or a name is unknown.
    """
    found = {section.key: section.parameters for section in read_sections(Path(path))}
    joints = {
        str(parameters["joint"]): key.rpartition("/")[0]
        for key, parameters in found.items()
        if key.rpartition("/")[2] == FRICTION_OBSERVER and "joint" in parameters
    }
    if not joints:
        raise ParameterError(
            f"{path} is no joint file: it has no section {FRICTION_OBSERVER} with a joint; `furuta "
            "identify --body axis --write` writes one"
        )
    listed = ", ".join(joints)
    if joint is None and len(joints) > 1:
        raise ParameterError(f"{path} has several joints, name one with --joint: {listed}")
    name = joint or next(iter(joints))
    if name not in joints:
        raise ParameterError(f"{path} has no joint {shortened(name)[1:-1]}; it has {listed}")
    space = joints[name]
    parameters = found[f"{space}/{FRICTION_OBSERVER}"]
    gains = found.get(f"{space}/{CONTROLLER}")
    controller = None if gains is None else _controller(path, gains)
    rule = build(IntegralRule, {n: v for n, v in (gains or {}).items() if n in NO_RULE._fields})
    if missing := [each for each in NEEDED if each not in parameters]:
        raise ParameterError(f"{path}: joint {name} has no {', '.join(missing)}")
    for each in parameters:
        if not is_of_ros(each):
            parameters_in(FRICTION_OBSERVER, each)
    kept = found.get(f"{space}/{IDENTIFIED}")
    identified = None if kept is None else IdentifiedAxis.of_kept(kept, f"{path}: joint {name}")
    return JointFile(name, parameters, controller, rule, identified)


def _controller(path: str | Path, given: Mapping[str, Any]) -> Controller:
    """The gains in a section of a joint file."""
    for name, kind in CONTROLLERS.items():
        gains = given.get(name)
        if isinstance(gains, list) and 2 <= len(gains) <= len(kind._fields):
            numbers = [number_from_text(gain) for gain in gains]
            if all(isinstance(n, (int, float)) and 0.0 <= n < np.inf for n in numbers):
                return kind(*map(float, numbers))
    allowed = " or ".join(f"{name} [{', '.join(k._fields)}]" for name, k in CONTROLLERS.items())
    raise ParameterError(
        f"{path}: the controller must be {allowed}, from 0 on, given {shortened(dict(given))}"
    )

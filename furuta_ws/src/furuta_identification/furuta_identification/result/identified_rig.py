"""Makes a rig from a fitted model: plant, friction, delay, tilt, waves, poles and uncertainty."""

from math import isfinite, pi
from pathlib import Path
from typing import Any

import numpy as np

from furuta_hw.rigs.rig import Rig, SafetyLimits
from furuta_hw.rigs.rig_file import rig_file_text
from furuta_hw.rigs.uncertainty import ABSOLUTE, NAMES, Uncertainty, wave_values
from furuta_identification.model import Model
from furuta_identification.result.base_rig import base_rig
from furuta_identification.shooting.unknowns import BY_NAME, LUGRE, assumed_spread
from furuta_identification.uncertainty.identifiability import undetermined
from furuta_model.friction.parameters import Friction
from furuta_model.parts.motion import PendulumFriction
from furuta_model.parts.tilt import Tilt
from furuta_model.parts.torque_waves import TorqueWaves
from furuta_model.pole_choice import quadratic_poles

# Pendulum angle [rad] at which a rig stops that was allowed to hang while it was recorded.
BALANCING_LIMIT = 0.75
# Names in rig files of unknowns that are named differently in a fit.
RIG_NAMES = {"coulomb": "alpha0"}


def identified_rig(model: Model, base: Rig) -> tuple[Rig, Uncertainty]:
    """The rig ``base``, which has the sensors, the line and the limits, with the fitted model."""
    values, drive = model.values, base.drive
    friction = _friction(model)
    limits = _limits_for_balancing(base, values["ceiling"])
    rig = base._replace(
        model=values.body,
        friction=friction,
        pendulum_friction=PendulumFriction(
            _allowed("pendulum_viscous", values["pendulum_viscous"]),
            _allowed("pendulum_coulomb", values["pendulum_coulomb"]),
        ),
        drive=drive._replace(
            delay=_allowed("delay", values["delay"] + model.command_delay),
            sign=-drive.sign if model.command_negated else drive.sign,
        ),
        tilt=Tilt(values["tilt_x"], values["tilt_y"]),
        waves=_waves(model),
        limits=limits,
        poles=quadratic_poles(values.body, friction.viscous, limits.voltage),
    )
    return rig, _uncertainty(model, (*NAMES, *wave_values(rig.waves)))


def _limits_for_balancing(base: Rig, ceiling: float) -> SafetyLimits:
    """The rig's limits within the drive's ``ceiling`` [V].

    A pendulum that was allowed to hang must not fall unnoticed.
    """
    angle = base.limits.pendulum_angle
    return base.limits._replace(
        voltage=min(base.limits.voltage, ceiling),
        pendulum_angle=BALANCING_LIMIT if angle > pi / 2 else angle,
    )


def _allowed(name: str, value: float) -> float:
    low, high = ABSOLUTE[name]
    return min(max(value, low), high)


def _friction(model: Model) -> Friction:
    """The arm's friction; what the data do not determine keeps the value of the paper's rig.

    Stiction and asymmetry that were not measured are not compensated, and viscous friction is never
    negative.
    """
    reasons = undetermined(model)
    friction = model.values.friction
    withheld: dict[str, Any] = {
        name: getattr(Friction(), name) for name in LUGRE if name in reasons
    }
    withheld |= {name: 0.0 for name in ("alpha1", "asymmetry") if name in reasons}
    return friction._replace(viscous=max(0.0, friction.viscous), **withheld)


def _waves(model: Model) -> TorqueWaves:
    waves = model.values.waves
    return (
        TorqueWaves(*(tuple(map(float, column)) for column in waves.T))
        if len(waves)
        else TorqueWaves()
    )


def _uncertainty(model: Model, known: tuple[str, ...]) -> Uncertainty:
    """The covariance of the fit; unknowns that were not fitted have their prior's spread.

    ``known`` are the names that a rig file can have.
    """
    fitted = [RIG_NAMES.get(name, name) for name in model.names]
    chosen = [index for index, name in enumerate(fitted) if name in known]
    names = [fitted[index] for index in chosen]
    covariance = model.covariance[np.ix_(chosen, chosen)]
    others = [
        (RIG_NAMES.get(name, name), assumed_spread(name))
        for name, about in BY_NAME.items()
        if name not in model.names and isfinite(about.spread)
    ]
    friction = [(name, spread) for name, spread in others if name in Friction._fields]
    size = len(names)
    whole = np.zeros((size + len(friction), size + len(friction)))
    whole[:size, :size] = covariance
    whole[range(size, len(whole)), range(size, len(whole))] = [spread**2 for _, spread in friction]
    return Uncertainty((*names, *(name for name, _ in friction)), whole)


def write_rig(model: Model, file: Path, given: Rig | None, source: Path) -> list[str]:
    """Write the rig file with sensors, line and limits of the ``given`` rig.

    Without one they are those of the recording at ``source``. Returns where they come from.
    """
    base, findings = (given, []) if given is not None else base_rig(source, model.recordings[0])
    rig, uncertainty = identified_rig(model, base)
    comments = [
        "Identified from recordings; load with --rig.",
        *findings,
        *(f"{name}: not determined: {reason}" for name, reason in undetermined(model).items()),
    ]
    file.write_text(rig_file_text(rig, uncertainty, file.stem, comments), encoding="utf-8")
    return findings

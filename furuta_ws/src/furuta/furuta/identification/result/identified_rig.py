"""Makes a rig from a fitted model: plant, friction, delay, tilt, waves, poles and uncertainty."""

from math import isfinite, pi
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from furuta.identification.model import Model
from furuta.identification.shooting.unknowns import LUGRE, UNKNOWNS, assumed_spread
from furuta.identification.uncertainty.identifiability import undetermined
from furuta.identification.unknowns import Key
from furuta.identification.verdict import Verdict
from furuta.pole_choice import quadratic_poles
from furuta_hw.rigs.calibration import ArmEncoder, DriveConverter, PendulumSensor, SpeedSensor
from furuta_hw.rigs.rig import Rig, RigLine
from furuta_hw.rigs.rig_file import load_rig, rig_file_text
from furuta_hw.rigs.uncertainty import ABSOLUTE, NAMES, Uncertainty, wave_values
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import build
from furuta_model.parts.disturbances import Tilt, TorqueWaves
from furuta_model.parts.motion import PendulumFriction
from furuta_model.sensors import Actuator, Sensors
from furuta_recordings.bags.bag import parameter_file_of
from furuta_recordings.recording import Recording
from furuta_ros.parameter_files import read_sections
from furuta_ros.whole_files import whole_file
from furuta_sim.parameters import PlantParameters

# Pendulum angle [rad] at which a rig stops that was allowed to hang while it was recorded.
BALANCING_LIMIT = 0.75
# Names in rig files of unknowns that are named differently in a fit.
RIG_NAMES = {"coulomb": "alpha0"}
# Counts per turn of an encoder that stands for ideal sensors.
MOST_COUNTS = 200_000
# Bits of a converter that stands for one without steps.
MOST_BITS = 16
# Sample times are whole multiples of this [s].
TIME_STEP = 1e-4


def identified_rig(model: Model, base: Rig) -> tuple[Rig, Uncertainty]:
    """The rig ``base``, which has the sensors, the line and the limits, with the fitted model."""
    values, drive = model.values, base.drive
    friction = _friction(model)
    angle = base.limits.pendulum_angle
    limits = base.limits._replace(
        voltage=min(base.limits.voltage, values["ceiling"]),
        pendulum_angle=BALANCING_LIMIT if angle > pi / 2 else angle,
    )
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
    if not len(waves):
        return TorqueWaves()
    return TorqueWaves(*(tuple(map(float, column)) for column in waves.T))


def _uncertainty(model: Model, known: tuple[str, ...]) -> Uncertainty:
    """The covariance of the fit; unknowns that were not fitted have their prior's spread.

    ``known`` are the names that a rig file can have.
    """
    fitted = [_name_in_rig(key) for key in model.keys]
    chosen = [index for index, name in enumerate(fitted) if name in known]
    spreads = {
        RIG_NAMES.get(name, name): assumed_spread(name)
        for name, about in UNKNOWNS.items()
        if name not in model.keys and isfinite(about.spread)
    }
    friction = [name for name in spreads if name in Friction._fields]
    covariance = block_diag(
        model.covariance[np.ix_(chosen, chosen)], np.diag([spreads[n] ** 2 for n in friction])
    )
    return Uncertainty((*(fitted[index] for index in chosen), *friction), covariance)


def _name_in_rig(key: Key) -> str:
    """The name of an unknown in a rig file."""
    if isinstance(key, str):
        return RIG_NAMES.get(key, key)
    return f"wave{key[1]}_{key[0]}"


def write_rig(model: Model, file: Path, base: Rig, findings: list[str], verdict: Verdict) -> None:
    """Write the rig file with sensors, line and limits of a rig, which ``findings`` are about.

    The file says what the ``verdict`` on the model is.
    """
    rig, uncertainty = identified_rig(model, base)
    comments = [
        "Identified from recordings; load with --rig.",
        f"Usable: {verdict.sentence()}",
        *findings,
        *(f"{name}: not determined: {reason}" for name, reason in undetermined(model).items()),
    ]
    with whole_file(file) as new:
        new.write_text(rig_file_text(rig, uncertainty, file.stem, comments), encoding="utf-8")


def base_rig(model: Model, given: Rig | None, source: str | Path | None) -> tuple[Rig, list[str]]:
    """The given rig, or that of a model's first recording at ``source``; and where it is from."""
    if given is not None:
        return given, []
    first = model.recordings[0]
    found, origin = _recorded_rig(Path(source) if source else None, first)
    return found, [f"{first.name}: {origin}"]


def _recorded_rig(path: Path | None, recording: Recording) -> tuple[Rig, str]:
    """Sensors, sample time and drive of the rig of a recording, and where they come from.

    They are those of the parameters that are stored in our own bags, else the paper's. Raises
    :class:`ParameterError` if these parameters, or the rig file that they name, are not valid.
    """
    parameters = parameter_file_of(path) if path else None
    given = read_sections(parameters) if parameters else []
    sections = {section.key.rpartition("/")[2]: section.parameters for section in given}
    file = str(sections.get("hardware_bridge", {}).get("rig", ""))
    if file and Path(file).is_file():
        return load_rig(Path(file)), f"sensors, line and limits of {file} (according to the bag)"
    if not file and "plant" in sections:
        return _rig_of_plant(sections["plant"]), "sensors and drive according to the bag"
    reason = f"{file} is gone" if file else "sensors are not known"
    time = max(TIME_STEP, round(round(recording.interval / TIME_STEP) * TIME_STEP, 9))
    return Rig(line=RigLine(sample_time=time)), (
        f"{reason}: those of the paper's rig are written; name the rig's own with --rig, or edit "
        "the file"
    )


def _rig_of_plant(plant: dict[str, Any]) -> Rig:
    """A rig with the sensors and the drive of a simulated plant."""
    sensors: Sensors = build(Sensors, plant, "sensors.")
    actuator: Actuator = build(Actuator, plant, "actuator.")
    time = plant.get("sample_time", PlantParameters().sample_time)

    def bits(given: int) -> int:
        return min(max(given or MOST_BITS, 2), MOST_BITS)

    return Rig(
        arm=ArmEncoder(sensors.encoder_counts or MOST_COUNTS),
        speed=SpeedSensor(range=sensors.tachometer_range, bits=bits(sensors.tachometer_bits)),
        pendulum=PendulumSensor(
            range=sensors.potentiometer_range, bits=bits(sensors.potentiometer_bits)
        ),
        drive=DriveConverter(actuator.voltage_range, bits(actuator.bits)),
        line=build(RigLine, {"line.sample_time": time}, "line."),
    )

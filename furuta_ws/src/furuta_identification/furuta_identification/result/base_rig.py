"""Finds what a recording says about sensors and sample time, where no rig file says it."""

from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from furuta_hw.rigs.calibration import ArmEncoder, DriveConverter, PendulumSensor, SpeedSensor
from furuta_hw.rigs.rig import Rig, RigLine
from furuta_hw.rigs.rig_file import load_rig
from furuta_model.parameters import ParameterError, build
from furuta_model.sensors import Sensors
from furuta_model.state import PHI, THETA
from furuta_recordings.bags.bag_files import parameter_file_of
from furuta_recordings.recording import Recording
from furuta_ros.yaml_files import read_yaml

# Counts per turn that an encoder can have, and the part of a count by which angles may miss it.
FEWEST_COUNTS, MOST_COUNTS, LARGEST_MISS = 16, 200_000, 0.02
# Sample times are whole multiples of this [s].
TIME_STEP = 1e-4


def base_rig(path: Path, recording: Recording) -> tuple[Rig, list[str]]:
    """Sensors, sample time and drive of the rig of a recording, and where they come from."""
    for reader in (_recorded_rig, _rig_from_angles):
        rig, source = reader(path, recording)
        if rig is not None:
            return rig, [f"{recording.name}: {source}"]
    time = _sample_time(recording)
    rig = Rig(line=RigLine(sample_time=time))
    return rig, [
        f"{recording.name}: sensors are not known: those of the paper's rig are written; name "
        "the rig's own with --rig, or edit the file"
    ]


def _recorded_rig(path: Path, recording: Recording) -> tuple[Rig | None, str]:
    """The rig of the parameters that are stored in our own bags."""
    try:
        parameters = parameter_file_of(path)
        content = read_yaml(parameters, "parameter file") if parameters else {}
        sections = {node: section["ros__parameters"] for node, section in content.items()}
        file = sections["hardware_bridge"]["rig"]
        if file:
            return load_rig(
                Path(file)
            ), f"sensors, line and limits of {file} (according to the bag)"
        return _rig_of_plant(sections["plant"]), "sensors and drive according to the bag"
    except (ParameterError, KeyError, TypeError, AttributeError, OSError):
        return None, ""


def _rig_of_plant(plant: dict[str, Any]) -> Rig:
    """A rig with the sensors and the drive of a simulated plant."""
    sensors: Sensors = build(Sensors, plant, "sensors.")
    counts, bits = int(sensors.encoder_counts), int(sensors.potentiometer_bits)
    return Rig(
        arm=ArmEncoder(counts or MOST_COUNTS),
        speed=SpeedSensor(
            range=sensors.tachometer_range, bits=min(max(int(sensors.tachometer_bits), 2), 16)
        ),
        pendulum=PendulumSensor(range=sensors.potentiometer_range, bits=min(max(bits, 2), 16)),
        drive=DriveConverter(
            plant["actuator.voltage_range"], min(max(int(plant["actuator.bits"]), 2), 16)
        ),
        line=RigLine(sample_time=plant["sample_time"]),
    )


def _rig_from_angles(path: Path, recording: Recording) -> tuple[Rig | None, str]:
    """Encoders with the counts of which all angles of the recording are multiples."""
    arm = counts_per_turn(recording.measured[:, PHI])
    pendulum = counts_per_turn(recording.measured[:, THETA])
    if not arm or not pendulum:
        return None, ""
    rig = Rig(
        arm=ArmEncoder(arm),
        speed=SpeedSensor("encoder"),
        pendulum=PendulumSensor("encoder", counts_per_turn=pendulum),
        line=RigLine(sample_time=_sample_time(recording)),
    )
    return rig, (
        f"encoders of {arm} and {pendulum} counts per turn, as the angles are quantised; signs, "
        "zeros, range of the drive and limits are those of the paper's rig"
    )


def counts_per_turn(angles: np.ndarray) -> int:
    """Counts per turn of the encoder that the ``angles`` (n,) [rad] are from; 0 if none fits."""
    steps = np.diff(np.unique(angles[np.isfinite(angles)]))
    steps = steps[steps > 2 * pi / MOST_COUNTS / 2]
    if not len(steps):
        return 0
    smallest = steps[steps < 1.5 * steps.min()].mean()
    counts = round(2 * pi / smallest)
    if not FEWEST_COUNTS <= counts <= MOST_COUNTS:
        return 0
    in_counts = steps[steps < 20 * smallest] * counts / (2 * pi)
    miss = np.abs(in_counts - np.round(in_counts))
    return counts if miss.max() < LARGEST_MISS else 0


def _sample_time(recording: Recording) -> float:
    """The sample time [s], rounded."""
    return max(TIME_STEP, round(round(recording.interval / TIME_STEP) * TIME_STEP, 9))

"""Reads files of ``furuta simulate --out``."""

import math
from pathlib import Path
from typing import BinaryIO
from zipfile import BadZipFile, ZipFile
from zlib import error as ZlibError  # noqa: N812 - an exception, whatever its name

import numpy as np
from numpy.lib import format as npy

from furuta_model.parameters import ParameterError, build
from furuta_model.parts.converter import Actuator
from furuta_model.state import RIGID_STATES
from furuta_recordings.readers.drive import through_drive
from furuta_recordings.recording import Recording
from furuta_ros.regular_files import open_regular

# Largest series that is read [bytes]: five signals of three hours at 1 kHz.
LARGEST_SERIES = 2**29
_BROKEN = (KeyError, ValueError, OSError, EOFError, BadZipFile, ZlibError, NotImplementedError)


def read_simulation(path: Path) -> tuple[Recording, list[str]]:
    """A recording from the series of a simulation."""
    try:
        with open_regular(path, "recording") as stream, ZipFile(stream) as file:
            recording = _recording(path, file)
            drive = _series(file, "drive") if "drive.npy" in file.namelist() else None
    except ParameterError:
        raise
    except (*_BROKEN, RuntimeError) as error:  # RuntimeError: encrypted
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ParameterError(f"{path} is not a file of `furuta simulate --out`: {reason}") from None
    if drive is None:
        return recording, []
    return through_drive(recording, _actuator(path, drive), "the file")


def _recording(path: Path, file: ZipFile) -> Recording:
    time = _series(file, "time")
    if "measurement.npy" not in file.namelist():
        raise ParameterError(
            f"{path} has estimates but no measurements, which identification needs; simulate again"
        )
    measured, command = _series(file, "measurement"), _series(file, "command")
    n = len(time)
    if time.shape != (n,) or command.shape != (n,) or measured.ndim != 2 or len(measured) != n:
        raise ValueError("its series have different lengths")
    if measured.shape[1] < RIGID_STATES:
        raise ValueError(f"a measurement needs {RIGID_STATES} columns")
    return Recording(path.name, time, np.array(measured[:, :RIGID_STATES]), time, command)


def _series(file: ZipFile, name: str) -> np.ndarray:
    """An array of numbers, read only if the file has as many as its header claims."""
    about = file.getinfo(f"{name}.npy")
    if about.file_size > LARGEST_SERIES:
        raise ValueError(f"{name} has {about.file_size} bytes, at most {LARGEST_SERIES} are read")
    with file.open(about) as stream:
        shape, dtype = _header(stream)  # type: ignore[arg-type]
        size = math.prod(shape) * dtype.itemsize
        if dtype.kind not in "fiub":
            raise ValueError(f"{name} holds {dtype}, not numbers")
        if not shape or size > about.file_size:
            raise ValueError(f"{name} claims the shape {shape}, and has {about.file_size} bytes")
    with file.open(about) as stream:
        return np.array(npy.read_array(stream, allow_pickle=False), dtype=float)


def _header(stream: BinaryIO) -> tuple[tuple[int, ...], np.dtype]:
    version = npy.read_magic(stream)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, dtype = read(stream)
    return shape, dtype


def _actuator(path: Path, drive: np.ndarray) -> Actuator:
    if drive.shape != (2,) or not np.all(np.isfinite(drive)):
        raise ParameterError(f"{path}: drive must be a voltage range and a number of bits")
    voltage_range, bits = drive
    return build(Actuator, {"voltage_range": float(voltage_range), "bits": int(bits)})

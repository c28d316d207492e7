"""A recording for identification: measurements and commands, each with their own times."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.sensors import Actuator, drive
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA, THETA_DOT

CHANNELS = ("arm angle", "arm speed", "pendulum angle", "pendulum speed")
UNITS = ("rad", "rad/s", "rad", "rad/s")


class Recording(NamedTuple):
    """Series of one recording, called ``name`` in messages.

    ``time`` (n,) [s], increasing but not necessarily evenly spaced; ``measured`` (n, 4) of x = (φ,
    φ̇, θ, θ̇), NaN where there is no value; ``command_time`` (m,) [s] and ``command`` (m,) [V]. A
    command holds until the next one; before the first the command is 0 V. ``in_radians`` is True if
    the recording names the unit of its angles, which are then in rad. Recordings with the same
    ``number`` are excerpts of one run. ``findings`` say how the content was interpreted. ``joint``
    names the only joint of the recording of an axis, ``units`` are those of its position and of its
    torque; ``position_unit`` is the unit that the file has for the position, with its size in them.
    ``start`` is when ``time`` is 0 [s], by the clock of the file; where that begins anew, the next
    run ``begins`` [s] a little after the one before.
    """

    name: str
    time: Annotated[np.ndarray, "n"]
    measured: Annotated[np.ndarray, "n", RIGID_STATES]
    command_time: Annotated[np.ndarray, "m"]
    command: Annotated[np.ndarray, "m"]
    in_radians: bool = False
    number: int = 0
    findings: tuple[str, ...] = ()
    joint: str = ""
    units: tuple[str, str] = ("rad", "N m")
    position_unit: tuple[str, float] = ("rad", 1.0)
    start: float = 0.0
    begins: tuple[float, ...] = ()

    def noting(self, finding: str) -> Recording:
        """With one more finding, which begins with the name."""
        return self._replace(findings=(*self.findings, f"{self.name}: {finding}"))

    @property
    def duration(self) -> float:
        """Length [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def interval(self) -> float:
        """The median time between two samples [s], where it increases; 0 if it never does."""
        steps = np.diff(self.time)
        forward = steps[steps > 0.0]
        return float(np.median(forward)) if len(forward) else 0.0

    @property
    def largest_command(self) -> float:
        """The size of the largest command [V]."""
        return float(np.max(np.abs(self.command)))

    def between(self, start: float, end: float) -> Recording:
        """The samples with start ≤ time < end, and all commands."""
        chosen = (self.time >= start) & (self.time < end)
        return self._replace(time=self.time[chosen], measured=self.measured[chosen])

    def reoriented(self, zero: float, pendulum: float, arm: float) -> Recording:
        """In other coordinates: θ = pendulum·measured + zero [rad], φ = arm·measured."""
        measured = self.measured.copy()
        measured[:, THETA] = pendulum * measured[:, THETA] + zero
        measured[:, THETA_DOT] *= pendulum
        measured[:, PHI] *= arm
        measured[:, PHI_DOT] *= arm
        return self._replace(measured=measured)

    def with_command_negated(self) -> Recording:
        """With the opposite sign of the command."""
        return self._replace(command=-self.command)

    def with_ceiling(self, ceiling: float) -> Recording:
        """With commands limited to ± the ``ceiling`` [V]."""
        return self._replace(command=np.clip(self.command, -ceiling, ceiling))

    def with_delayed_command(self, delay: float) -> Recording:
        """With the command ``delay`` [s] later."""
        return self._replace(command_time=self.command_time + delay)

    def through_drive(self, actuator: Actuator, source: str) -> Recording:
        """With the command limited and quantised as the drive does that ``source`` describes."""
        command = np.array([drive(float(u), actuator) for u in self.command])
        return self._replace(command=command).noting(
            f"command rounded to the drive's {actuator.bits} bits of ±{actuator.voltage_range:g} V "
            f"(according to {source})"
        )

    def commanded_at(self, time: np.ndarray) -> np.ndarray:
        """The command that holds at each time [V]."""
        if not len(self.command):
            return np.zeros(len(time))
        index = np.searchsorted(self.command_time, time + 1e-9, side="right") - 1
        return np.where(index >= 0, self.command[np.maximum(index, 0)], 0.0)


def findings_of(recordings: Sequence[Recording]) -> list[str]:
    """The findings on all recordings, those on several excerpts of one once."""
    return list(dict.fromkeys(text for recording in recordings for text in recording.findings))


def numbered(recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings, with numbers behind names that are not unique."""
    names = [recording.name for recording in recordings]
    return [
        r._replace(name=f"{r.name} ({k + 1})") if names.count(r.name) > 1 else r
        for k, r in enumerate(recordings)
    ]


def by_run(recordings: Sequence[Recording]) -> list[list[Recording]]:
    """The excerpts of each run, which have its ``number``."""
    numbers = sorted({recording.number for recording in recordings})
    return [[r for r in recordings if r.number == number] for number in numbers]

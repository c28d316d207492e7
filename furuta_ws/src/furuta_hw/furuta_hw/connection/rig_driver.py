"""The interface of a rig driver: samples, arming, voltages and stops in SI units."""

from abc import ABC, abstractmethod
from typing import Any, NamedTuple

from furuta_hw.rigs.rig import Rig

# Longest time that RigDriver.read may wait [s].
READ_TIMEOUT = 0.05


class RawCodes(NamedTuple):
    """The integer codes of a sample, before calibration. Commissioning finds zeros from them."""

    arm: int
    speed: int
    pendulum: int


class RigSample(NamedTuple):
    """One sample of a rig."""

    number: int  # counts the rig's sample periods, modulo 2³²
    arm_angle: float  # φ [rad]
    arm_speed: float  # φ̇ [rad/s]
    pendulum_angle: float  # θ [rad], zero upright
    voltage: float  # applied up to this sample [V]
    armed: bool  # the rig applies the voltages that it receives
    fault: bool = False  # the rig reports a fault
    watchdog: bool = False  # the rig's watchdog has stopped it since it was last armed
    at_rail: bool = False  # a converter is at an end of its range
    codes: RawCodes | None = None  # None if the driver has no access to codes


class LineStatistics(NamedTuple):
    """Frames counted since the line was opened."""

    lost: int = 0
    corrupt: int = 0
    repeated: int = 0
    other_sessions: int = 0
    discarded_by_rig: int = 0

    @property
    def bad(self) -> int:
        """Frames lost or corrupt in either direction."""
        return self.lost + self.corrupt + self.discarded_by_rig


class RigDriver(ABC):
    """Connects to one rig. Subclasses implement a protocol.

    ``read`` runs on a thread of its own. All other methods are called from one thread, ``restart``
    and ``close`` only while no ``read`` is running. Methods that send raise :class:`LineError` if
    the line does not accept the data.

    The rig must go to 0 V by itself if it receives no new voltage for ``rig.line.watchdog`` [s].
    """

    def __init__(self, port: str, rig: Rig) -> None:
        self.port = port
        self.rig = rig

    @abstractmethod
    def open(self) -> None:
        """Open the line and start the samples.

        If that fails, it leaves the line closed and raises :class:`LineError`.
        """

    @abstractmethod
    def close(self) -> None:
        """Close the line. The rig has been stopped before."""

    @abstractmethod
    def read(self) -> Any:
        """Wait for data for at most :data:`READ_TIMEOUT` and return it; empty if none came.

        Raises :class:`LineError` if the line fails.
        """

    @abstractmethod
    def decode(self, data: Any) -> list[RigSample]:
        """Convert data from :meth:`read` to the samples that it completes, each once, in order."""

    @abstractmethod
    def arm(self) -> None:
        """Tell the rig to apply the voltages that follow. It starts at 0 V."""

    @abstractmethod
    def drive(self, volts: float) -> None:
        """Apply a voltage [V] in answer to the newest decoded sample."""

    @abstractmethod
    def stop(self) -> None:
        """Disarm the rig and set it to 0 V."""

    def restart(self) -> None:
        """Restart the samples of a rig that has become silent. The rig is disarmed afterwards.

        If that fails, it leaves the line closed and raises :class:`LineError`.
        """
        try:
            self.stop()
        finally:
            self.close()
        self.open()

    def statistics(self) -> LineStatistics:
        """Return the frames counted since the line was opened."""
        return LineStatistics()

"""A rig that is armed, driven and stopped, as a system to explore.

``Guard``, ``GuardedRig`` and the reference ``Firmware``, whose rules the C core has too, are the
classes that the bridge and the emulated rig run. Between them frames are lost, repeated and late
for any time. The user arms and disarms, the host dies, the line dies.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple
from unittest.mock import patch

from proofs.explorer import shallow

from furuta_hw.bridge import guarded_rig
from furuta_hw.bridge.guarded_rig import GuardedRig
from furuta_hw.connection.rig_driver import RigSample
from furuta_hw.emulator.firmware import Firmware
from furuta_hw.guard import Guard
from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import ARMED, FAULT, WATCHDOG
from furuta_hw.rigs.rig import SafetyLimits

WATCHDOG_SAMPLES = 3
PERIOD = 0.01  # [s]
AGE = 2.5 * PERIOD  # after which the guard stops
SESSION, ZERO, DRIVEN = 7, 0, 100  # session number and codes
ON_THE_WAY = 2  # frames in each direction
LIMITS = SafetyLimits(command_age=AGE, estimate_age=AGE, measurement_age=AGE, slew_rate=1e7)


class Budget(NamedTuple):
    """How often each of these happens, in a run of so many ``ticks``."""

    ticks: int
    arms: int = 1
    disarms: int = 1
    losses: int = 1
    repetitions: int = 1
    deaths: int = 1  # of the host or of the line


class Connection:
    """The host's end of the line."""

    connected, failure = True, ""

    def __init__(self, rig: "Rig") -> None:
        self.rig = rig

    def samples(self) -> list[RigSample]:
        """The sample that has just arrived."""
        return [self.rig.arrived]

    def new_bad_frames(self) -> int:
        """None: the guard's count of them only makes it stop earlier."""
        return 0

    def drive(self, volts: float) -> None:
        """Send a voltage that answers the newest sample."""
        self.rig.send(frames.DriveFrame(SESSION, self.rig.newest, DRIVEN))

    def arm(self) -> None:
        """Send Arm."""
        self.rig.send(frames.ArmFrame(SESSION, self.rig.newest))

    def stop(self) -> None:
        """Send Stop."""
        self.rig.send(frames.StopFrame(SESSION))


class Rig:
    """A state: host, line and rig. Nothing that happens must happen, so silence is allowed."""

    done = True

    def __init__(self, budget: Budget) -> None:
        self.budget = budget
        self.firmware = Firmware(-DRIVEN, DRIVEN, ZERO)
        self.firmware._execute(frames.HelloFrame(frames.VERSION, SESSION, 10_000, WATCHDOG_SAMPLES))
        self.to_rig: tuple[Any, ...] = ()
        self.to_host: tuple[Any, ...] = ()
        self.now = 0.0
        self.newest, self.unanswered = 0, False
        self.arrived: Any = None
        self.host_lives = self.line_lives = True
        self.since_armed = 10  # ticks since the host was armed, by a user
        self.silent = 10  # ticks since the rig received a frame
        self.host = GuardedRig(Connection(self), Guard(LIMITS, PERIOD), lambda: None)

    @property
    def problem(self) -> str:
        """What must not be, or an empty string."""
        drives = self.firmware.armed or self.firmware.code != ZERO
        if drives and self.since_armed >= WATCHDOG_SAMPLES:
            return "armed although nobody has armed it within the watchdog"
        if drives and self.silent >= WATCHDOG_SAMPLES:
            return "armed although nothing is heard within the watchdog"
        return ""

    def send(self, frame: Any) -> None:
        """Put a frame of the host on the line."""
        if self.line_lives and len(self.to_rig) < ON_THE_WAY:
            self.to_rig += (frame,)

    def tick(self) -> None:
        """A sample of the rig, and a check by the host."""
        self.now += PERIOD
        *_, data, _ = self.firmware.sample(0, 0, 0).split(b"\0")
        if self.line_lives and len(self.to_host) < ON_THE_WAY:
            self.to_host += (frames.decode(data),)
        if self.host_lives:
            self.host.check()
        armed = self.host_lives and self.host.guard.armed
        self.since_armed = 0 if armed else min(10, self.since_armed + 1)
        self.silent = min(10, self.silent + 1)

    def rig_receives(self) -> None:
        """The oldest frame reaches the rig."""
        frame, *rest = self.to_rig
        self.to_rig = tuple(rest)
        self.silent = 0
        self.firmware._execute(frame)

    def host_receives(self) -> None:
        """The oldest sample reaches the host."""
        frame, *rest = self.to_host
        self.to_host = tuple(rest)
        bits = [bool(frame.status & bit) for bit in (ARMED, FAULT, WATCHDOG)]
        self.newest, self.unanswered = frame.sample, True
        self.arrived = RigSample(frame.sample, 0.0, 0.0, 0.0, 0.0, *bits)
        list(self.host.samples())

    def command(self) -> None:
        """The controller answers the newest sample."""
        self.unanswered = False
        self.host.guard.estimated()
        self.host.command(5.0)

    def arm(self) -> None:
        """A user arms the bridge."""
        if not self.host.arm():
            self.since_armed = 0

    def disarm(self) -> None:
        """A user disarms the bridge."""
        self.host.stop("disarmed by request")

    def lose(self) -> None:
        """The oldest frame to the rig is lost."""
        self.to_rig = self.to_rig[1:]

    def repeat(self) -> None:
        """The oldest frame to the rig comes twice."""
        self.to_rig = (self.to_rig[0], *self.to_rig)

    def kill_host(self) -> None:
        """The host's process ends at once."""
        self.host_lives = False

    def cut_line(self) -> None:
        """Nothing passes any more."""
        self.line_lives, self.to_rig, self.to_host = False, (), ()

    def copy(self) -> "Rig":
        """An independent copy."""
        new = shallow(self)
        new.firmware, new.host = shallow(self.firmware), shallow(self.host)
        new.host.guard, new.host.connection = shallow(self.host.guard), Connection(new)
        return new

    def key(self) -> Any:
        """What determines how it goes on."""
        guard = {name: value for name, value in vars(self.host.guard).items() if name != "limits"}
        return (
            (self.budget, self.to_rig, self.to_host, self.newest, self.unanswered),
            (self.host_lives, self.line_lives, self.since_armed, self.silent),
            tuple(value for name, value in vars(self.firmware).items() if name != "_reader"),
            (tuple(guard.values()), self.host._was_armed),
        )


# Each step with what it takes from the budget.
SPENDING = {
    "tick": "ticks",
    "arm": "arms",
    "disarm": "disarms",
    "lose": "losses",
    "repeat": "repetitions",
    "kill_host": "deaths",
    "cut_line": "deaths",
}


def steps(rig: Rig) -> Iterator[tuple[str, Rig]]:
    """All that can happen next."""
    possible = {
        "rig_receives": bool(rig.to_rig),
        "host_receives": rig.host_lives and bool(rig.to_host),
        "command": rig.host_lives and rig.unanswered,
        "tick": True,
        "arm": rig.host_lives and rig.arrived is not None,
        "disarm": rig.host_lives,
        "lose": bool(rig.to_rig),
        "repeat": bool(rig.to_rig),
        "kill_host": rig.host_lives,
        "cut_line": rig.line_lives,
    }
    for name in (name for name, can in possible.items() if can):
        spent = SPENDING.get(name)
        if spent and getattr(rig.budget, spent) == 0:
            continue
        new = rig.copy()
        if spent:
            new.budget = rig.budget._replace(**{spent: getattr(rig.budget, spent) - 1})
        NOW.rig = new
        getattr(new, name)()
        yield name, new


class _Now:
    rig: Any = None


NOW = _Now()


@contextmanager
def own_clock() -> Iterator[None]:
    """``GuardedRig`` with the clock of the rig that acts."""
    with patch.object(guarded_rig, "monotonic", lambda: NOW.rig.now):
        yield

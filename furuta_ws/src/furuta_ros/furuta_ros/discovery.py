"""Which other nodes a process discovers: those of this machine, unless the user chooses others.

ROS itself joins the network by default. A graph that drives a rig must not, so a process of this
project sets ``ROS_AUTOMATIC_DISCOVERY_RANGE`` before ROS starts, if the user has chosen nothing.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PEERS = "ROS_STATIC_PEERS"
SERVER = "ROS_DISCOVERY_SERVER"
# An earlier variable of ROS, which still has precedence if it is 1.
LOCALHOST_ONLY = "ROS_LOCALHOST_ONLY"
# Names a file with settings of Fast DDS.
PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"


def restrict_discovery() -> None:
    """Choose this machine only, if no environment variable holds another choice."""
    if not any(os.environ.get(name) for name in (RANGE, PEERS, SERVER)):
        os.environ[RANGE] = "LOCALHOST"


def announce_often() -> None:
    """Let processes discover each other without delay, if the user has chosen no settings."""
    os.environ.setdefault(PROFILES, str(Path(__file__).with_name("middleware.xml")))


@contextmanager
def no_discovery() -> Iterator[None]:
    """ROS started inside the ``with`` block discovers no other process, whatever was chosen."""
    names = (RANGE, PEERS, SERVER, LOCALHOST_ONLY)
    chosen = {name: os.environ.pop(name) for name in names if name in os.environ}
    os.environ[RANGE] = "OFF"
    try:
        yield
    finally:
        del os.environ[RANGE]
        os.environ.update(chosen)


def is_private() -> bool:
    """Whether this process discovers no other."""
    return os.environ.get(RANGE) == "OFF" and os.environ.get(LOCALHOST_ONLY) != "1"


def reaches_network() -> bool:
    """Whether nodes of other machines can discover the nodes of this process."""
    given = os.environ.get(RANGE, "")
    if os.environ.get(LOCALHOST_ONLY) == "1" or given == "OFF":
        return False
    chosen = any(os.environ.get(name) for name in (PEERS, SERVER))
    return chosen or given in ("", "SUBNET", "SYSTEM_DEFAULT")


def clock_advice() -> str:
    """What to do about messages with a wrong time, where other computers can send some."""
    return "; if they come from another computer, set both clocks" if reaches_network() else ""


def describe_discovery() -> str:
    """The choice that applies, with the variables that make it."""
    reached = "the network" if reaches_network() else "this machine only"
    variables = [name for name in (LOCALHOST_ONLY, RANGE, PEERS, SERVER) if os.environ.get(name)]
    return f"{reached} ({', '.join(f'{name}={os.environ[name]}' for name in variables)})"

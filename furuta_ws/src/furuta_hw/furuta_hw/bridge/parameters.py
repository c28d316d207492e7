"""Parameters of the hardware bridge. Parameters of the rig itself are in the rig file."""

from functools import partial
from typing import Annotated, NamedTuple

from furuta_model.parameters import About

STATES = ("unconfigured", "inactive", "active")
# All are fixed from the start of the node on.
_Fixed = partial(About, read_only=True)


class BridgeParameters(NamedTuple):
    """Parameters of the node ``hardware_bridge``."""

    port: Annotated[str, _Fixed("port of the rig, or mock for an emulated rig in the process")] = ""
    rig: Annotated[str, _Fixed("path of the rig file; empty: the paper's rig")] = ""
    autostart: Annotated[
        str, _Fixed("state that the node enters at start; it never arms itself", choices=STATES)
    ] = "unconfigured"
    read_only: Annotated[bool, _Fixed("never drive: the node cannot be activated")] = False
    any_pendulum_angle: Annotated[
        bool, _Fixed("allow any pendulum angle, which swing-up needs")
    ] = False
    network_commands: Annotated[
        bool, _Fixed("allow arming although other machines can discover the node")
    ] = False

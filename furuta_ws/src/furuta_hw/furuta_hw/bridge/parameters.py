"""Parameters of the hardware bridge. Parameters of the rig itself are in the rig file."""

from typing import Annotated, NamedTuple

from furuta_model.parameters import About


class BridgeParameters(NamedTuple):
    """Parameters of the node ``hardware_bridge``."""

    port: Annotated[
        str,
        About("port of the rig, or mock for an emulated rig in the process", read_only=True),
    ] = ""
    rig: Annotated[str, About("path of the rig file; empty: the paper's rig", read_only=True)] = ""
    autostart: Annotated[
        str,
        About(
            "state that the node enters at start; it never arms itself",
            choices=("unconfigured", "inactive", "active"),
            read_only=True,
        ),
    ] = "unconfigured"
    read_only: Annotated[
        bool, About("never drive: the node cannot be activated", read_only=True)
    ] = False
    any_pendulum_angle: Annotated[
        bool,
        About("do not stop on the pendulum's angle, as swing-up needs it", read_only=True),
    ] = False
    network_commands: Annotated[
        bool,
        About(
            "can be armed although other machines can discover it and send commands",
            read_only=True,
        ),
    ] = False

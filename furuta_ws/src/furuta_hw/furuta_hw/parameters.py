"""Parameters of the hardware bridge; what belongs to the rig itself is in the rig file."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from furuta_model.parameters import About


class BridgeParameters(NamedTuple):
    """Parameters of the node ``hardware_bridge``."""

    port: Annotated[
        str,
        About("serial port of the rig, or mock for an emulated one in the process", read_only=True),
    ] = ""
    rig: Annotated[str, About("path of the rig file; empty: the paper's rig", read_only=True)] = ""
    autostart: Annotated[
        str,
        About(
            "state that the node goes to by itself; it never arms itself",
            choices=("unconfigured", "inactive", "active"),
            read_only=True,
        ),
    ] = "unconfigured"
    read_only: Annotated[
        bool, About("never drive: the node cannot be activated", read_only=True)
    ] = False

"""Errors of rigs, drivers and commissioning."""


class RigError(RuntimeError):
    """Base class of all errors of a rig."""


class DriverError(RigError):
    """The rig driver cannot be loaded, or lacks what was asked for."""


class LineError(RigError):
    """The line to the rig cannot be opened, or it failed."""


class StoppedError(RigError):
    """The guard stopped an experiment."""


class NotStillError(RigError):
    """The zeros cannot be measured because something moves."""

"""What can go wrong with a rig, in words for the user."""


class RigError(RuntimeError):
    """The root of these."""


class LineError(RigError):
    """The line to the rig cannot be opened, or broke."""


class StoppedError(RigError):
    """The guard stopped an experiment."""


class NotStillError(RigError):
    """A zero was asked for while something moved."""

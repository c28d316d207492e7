"""Dead band, delay and first-order lag between the drive's converter and the torque.

Delay and lag are those of :mod:`furuta_model.late_drive`. Over a sample the arm gets the mean
torque, so the momentum is exact. Within a sample the torque is constant; the error is that of a
delay far below a sample.
"""

from typing import Annotated, NamedTuple

from furuta_model.compiled import compiled
from furuta_model.late_drive import MAX_DELAY, LateDrive, SampledDrive, design_drive
from furuta_model.parameters import About


class Drive(NamedTuple):
    """Dynamics of the drive. The measurement contains its voltage, not the torque."""

    delay: Annotated[int, About("delay of the voltage", "samples", 0, MAX_DELAY)] = 0
    lag: Annotated[float, About("time constant of the torque, 0 for none", "s", 0, 1)] = 0.0
    dead_band: Annotated[
        float,
        About("voltage up to which there is no torque; above it only the excess acts", "V", 0, 10),
    ] = 0.0

    def sampled(self, dt: float) -> SampledDrive:
        """Delay and lag for a sample time [s]."""
        return design_drive(LateDrive(self.delay, self.lag), dt)


@compiled
def without_dead_band(voltage: float, width: float) -> float:
    """The part of a voltage beyond ±``width`` [V]."""
    if abs(voltage) <= width:
        return 0.0
    return voltage - width if voltage > 0.0 else voltage + width

"""Names what the plant remembers from sample to sample, beyond its state x (5,).

One array holds all of it: the first five numbers are the plant state (:mod:`furuta_model.state`),
the others belong to the parts of :mod:`furuta_model.parts`. They stay zero if no part needs them.
"""

from __future__ import annotations

from typing import Final

from furuta_model.friction.maxwell_slip import MAX_SPRINGS
from furuta_model.state import PLANT_STATES, RIGID_STATES

# Largest delay of drive and sensors [samples].
MAX_DELAY: Final = 100
DELAY_SLOTS: Final = MAX_DELAY + 1

# Deflections of the springs of the Maxwell-slip law [rad]: now, and at the end of the substep.
SPRINGS: Final = PLANT_STATES
NEXT_SPRINGS: Final = SPRINGS + MAX_SPRINGS
# Samples moved, readings taken.
MOVED: Final = NEXT_SPRINGS + MAX_SPRINGS
READ: Final = MOVED + 1
# Relative change of the friction level by time, heat and load.
LEVEL_CHANGE: Final = READ + 1
# Heat of the friction, less what has been cooled [V rad].
HEAT: Final = LEVEL_CHANGE + 1
# Torque at the end of the last sample, behind the lag [V].
TORQUE: Final = HEAT + 1
# Last reading of each signal, which a stuck sensor repeats.
LAST_READING: Final = TORQUE + 1
# The last voltages of the drive [V] and the last states, for the delays.
VOLTAGES: Final = LAST_READING + RIGID_STATES
STATES: Final = VOLTAGES + DELAY_SLOTS
PLANT_MEMORY: Final = STATES + RIGID_STATES * DELAY_SLOTS

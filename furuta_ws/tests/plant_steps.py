"""The plant sample by sample, by the functions that its node compiles anyway."""

import numpy as np

from furuta_model.block import block
from furuta_model.compiled import for_types_of
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant import (
    NOISE_CHANNELS,
    Signals,
    design_plant,
    initial_plant,
    move_block,
    read_block,
)

QUIET = np.zeros(NOISE_CHANNELS)


class PlantSteps:
    """A plant without its node, in its initial state."""

    def __init__(self, p: PlantParameters) -> None:
        self.memory = initial_plant(p)
        self.design(p)

    def design(self, p: PlantParameters) -> None:
        """Use these parameters from now on."""
        self._plant = block(design_plant(p))
        self._move = for_types_of(move_block, self.memory, 0.0, self._plant)
        self._read = for_types_of(read_block, self.memory, QUIET, 0.0, self._plant)

    def move(self, command: float) -> None:
        """Move it over a sample."""
        self._move(self.memory, float(command), self._plant)

    def read(self, noise: np.ndarray = QUIET) -> tuple[Signals, Signals]:
        """The measurement, and the true state and friction."""
        measurement, truth = self._read(self.memory, noise, 0.0, self._plant)
        return measurement, truth

"""The estimator sample by sample, by the function that its node compiles anyway."""

import numpy as np

from furuta_control import estimator_node
from furuta_control.estimation import EstimatorMemory, EstimatorParameters, design_estimator
from furuta_model.block import block, new_memory
from furuta_model.compiled import for_types_of
from furuta_ros.wire import NO_SIGNALS


class EstimatorSteps:
    """An estimator without its node; ``design`` changes its parameters."""

    def __init__(self, p: EstimatorParameters) -> None:
        self._memory = new_memory(EstimatorMemory)
        self.design(p)

    def design(self, p: EstimatorParameters) -> None:
        """Use these parameters from now on."""
        self._design = block(design_estimator(p))
        self._step = for_types_of(
            estimator_node._step, self._memory, NO_SIGNALS, self._design, False, 0
        )

    def step(self, measurement: np.ndarray, skipped: int = 0) -> tuple[np.ndarray, int]:
        """The estimate (5,) and the unusable readings, after so many samples without readings."""
        readings = tuple(measurement.tolist())
        unusable, x = self._step(self._memory, readings, self._design, False, skipped)
        return np.array(x), unusable


def estimates(measurements: np.ndarray, p: EstimatorParameters) -> tuple[np.ndarray, np.ndarray]:
    """Estimates (n, 5) and the unusable readings (n,) for measurements (n, 5), from the start."""
    estimator = EstimatorSteps(p)
    result, unusable = zip(*map(estimator.step, measurements), strict=True)
    return np.array(result), np.array(unusable)

"""The rotary pendulum as a body: angles and speeds of arm and pendulum under a voltage."""

import numpy as np

from furuta.identification.bodies.body import Differentiated, Segments
from furuta.identification.shooting.prediction import predict
from furuta.identification.shooting.unknowns import ParameterValues
from furuta.identification.unknowns import Values
from furuta_model.state import THETA


class Pendulum(Differentiated):
    """Angles and speeds, with the zero of the pendulum's angle that each recording has."""

    def outputs(self, values: Values, first: np.ndarray, cut: Segments) -> np.ndarray:
        """Outputs (n, 4)."""
        known = ParameterValues(values)
        model, predicted = known.model, np.empty_like(cut.measured)
        for number, recording in enumerate(cut.data):
            own = np.flatnonzero(cut.of == number)
            begin, end = cut.bounds[own[0]], cut.bounds[own[-1] + 1]
            upright, zero = first[own], known.zero(recording.number)
            upright[:, THETA] += zero
            predicted[begin:end] = predict(recording, cut.bounds[own] - begin, upright, model)
            predicted[begin:end, THETA] -= zero
        return predicted

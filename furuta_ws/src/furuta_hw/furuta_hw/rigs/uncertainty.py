r"""Uncertainty of a rig's values: standard errors with correlations.

Inertias are uncertain in the coordinates of the identification: log β, log γ, log δ and the
logarithm of the arm's inertia without the pendulum's reaction, :math:`α - γ^2/β`. So every draw is
a possible pendulum. In a rig file:

    uncertainty:
      standard_errors: {arm_inertia: 0.05, beta: 0.1, viscous: 0.01}
      correlations: [[1.0], [0.3, 1.0], [0.0, 0.0, 1.0]]    # lower triangle; default: none

Each wave of the torque has two values, `wave14_cos` and `wave14_sin` [V] for 14 waves per turn.
"""

from collections.abc import Mapping
from math import exp
from typing import Any, NamedTuple

import numpy as np

from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import ParameterError, number_from_text, shortened
from furuta_model.parts.disturbances import TorqueWaves
from furuta_model.pendulum import FurutaPendulum

# Values whose standard error is relative, that of the logarithm.
RELATIVE = ("arm_inertia", "beta", "gamma", "delta", "sigma0", "sigma1", "stribeck_velocity")
# Values whose standard error is absolute, in their own unit, with their lowest and highest value.
ABSOLUTE = {
    "viscous": (0.0, 100.0),
    "alpha0": (0.0, 100.0),
    "alpha1": (0.0, 100.0),
    "asymmetry": (-0.95, 0.95),
    "pendulum_viscous": (0.0, 10.0),
    "pendulum_coulomb": (0.0, 10.0),
    "delay": (0.0, 0.1),
    "tilt_x": (-0.5, 0.5),
    "tilt_y": (-0.5, 0.5),
}
NAMES = (*RELATIVE, *ABSOLUTE)
LARGEST_WAVE = 10.0  # amplitude [V]
INERTIAS = ("arm_inertia", "beta", "gamma", "delta")
_PARTS = ("cos", "sin")
_FRICTION = ("sigma0", "sigma1", "stribeck_velocity", "viscous", "alpha0", "alpha1", "asymmetry")
# Where a rig has each value that is neither of its model nor of a wave.
_PLACES = {name: ("friction", name) for name in _FRICTION} | {
    "pendulum_viscous": ("pendulum_friction", "damping"),
    "pendulum_coulomb": ("pendulum_friction", "coulomb"),
    "delay": ("drive", "delay"),
    "tilt_x": ("tilt", "x"),
    "tilt_y": ("tilt", "y"),
}


class Uncertainty(NamedTuple):
    """Names of the uncertain values, and the covariance (n, n) of their coordinates."""

    names: tuple[str, ...]
    covariance: np.ndarray

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard error of each coordinate by name."""
        errors = np.sqrt(np.diag(self.covariance))
        return dict(zip(self.names, map(float, errors), strict=True))

    def draws(self, count: int, generator: np.random.Generator) -> np.ndarray:
        """Random changes of the coordinates (count, n)."""
        eigenvalues, vectors = np.linalg.eigh(self.covariance)
        root = vectors * np.sqrt(np.maximum(eigenvalues, 0.0))
        normal = generator.standard_normal((count, len(self.names)))
        drawn: np.ndarray = normal @ root.T
        return drawn


CERTAIN = Uncertainty((), np.zeros((0, 0)))


def wave_values(waves: TorqueWaves) -> dict[str, float]:
    """The amplitudes [V] of the waves by name; order 0 is no wave."""
    rows = zip(*waves, strict=True)
    return {
        f"wave{order:g}_{part}": value
        for order, *amplitudes in rows
        if order != 0.0
        for part, value in zip(_PARTS, amplitudes, strict=True)
    }


def values_of(rig: Rig) -> dict[str, float]:
    """The values that can be uncertain, by name."""
    body = rig.model
    return {
        "arm_inertia": body.alpha - body.gamma**2 / body.beta,
        **{name: getattr(body, name) for name in INERTIAS[1:]},
        **{name: getattr(getattr(rig, part), field) for name, (part, field) in _PLACES.items()},
        **wave_values(rig.waves),
    }


def changed_rig(rig: Rig, names: tuple[str, ...], change: np.ndarray) -> Rig:
    """The rig with its coordinates ``names`` changed by ``change`` (n,), within what is allowed."""
    values = values_of(rig)
    for name, difference in zip(names, map(float, change), strict=True):
        if name in RELATIVE:
            values[name] *= exp(difference)
        else:
            low, high = ABSOLUTE.get(name, (-LARGEST_WAVE, LARGEST_WAVE))
            values[name] = min(max(values[name] + difference, low), high)
    for name, (part, field) in _PLACES.items():
        rig = rig._replace(**{part: getattr(rig, part)._replace(**{field: values[name]})})
    beta, gamma = values["beta"], values["gamma"]
    alpha = values["arm_inertia"] + gamma**2 / beta
    model = FurutaPendulum(alpha, beta, gamma, values["delta"])
    return rig._replace(model=model, waves=_with_amplitudes(rig.waves, values))


def _with_amplitudes(waves: TorqueWaves, values: dict[str, float]) -> TorqueWaves:
    """The waves with other amplitudes by name."""
    cosine, sine = (
        tuple(
            values.get(f"wave{order:g}_{part}", old)
            for order, old in zip(waves.orders, amplitudes, strict=True)
        )
        for part, amplitudes in zip(_PARTS, (waves.cosine, waves.sine), strict=True)
    )
    return waves._replace(cosine=cosine, sine=sine)


def uncertainty_from(content: Any, waves: TorqueWaves) -> Uncertainty:
    """The uncertainty that the section of a rig file describes; none without a section.

    ``waves`` are those of the rig.
    """
    if content is None:
        return CERTAIN
    if not isinstance(content, Mapping) or not isinstance(content.get("standard_errors"), Mapping):
        raise ParameterError("uncertainty must have standard_errors, which map names to numbers")
    unknown = sorted(str(key) for key in content if key not in _SECTION)
    if unknown:
        raise ParameterError(f"unknown: uncertainty.{', uncertainty.'.join(unknown)}")
    known = (*NAMES, *wave_values(waves))
    stated = content["standard_errors"]
    errors = np.array([_number(name, value, known) for name, value in stated.items()])
    correlations = _correlations(content.get("correlations"), len(errors))
    return Uncertainty(tuple(stated), correlations * np.outer(errors, errors))


_SECTION = ("standard_errors", "correlations")
# Rounding of the correlations in a file, which may make an eigenvalue negative.
ROUNDING = 1e-5


def _number(name: Any, value: Any, known: tuple[str, ...]) -> float:
    """The standard error of a value; raises ParameterError if it is not one."""
    if name not in known:
        raise ParameterError(f"uncertainty of unknown {name}; known are {', '.join(known)}")
    error = number_from_text(value)
    if isinstance(error, bool) or not isinstance(error, (int, float)) or not 0 <= error < 1e6:
        raise ParameterError(
            f"the standard error of {name} must be a number of at least 0, given {shortened(value)}"
        )
    return float(error)


def _correlations(rows: Any, size: int) -> np.ndarray:
    """The whole matrix (size, size) from its lower triangle; without one, no correlations."""
    matrix = np.eye(size)
    try:
        lower = [np.array(row, float) for row in rows or matrix[:0]]
        valid = rows is None or [row.shape for row in lower] == [(i + 1,) for i in range(size)]
    except (TypeError, ValueError):
        valid = False
    if valid:
        for i, row in enumerate(lower):
            matrix[i, : i + 1] = matrix[: i + 1, i] = row
        valid = bool(np.all(np.abs(matrix) <= 1.0) and np.all(np.diag(matrix) == 1.0))
    if not valid or np.linalg.eigvalsh(matrix).min(initial=0.0) < -ROUNDING * size:
        raise ParameterError(
            f"uncertainty.correlations must be the {size} rows of a lower triangle with numbers "
            "from -1 to 1, and 1 at the end of each row"
        )
    return matrix


def uncertainty_section(uncertainty: Uncertainty) -> dict[str, Any]:
    """The section of a rig file: the inverse of :func:`uncertainty_from`."""
    errors = uncertainty.standard_errors
    sizes = np.array([error or 1.0 for error in errors.values()])
    correlations = uncertainty.covariance / np.outer(sizes, sizes)
    rows = [[round(float(value), 6) for value in row[:i]] for i, row in enumerate(correlations)]
    return {
        "standard_errors": {name: float(f"{error:.4g}") for name, error in errors.items()},
        "correlations": [[*row, 1.0] for row in rows],
    }

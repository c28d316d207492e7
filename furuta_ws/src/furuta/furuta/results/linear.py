"""The linear model of a loop: poles, gain, margins, Nyquist curve, passivity of the observer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.margins import Margins
from furuta.passivity import Passivity
from furuta.results.result import Found
from furuta.results.text import angle
from furuta.transfer import transfer
from furuta_model.pendulum import FurutaPendulum


class Linear(NamedTuple):
    """What is computed of the controller's model with its feedback.

    ``margins`` and ``sensors_alone_rad`` are None if the loop is unstable. ``gain`` is K [1/s] of
    the friction observer, and ``exact_model`` whether observer and controller know the plant.
    """

    model: FurutaPendulum
    A: np.ndarray
    B: np.ndarray
    open_loop_poles: np.ndarray
    L: np.ndarray
    closed_loop_poles: np.ndarray
    margins: Margins | None
    sensors_alone_rad: float | None
    passivity: Passivity | None
    observer_gain: float
    exact_model: bool


class LinearModel(Found):
    """The linear model, eqs. (2), (3), of the controller, its gain, eq. (7), poles and margins.

    Fields: ``A`` (4, 4), ``B`` (4,), ``L`` (4,) of u = −Lx, ``open_loop_poles`` and
    ``closed_loop_poles`` (4,) [1/s]; ``margins`` (gain_low, gain_high, phase_rad, delay_s, disk) if
    the friction is compensated exactly; ``sensors_alone_rad``, the swing of the arm that the
    sensors cause without friction; ``passivity`` if it was asked for.

    Attributes:
        cases: Loops whose Nyquist curves are part of the result, by name.
    """

    found: Linear
    details = frozenset({"alpha", "beta", "gamma", "delta", "nyquist"})

    def __init__(self, found: Linear, cases: Mapping[str, IdealLoop]) -> None:
        super().__init__(found)
        self.cases = dict(cases)

    def _by_name(self) -> dict[str, Any]:
        """Everything by name, poles as real and imaginary part."""
        found = self.found
        values = {
            **found.model._asdict(),
            "A": found.A,
            "B": found.B,
            "open_loop_poles": found.open_loop_poles.astype(complex),
            "L": found.L,
            "closed_loop_poles": found.closed_loop_poles.astype(complex),
        }
        if found.margins is not None:
            values |= {
                "margins": found.margins._asdict(),
                "sensors_alone_rad": found.sensors_alone_rad,
            }
        return values | self._nyquist() | self._passivity()

    def _nyquist(self) -> dict[str, Any]:
        """Crossings of the negative real axis by G of every case, and G by its name."""
        if not self.cases:
            return {}
        responses = {case: transfer(loop.body, loop.gains) for case, loop in self.cases.items()}
        return {
            "crossings": [
                {"case": case, **crossing._asdict()}
                for case, g in responses.items()
                for crossing in g.crossings
            ],
            "nyquist": {
                case: {
                    "feedback": list(self.cases[case].gains),
                    "numerator": list(g.numerator),
                    "denominator": list(g.denominator),
                    "poles": g.poles.astype(complex),
                    "stable_without_friction": g.stable,
                }
                for case, g in responses.items()
            },
        }

    def _passivity(self) -> dict[str, Any]:
        found = self.found
        if found.passivity is None:
            return {}
        about = {"K": found.observer_gain, "exact_model": found.exact_model}
        passivity = {**found.passivity._asdict(), **about}
        return {"passive": found.passivity.satisfied, "passivity": passivity}

    def sentence(self) -> str:
        """Whether the loop is stable, its margins, and what the sensors alone cause."""
        margins, swing = self.found.margins, self.found.sensors_alone_rad
        if margins is None or swing is None:
            return "Without friction the loop is unstable."
        torque = f"{margins.gain_low:.3g} to {margins.gain_high:.3g} times the torque"
        if np.isinf(margins.gain_high):
            torque = f"{margins.gain_low:.3g} times the torque or more"
        sensors = f"let the arm swing by {angle(swing)}"
        if np.isinf(swing):
            sensors = "make the pendulum fall"
        return (
            "Without friction the loop is stable. It stays so with up to "
            f"{margins.delay_s:.3g} s of delay, and with {torque}. The sensors alone {sensors}."
        )

    def plot(self, axes: Any = None) -> Any:
        """Draw the Nyquist curve of every case; see :meth:`Result.plot`."""
        from furuta.figures.nyquist import draw_nyquist

        return draw_nyquist(self.cases, axes)

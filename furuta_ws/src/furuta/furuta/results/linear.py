"""The linear model of a loop: poles, gain, margins, Nyquist curve, passivity of the observer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.margins import Margins
from furuta.passivity import Passivity
from furuta.results.result import Result
from furuta.results.text import angle
from furuta.transfer import transfer
from furuta_model.pendulum import FurutaPendulum


@dataclass(frozen=True, repr=False, eq=False)
class LinearModel(Result):
    """The linear model, eqs. (2), (3), of the controller, its gain, eq. (7), poles and margins.

    Fields: ``model``, ``A`` (4, 4), ``B`` (4,), ``L`` (4,) of u = −Lx, ``open_loop_poles`` and
    ``closed_loop_poles`` (4,) [1/s]; ``margins`` (gain_low, gain_high, phase_rad, delay_s, disk) if
    the friction is compensated exactly, and ``sensors_alone_rad``, the swing of the arm that the
    sensors cause without friction, both None if the loop is unstable; ``passivity`` if it was asked
    for, with ``observer_gain`` K [1/s] of the friction observer, and ``exact_model``, whether
    observer and controller know the plant.

    Attributes:
        cases: Loops whose Nyquist curves are part of the result, by name.
    """

    details = frozenset({"alpha", "beta", "gamma", "delta", "nyquist"})

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
    cases: dict[str, IdealLoop]

    def _by_name(self) -> dict[str, Any]:
        """Everything by name, poles as real and imaginary part."""
        values = {
            **self.model._asdict(),
            "A": self.A,
            "B": self.B,
            "open_loop_poles": self.open_loop_poles.astype(complex),
            "L": self.L,
            "closed_loop_poles": self.closed_loop_poles.astype(complex),
        }
        if self.margins is not None:
            values |= {
                "margins": self.margins._asdict(),
                "sensors_alone_rad": self.sensors_alone_rad,
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
        if self.passivity is None:
            return {}
        about = {"K": self.observer_gain, "exact_model": self.exact_model}
        passivity = {**self.passivity._asdict(), **about}
        return {"passive": self.passivity.satisfied, "passivity": passivity}

    def sentence(self) -> str:
        """Whether the loop is stable, its margins, and what the sensors alone cause."""
        margins, swing = self.margins, self.sensors_alone_rad
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

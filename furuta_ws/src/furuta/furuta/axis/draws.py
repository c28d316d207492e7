"""The axis of a recording, what the recording leaves open, and what follows for its motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from furuta.axis.axis import HUNTING, NOTHING, Axis, Controller, servo_cycle
from furuta.axis.identified_axis import DRAWS, IdentifiedAxis
from furuta.identification.axis.effects import FALL
from furuta_model.friction.laws import LAWS, find_law
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_model.progress import Progress, unseen

# Draws on which the compensations are compared.
COMPARED = 4
# Fraction of draws below which, or above one minus which, the recording tells whether it hunts.
DECIDED = 0.05


class Consequences(NamedTuple):
    """How many of the ``draws`` hunt, and 5 and 95 % of their peak to peak [rad]; NaN for none."""

    draws: int
    hunting: int
    low_rad: float
    high_rad: float

    @property
    def hunts_in(self) -> float:
        """Fraction of draws that hunt."""
        return self.hunting / self.draws

    @property
    def is_decided(self) -> bool:
        """Whether nearly all draws hunt, or nearly none."""
        return not DECIDED < self.hunts_in < 1.0 - DECIDED

    def sentence(self, fit: IdentifiedAxis) -> str:
        """The consequences in words, and which recording would settle what is open."""
        unit, size = fit.recorded_unit
        of = f"of the {self.draws} axes that fit the recording"
        text = f"{self.hunting or 'None'} {of} {'hunt' if self.hunting != 1 else 'hunts'}"
        if self.hunting == self.draws:
            text = f"All {self.draws} axes that fit the recording hunt"
        if self.hunting:
            text += f", by {self.low_rad / size:.3g} to {self.high_rad / size:.3g} {unit}"
        if self.is_decided:
            return text
        level = fit.values.get("alpha0", 0.0) + fit.hidden
        return (
            f"{text}: this recording does not tell; record stops and reversals under a torque that "
            f"rises slowly from 0 to beyond {level:.2g} either way"
        )


def identified_axis(fit: IdentifiedAxis, law: str | None = None) -> Axis:
    """The axis of a fit, without offset and drift; see :meth:`IdentifiedAxis.axis`."""
    if "inertia" not in fit.values:
        raise ParameterError(f"{fit.joint}: {'; '.join(fit.verdict.reasons)}")
    at_once = "alpha1" in fit.values and "stribeck_velocity" not in fit.values
    law = law or ("stiction" if at_once else "stribeck")
    if law not in LAWS or find_law(law).bristle:
        raise ParameterError(
            f"a recording shows no bristle: the law must be coulomb, stiction or stribeck, given "
            f"{law}"
        )
    known = {name: value for name, value in fit.values.items() if name in Friction._fields}
    if "stribeck_velocity" not in known and law != "stiction":
        known["alpha1"] = 0.0
    load = fit.values.get("load_friction", 0.0)
    return Axis(fit.values["inertia"], NOTHING._replace(**known), law, load)


def drawn_axes(fit: IdentifiedAxis, draws: int = DRAWS, seed: int = 0) -> list[Axis]:
    """Axes that the recording may have come from.

    The parameters of the identified axis are drawn from the covariance. Where the recording does
    not determine how friction falls, half of the axes have none, the others stiction of any size
    that the recording would not show. If the model leaves more than noise, the form of a fall that
    was found is not certain either: with half of the axes it is over at once.

    Args:
        fit: What ``identify`` found.
        draws: Number of axes.
        seed: Of the random numbers.
    """
    random = np.random.default_rng(seed)
    centre = identified_axis(fit)
    # Rounding may leave a variance below 0 in a direction; the method takes its size.
    vectors = random.multivariate_normal(
        fit.means, fit.covariance, draws, check_valid="ignore", method="eigh"
    )
    return [
        _drawn(centre, dict(zip(fit.names, vector, strict=True)), fit, random) for vector in vectors
    ]


def _drawn(
    centre: Axis, drawn: dict[str, float], fit: IdentifiedAxis, random: np.random.Generator
) -> Axis:
    """One axis; a value that cannot be is the nearest one that can."""
    friction = centre.friction
    changes: dict[str, float] = {
        name: min(max(drawn[name], -0.99 if name == "asymmetry" else 0.0), 1e12)
        for name in ("alpha0", "viscous", "asymmetry")
        if name in fit.values
    }
    law, (excess, velocity) = centre.law, FALL
    if velocity in fit.values:
        relative = fit.standard_errors[velocity] / friction.stribeck_velocity
        factor = np.exp(min(relative, 1.0) * random.standard_normal())
        changes[excess] = max(drawn[excess], 0.0)
        changes[velocity] = friction.stribeck_velocity * float(factor)
        if fit.verdict.usable != "yes" and random.random() < 0.5:
            law = "stiction"
    elif excess in fit.values:
        change = fit.standard_errors[excess] * random.standard_normal()
        changes[excess] = max(fit.values[excess] + change, 0.0)
    else:
        changes[excess], law = max(random.uniform(-fit.hidden, fit.hidden), 0.0), "stiction"
    inertia = max(drawn["inertia"], 0.1 * centre.inertia)
    return centre._replace(inertia=inertia, friction=friction._replace(**changes), law=law)


def consequences(
    axes: Sequence[Axis], controller: Controller, speed: float = 0.0, progress: Progress = unseen
) -> Consequences:
    """Which of some axes, of :func:`drawn_axes`, hunt under a controller."""
    cycles = [servo_cycle(axis, controller, speed) for axis in progress(axes, len(axes))]
    sizes = [cycle.peak_to_peak for cycle in cycles if cycle.kind in HUNTING]
    low, high = np.quantile(sizes, (0.05, 0.95)) if sizes else (np.nan, np.nan)
    return Consequences(len(axes), len(sizes), float(low), float(high))


def left_out(fit: IdentifiedAxis) -> list[str]:
    """Reported effects that the axis in a loop does not have."""
    has = {"inertia", "alpha0", "alpha1", "stribeck_velocity", "viscous", "asymmetry"}
    return [name for name in fit.values if name not in has and not name.startswith("offset")]

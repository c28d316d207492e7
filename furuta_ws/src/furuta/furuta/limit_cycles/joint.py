r"""Any linear loop with one friction joint: limit cycles in the user's units.

The loop is :math:`\dot x = A x + b f + r`, :math:`v = c x`: f is a force on the joint and v its
speed. Friction is f = −F. To find its motions the loop is written without units: with the friction
as unit of force, the geometric mean of the poles as ten per unit of time, and states of similar
size, so that tolerances mean the same for a watch and for a crane.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from furuta.arguments import check
from furuta.limit_cycles import continuation
from furuta.limit_cycles.exact_motion import state_after
from furuta.limit_cycles.friction_loop import rate
from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.limit_cycles.linear_loop import LinearLoop
from furuta.limit_cycles.periodic_orbit import (
    Kind,
    LimitCycle,
    Trajectory,
    motion_text,
    trace,
)
from furuta.limit_cycles.rest_stability import STILL
from furuta.results.result import Result
from furuta_model.friction.laws import (
    analysed_law,
    check_friction,
    sliding_level,
    steady_friction,
)
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError, shortened
from furuta_model.state import PHI, PHI_DOT

POLES = 10.0  # geometric mean of the scaled poles
MOTION = 30.0  # acceleration by the unit of force, so that amplitudes are of order 0.1
ZERO_POLE = 1e-9  # relative to the largest
BALANCED = 1e-3  # relative change of a scale that ends the balancing
ROUNDS = 100


class Units(NamedTuple):
    """Units of time [s], position [m, rad] and force [N, N m], and of the states: x = basis·y."""

    time: float
    position: float
    force: float
    basis: np.ndarray

    @property
    def speed(self) -> float:
        """Unit of speed."""
        return self.position / self.time


class Joint(NamedTuple):
    """A linear loop with a friction joint: scaled for the engine, and its units."""

    loop: LinearLoop
    units: Units

    def state(self, x: np.ndarray | None = None) -> np.ndarray:
        """The engine's state for x (n,) with a relaxed bristle, at position 0.

        By default the joint rests, and all other states are displaced by their unit.
        """
        if x is None:
            x = self.units.basis @ np.append(0.0, np.ones(len(self.loop.b) - 1))
        if np.shape(x) != (len(self.loop.b),) or not np.all(np.isfinite(x)):
            number, given = len(self.loop.b), shortened(np.asarray(x).tolist())
            raise ParameterError(f"the start must be {number} finite numbers, given {given}")
        return np.concatenate([[0.0], np.linalg.solve(self.units.basis, x), [0.0]])

    def steady(self, speed: float) -> np.ndarray:
        """The engine's state while the joint moves at ``speed``, which is not 0."""
        loop, v = self.loop, speed / self.units.speed
        force = steady_friction(v, loop.law)
        others = np.linalg.lstsq(loop.a[:, 1:], loop.b * force - loop.r - loop.a[:, 0] * v, None)[0]
        z = np.sign(v) * sliding_level(v, v, loop.law) / loop.law.parameters.sigma0
        return np.concatenate([[0.0, v], others, [z if loop.law.bristle else 0.0]])

    def in_units(self, new: Units) -> Joint:
        """The same loop in the units of another one, so that their states can be compared."""
        old, loop = self.units, self.loop
        time, force = new.time / old.time, new.force / old.force
        basis = np.linalg.solve(new.basis, old.basis)
        law = loop.law._replace(
            parameters=friction_in(
                Units(time, new.position / old.position, force, basis), loop.law.parameters
            )
        )
        a = np.ascontiguousarray(basis @ loop.a @ np.linalg.inv(basis) * time)
        return Joint(LinearLoop(a, basis @ loop.b * force * time, basis @ loop.r * time, law), new)


@dataclass(frozen=True, repr=False)
class JointCycle(Result):
    """The final motion of any linear loop with a friction joint, in the loop's own units.

    ``peak_to_peak`` is that of the position [m or rad], without its mean motion. ``start`` is the
    state x (n,) at the upper reversal; at the lower one if there is no upper one, and where the
    speed falls through the middle of its range if the joint never stops. A rest, or a steady motion
    at constant speed, has a ``growth_rate_1_s`` instead of multipliers: -inf where nothing but
    other rests is near, 0 where an integrator leaves the rest and comes back. An irregular motion
    was seen over ``observed_s`` after ``transient_s``.
    """

    also = ("stable",)

    kind: Kind
    peak_to_peak: float
    period_s: float
    stuck_fraction: float
    floquet_multipliers: tuple[complex, ...]
    growth_rate_1_s: float
    transient_s: float
    observed_s: float
    start: tuple[float, ...] = field(repr=False)
    scaled: LimitCycle = field(repr=False)
    loop: Joint = field(repr=False, compare=False)

    @property
    def stable(self) -> bool:
        """Whether disturbances decay."""
        return self.scaled.stable

    def sentence(self, size: str = "", name: str = "The joint") -> str:
        """The kind of motion, its ``size`` in words, and its period."""
        size = size or f"{self.peak_to_peak:.3g}"
        if self.kind == "limit_cycle" and np.isfinite(self.period_s):
            stuck = 100 * self.stuck_fraction
            sticks = f"; it sticks {stuck:.0f} % of the time" * (stuck > 0.0)
            return f"{name} hunts by {size} every {self.period_s:.3g} s{sticks}."
        return {
            "limit_cycle": f"{name} moves by {size} between two rests, and stays at each until a "
            "disturbance has grown.",
            "steady": f"{name} moves steadily.",
            "rest": f"{name} comes to rest.",
            "unbounded": "The motion grows without bound.",
            "irregular": f"{name} moves irregularly, by {size}.",
        }[self.kind]

    def table(self, values: Mapping[str, Any]) -> str:
        """What has a meaning for this kind of motion."""
        return motion_text(values, ("peak_to_peak",))

    def trace(self) -> Trajectory:
        """One period: ``time`` (n,) [s], ``state``, position and x (n, 1 + states), forces (n,).

        Raises:
            ParameterError: The motion is no limit cycle with a finite period.
        """
        if self.kind != "limit_cycle":
            raise ParameterError(f"there is no limit cycle: the motion is {self.kind}")
        units, path = self.loop.units, self.scaled.trace()
        position = units.position * path.state[:, :1]
        state = np.hstack([position, path.state[:, 1:-1] @ units.basis.T])
        return Trajectory(
            units.time * path.time, state, units.force * path.control, units.force * path.friction
        )

    def plot(self, axes: Any = None) -> Any:
        """Draw one period and the phase plane; see :meth:`Result.plot`."""
        from furuta.figures.limit_cycle import draw_joint

        return draw_joint(self.trace(), self.sentence(), axes)


def matrices(system: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A (n, n), b (n,) and c (n,) of ẋ = A x + b f, v = c x with force f and speed v of the joint.

    It is a state space model or a transfer function of python-control or scipy.signal, known by
    their attributes, or these matrices.

    Raises:
        ParameterError: It is none of these, is sampled, or has more than one input or output, or
            the force acts on the speed without delay.
    """
    if isinstance(system, tuple | list) and len(system) == 3:
        parts = zip("Abc", system, strict=True)
        a, b, c = (np.atleast_1d(check(name, part, float | np.ndarray)) for name, part in parts)
        return np.atleast_2d(a), b.ravel(), c.ravel()
    if getattr(system, "dt", None):
        raise ParameterError(f"the loop must be in continuous time, given dt = {system.dt}")
    if hasattr(system, "num") and hasattr(system, "den"):
        from scipy.signal import tf2ss

        a, b, c, d = tf2ss(_coefficients(system.num), _coefficients(system.den))
    elif all(hasattr(system, name) for name in "ABCD"):
        a, b, c, d = (np.asarray(getattr(system, name), dtype=float) for name in "ABCD")
    else:
        raise ParameterError(
            "a linear loop is a state space model with A, B, C and D, a transfer function with num "
            f"and den, or matrices (A, b, c), given {type(system).__name__}"
        )
    if b.shape[1] != 1 or c.shape[0] != 1:
        raise ParameterError(
            "a friction joint has one force and one speed, given "
            f"{b.shape[1]} inputs and {c.shape[0]} outputs"
        )
    if np.any(d):
        raise ParameterError(f"a force must not act on the speed without delay, given D = {d}")
    return a, b[:, 0], c[0]


def _coefficients(rows: Any) -> np.ndarray:
    """The coefficients of a polynomial, which python-control keeps by output and input."""
    while np.ndim(rows[0]):
        if len(rows) != 1:
            raise ParameterError(f"a friction joint has one force and speed, given {len(rows)}")
        rows = rows[0]
    return np.asarray(rows, dtype=float)


def joint(
    a: np.ndarray,
    b: np.ndarray,
    c: np.ndarray,
    friction: Friction,
    law: str = "stribeck",
    offset: np.ndarray | None = None,
) -> Joint:
    """The loop ẋ = A x + b f + r, v = c x with friction f = −F.

    Args:
        a: A (n, n) of the closed loop.
        b: b (n,), how a force on the joint acts.
        c: c (n,), the joint's speed from the state; c·b must be positive.
        friction: Its parameters in the units of force and speed.
        law: coulomb, stiction, stribeck, lugre or dahl.
        offset: r (n,), for example of a reference that moves at constant speed.

    Raises:
        ParameterError: The law is not analysed, a parameter of friction is outside its range, or
            the matrices do not fit.
    """
    check_friction(law, friction)
    a, b, c = (np.array(part, dtype=float) for part in (a, b, c))
    n = len(b)
    r = np.zeros(n) if offset is None else np.array(offset, dtype=float)
    if a.shape != (n, n) or c.shape != (n,) or r.shape != (n,):
        raise ParameterError(
            f"A (n, n), b (n,), c (n,) and r (n,) must fit, given {a.shape}, {b.shape}, {c.shape} "
            f"and {r.shape}"
        )
    if not all(np.all(np.isfinite(part)) for part in (a, b, c, r)):
        raise ParameterError("the numbers of a loop must be finite")
    if not c @ b > 0.0:
        raise ParameterError(
            f"a force must accelerate the joint: c·b is {c @ b:g}, must be above 0"
        )
    units = _units(a, b, c, friction)
    inverse = np.linalg.inv(units.basis)
    scaled = analysed_law(law, friction_in(units, friction))
    return Joint(
        LinearLoop(
            np.ascontiguousarray(inverse @ a @ units.basis * units.time),
            inverse @ b * units.force * units.time,
            inverse @ r * units.time,
            scaled,
        ),
        units,
    )


def _units(a: np.ndarray, b: np.ndarray, c: np.ndarray, friction: Friction) -> Units:
    poles = np.abs(np.linalg.eigvals(a))
    poles = poles[poles > ZERO_POLE * poles.max(initial=0.0)]
    time = POLES / float(np.exp(np.mean(np.log(poles)))) if len(poles) else 1.0
    force = highest_level(friction)
    speed = float(c @ b) * force * time / MOTION
    # The joint's speed takes the place of the state that shows most of it.
    basis = np.eye(len(b))
    shown = int(np.argmax(np.abs(c)))
    basis[[0, shown]] = basis[[shown, 0]]
    basis[0] = c
    states = np.linalg.inv(basis)
    states[:, 0] *= speed
    return Units(time, speed * time, force, states * _balance(np.linalg.solve(states, a @ states)))


def _balance(a: np.ndarray) -> np.ndarray:
    """Scales (n,) of the states that make rows and columns of A similar; the first is kept."""
    scales = np.ones(len(a))
    for _ in range(ROUNDS):
        before = scales.copy()
        for i in range(1, len(a)):
            scaled = np.abs(a * scales / scales[:, None])
            scaled[i, i] = 0.0
            row, column = scaled[i].sum(), scaled[:, i].sum()
            if row > 0.0 and column > 0.0:
                scales[i] *= np.sqrt(row / column)
        if np.all(np.abs(scales / before - 1.0) < BALANCED):
            break
    return scales


def friction_in(units: Units, p: Friction) -> Friction:
    """The parameters of friction in these units."""
    return Friction(
        sigma0=p.sigma0 * units.position / units.force,
        sigma1=p.sigma1 * units.speed / units.force,
        alpha0=p.alpha0 / units.force,
        alpha1=p.alpha1 / units.force,
        stribeck_velocity=p.stribeck_velocity / units.speed,
        viscous=p.viscous * units.speed / units.force,
        asymmetry=p.asymmetry,
    )


def joint_cycle(given: Joint, start: np.ndarray | None = None) -> JointCycle:
    """The final motion from state x (n,), by default that of :meth:`Joint.state`."""
    return final_motion(given, given.state(start))


def final_motion(given: Joint, y: np.ndarray) -> JointCycle:
    """The final motion from the engine's state ``y``."""
    return _with_units(given, limit_cycle(given.loop, y))


def _with_units(given: Joint, cycle: LimitCycle) -> JointCycle:
    units = given.units
    kind = cycle.kind
    start: tuple[float, ...] = ()
    if cycle.point:
        scaled = np.array(cycle.point[1:-1])
        start = tuple(units.basis @ scaled)
        if kind == "rest" and abs(scaled[0]) > STILL:
            kind = "steady"
    return JointCycle(
        kind,
        _peak_to_peak(given.loop, cycle) * units.position,
        cycle.period_s * units.time,
        cycle.stuck_fraction,
        cycle.floquet_multipliers,
        cycle.growth_rate_1_s / units.time,
        cycle.transient_s * units.time,
        cycle.observed_s * units.time,
        start,
        cycle,
        given,
    )


def _peak_to_peak(loop: LinearLoop, cycle: LimitCycle) -> float:
    """Peak to peak of the position without its mean motion."""
    drift = cycle.rotation_rate_rad_s
    lasts = cycle.observed_s if cycle.kind == "irregular" else cycle.period_s
    if not STILL <= abs(drift) * lasts < np.inf:
        return cycle.phi_peak_to_peak_rad
    from scipy.interpolate import CubicHermiteSpline  # slow; only a cycle that drifts needs it

    path = trace(loop, cycle)
    time, position, speed = path.time, path.state[:, PHI] - drift * path.time, path.state[:, 1]
    found = CubicHermiteSpline(time, position, speed - drift).derivative().roots()
    inside = found[np.isfinite(found) & (found > time[0]) & (found < time[-1])]
    extremes = [_extreme(loop, path, at, drift) for at in inside.tolist()]
    return float(np.ptp(np.concatenate([position, extremes])))


def _extreme(loop: LinearLoop, path: Trajectory, at: float, drift: float) -> float:
    """The extreme of the position without its drift, near the time ``at``, by the exact motion."""
    k = int(np.searchsorted(path.time, at)) - 1
    mode = float(np.sign(path.state[k, 1] + path.state[k + 1, 1]))
    y, dy = state_after(path.state[k], mode, at - path.time[k], loop), np.empty(loop.states)
    rate(y, mode, loop, dy)
    return float(y[PHI] - drift * at - 0.5 * (y[PHI_DOT] - drift) ** 2 / dy[PHI_DOT])


def branch(
    joint_at: Callable[[float], Joint],
    low: float,
    high: float,
    value: float,
    start: np.ndarray | None = None,
) -> tuple[JointCycle, list[continuation.BranchPoint]]:
    """The branch of cycles over a parameter, through the cycle at ``value``.

    Args:
        joint_at: Makes the loop for a value of the parameter.
        low: Lower end of the range of the parameter.
        high: Its upper end.
        value: Where the branch begins, from a cycle that is the final motion there.
        start: State x (n,) from which that motion is followed; by default that of
            :meth:`Joint.state`.

    Returns:
        The cycle at ``value``, and the points of the branch in order along it.

    Raises:
        ParameterError: The final motion at ``value`` is no cycle, or a loop is not possible.
    """
    here = joint_at(value)
    cycle = limit_cycle(here.loop, here.state(start))
    found = continuation.Branch(lambda value: joint_at(value).in_units(here.units).loop, low, high)
    points = found.follow(value, cycle)
    in_units = [point._replace(cycle=_with_units(here, point.cycle)) for point in points]
    return _with_units(here, cycle), in_units

r"""Proof of a hunting cycle in interval arithmetic: it exists, is the only one near, and is stable.

A certificate is a box of two errors and two times. :func:`check` alone makes the proof, from it and
the axis, with its own equations and with balls that contain every rounding error (python-flint).

The cycle slides up from the error :math:`e_+` for :math:`T_+`, sticks until the integral breaks it
away, slides down from :math:`e_-` for :math:`T_-`, and sticks. At breakaway v = 0, and the holding
force is the breakaway level, so the error alone is the state. A slide is linear,

.. math:: x(t) = e^{At}(x(0) - x_c) + x_c,

and the cycle is a zero of the four equations :math:`v_±(T_±) = 0`, :math:`e_±(T_±) = e_∓`.
Krawczyk's operator maps the box into its inside, so it contains exactly one zero (R. Krawczyk,
Computing 4, 1969). Inequalities remain: the axis moves in one direction during a slide, sticks at
its end, and is carried towards the other breakaway. The product of :math:`∂e_±(T_±)/∂e_±` is the
multiplier, for the error alone is the state.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from furuta.axis.axis import Axis, Cascade, Controller, Pid, check_axis, servo_cycle
from furuta_model.optional import needed_by
from furuta_model.parameters import ParameterError

with needed_by("furuta.axis.proof"):
    from flint import arb, arb_mat, ctx

BITS = 128  # of the balls' centres
RADIUS = 1e-15  # of the box, relative to its centre
REFINEMENTS = 4  # Newton steps from the engine's cycle
MOST_PIECES = 2000  # of a slide, to show that it has one direction
UP, DOWN = 1, -1


class Certificate(NamedTuple):
    """Box of errors before the slides up and down [rad] and their times [s], as decimal balls."""

    error_up: str
    error_down: str
    time_up: str
    time_down: str


class Proof(NamedTuple):
    """Bounds of the only cycle in the certificate: peak to peak [rad], period [s], multiplier."""

    peak_to_peak_rad: tuple[float, float]
    period_s: tuple[float, float]
    multiplier: tuple[float, float]
    stable: bool
    certificate: Certificate


class _Slides:
    """The axis over (v, e, integral of the error or of the speed's error), in balls."""

    def __init__(self, axis: Axis, controller: Controller) -> None:
        check_axis(axis, controller)
        friction = axis.friction
        if axis.law != "stiction" or friction.alpha1 <= 0.0:
            raise ParameterError(
                "only cycles with law stiction and alpha1 above 0 are proved: "
                f"law {axis.law}, alpha1 {friction.alpha1:g}"
            )
        inertia, viscous = arb(axis.inertia), arb(friction.viscous)
        if isinstance(controller, Cascade):
            position, speed, integral = map(arb, controller)
            forces, to_integral = (-speed, speed * position, integral), (arb(-1), position)
        else:
            kp, ki, kd, _ = map(arb, controller)
            forces, to_integral = (-kd, kp, ki), (arb(0), arb(1))
        if not forces[2] > 0 or (isinstance(controller, Pid) and controller.filter_time):
            raise ParameterError("only a controller with an integral and no filter is proved")
        row = [force / inertia for force in forces]
        self.stuck_rate = forces[2] * to_integral[1]  # of the holding force, per error
        row[0] -= viscous / inertia
        self.a = arb_mat([row, [-1, 0, 0], [*to_integral, 0]])
        self.forces = forces
        levels = arb(friction.alpha0), arb(friction.alpha0) + arb(friction.alpha1)
        # Levels of sliding and of breakaway by direction.
        self.levels = {
            way: [level * (1 + way * arb(friction.asymmetry)) for level in levels]
            for way in (UP, DOWN)
        }

    def start(self, way: int, error: arb) -> arb_mat:
        """x(0) − x_c at breakaway."""
        sliding, breakaway = self.levels[way]
        integral = (way * (breakaway - sliding) - self.forces[1] * error) / self.forces[2]
        return arb_mat([[0], [error], [integral]])

    def after(self, way: int, error: arb, time: arb) -> tuple[arb_mat, arb_mat, arb_mat]:
        """State x − x_c after ``time``, its rate, and its derivative by the error (3, 1)."""
        flow = (self.a * time).exp()
        x = flow * self.start(way, error)
        by_error = flow * arb_mat([[0], [1], [-self.forces[1] / self.forces[2]]])
        return x, self.a * x, by_error

    def equations(self, z: list[arb]) -> tuple[arb_mat, arb_mat]:
        """What is zero on the cycle, v and e after both slides (4, 1), and the Jacobian (4, 4)."""
        f, jacobian = [], []
        for i, way in enumerate((UP, DOWN)):
            x, rate, by_error = self.after(way, z[i], z[2 + i])
            f += [[x[0, 0]], [x[1, 0] - z[1 - i]]]
            for k in (0, 1):
                row = [arb(0)] * 4
                row[i], row[2 + i] = by_error[k, 0], rate[k, 0]
                row[1 - i] -= k
                jacobian.append(row)
        return arb_mat(f), arb_mat(jacobian)


def prove_cycle(axis: Axis, controller: Controller) -> Proof:
    """Prove the cycle of an axis with the law stiction under a PID without filter or a cascade.

    Raises:
        ParameterError: The axis has no such cycle, or the proof fails; the message says where.
    """
    return check(axis, controller, certificate(axis, controller))


def certificate(axis: Axis, controller: Controller) -> Certificate:
    """A box around the cycle that the engine finds, refined to the precision of the balls."""
    ctx.prec = BITS
    slides = _Slides(axis, controller)
    cycle = servo_cycle(axis, controller)
    if cycle.kind != "limit_cycle" or not np.isfinite(cycle.period_s):
        raise ParameterError("the axis has no periodic cycle")
    path = cycle.trace()
    # A period begins at the upper reversal.
    edges = np.flatnonzero(np.diff(np.concatenate([[0], path.state[:, 1] != 0.0, [0]])))
    if len(edges) != 4:
        raise ParameterError("the cycle has other than two slides with stops")
    first, last = edges[::2] - 1, np.minimum(edges[1::2], len(path.time) - 1)
    (down, up), (down_time, up_time) = path.state[first, 2], path.time[last] - path.time[first]
    z = [arb(float(value)) for value in (up, down, up_time, down_time)]
    for _ in range(REFINEMENTS):
        f, jacobian = slides.equations(z)
        step = jacobian.mid().solve(f.mid())
        z = [(value - step[i, 0]).mid() for i, value in enumerate(z)]
    return Certificate(*(arb(v, abs(v) * RADIUS).str(40, more=True) for v in z))


def check(axis: Axis, controller: Controller, given: Certificate) -> Proof:
    """Prove that the certificate's box contains exactly one cycle, and whether it is stable.

    Raises:
        ParameterError: An inequality does not hold over the box; the message says which.
    """
    ctx.prec = BITS
    slides = _Slides(axis, controller)
    box = [arb(ball) for ball in given]
    _require(all(time > 0 for time in box[2:]), "a slide takes no time")
    _contract(slides, box)
    period, multiplier = arb(0), arb(1)
    for i, way in enumerate((UP, DOWN)):
        error, other, time = box[i], box[1 - i], box[2 + i]
        _require(_one_direction(slides, way, error, time), "a slide turns round")
        x, _, by_error = slides.after(way, error, time)
        multiplier *= by_error[1, 0]
        held = way * slides.levels[way][0] + slides.forces[1] * x[1, 0] + slides.forces[2] * x[2, 0]
        low, high = -slides.levels[DOWN][1], slides.levels[UP][1]
        _require(low < held < high, "the axis does not stick at the end of a slide")
        rate = slides.stuck_rate * other
        _require(way * rate < 0, "the integral does not carry the axis to the other breakaway")
        period += time + ((low if way == UP else high) - held) / rate
    size = abs(box[0] - box[1])
    stable = bool(abs(multiplier) < 1)
    return Proof(_bounds(size), _bounds(period), _bounds(multiplier), stable, given)


def _contract(slides: _Slides, box: list[arb]) -> None:
    """Krawczyk: m − Y f(m) + (1 − Y J(box)) (box − m) is inside the box."""
    middle = [ball.mid() for ball in box]
    f, near = slides.equations(middle)
    _, jacobian = slides.equations(box)
    y = near.mid().inv().mid()
    unit = arb_mat(4, 4, [int(i == k) for i in range(4) for k in range(4)])
    spread = arb_mat([[ball - m] for ball, m in zip(box, middle, strict=True)])
    image = (unit - y * jacobian) * spread - y * f
    inside = all(box[i].contains_interior(m + image[i, 0]) for i, m in enumerate(middle))
    _require(inside, "Krawczyk's operator does not map the box into itself")


def _one_direction(slides: _Slides, way: int, error: arb, time: arb) -> bool:
    """Whether v has the sign of ``way`` during (0, time), and the slide ends as v changes it."""
    waiting = [(arb(0), time)]
    for _ in range(MOST_PIECES):
        if not waiting:
            return True
        low, high = waiting.pop()
        x, rate, _ = slides.after(way, error, low.union(high))
        v, acceleration = way * x[0, 0], way * rate[0, 0]
        at_start, at_end = low == 0 and acceleration > 0, high is time and acceleration < 0
        if not (v > 0 or at_start or at_end):
            middle = ((low + high) / 2).mid()
            waiting += [(low, middle), (middle, high)]
    return False


def _bounds(ball: arb) -> tuple[float, float]:
    """The next floating-point numbers outside the ball."""
    low, high = float(ball.lower()), float(ball.upper())
    return float(np.nextafter(low, -np.inf)), float(np.nextafter(high, np.inf))


def _require(holds: Any, failure: str) -> None:
    if not holds:
        raise ParameterError(f"not proved: {failure}")

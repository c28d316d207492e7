"""The closed loop under every friction law in plain Python, by scipy, with events.

An independent reference for the compiled plant. Phases between events are smooth; a phase ends
where the arm reverses, sticks or breaks away, and where a spring begins or ceases to slip.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from reference import accelerations
from scipy.integrate import solve_ivp

from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum

TOLERANCES = {"rtol": 1e-9, "atol": 1e-12}
# Step off an event [s], so that the next phase does not end at its begin.
NUDGE = 1e-9
MOST_PHASES = 4000


class Cycle(NamedTuple):
    """The last full cycle: peak to peak of the arm [rad] and period [s]."""

    peak_to_peak: float
    period: float


class EventLoop:
    """State feedback u = l·x on the pendulum with one friction law."""

    def __init__(self, law: str, p: Friction, gains: np.ndarray, springs: int = 0) -> None:
        self.law, self.p, self.gains, self.springs = law, p, gains, springs
        self.body = FurutaPendulum()
        self.direction, self.slips = 1.0, np.zeros(springs, dtype=bool)
        self.shares = (2.0 * np.arange(springs) + 1.0) / max(springs, 1)
        self.stuck = False

    def level(self, v: float) -> float:
        """g(v) [V] in the direction of the phase."""
        p = self.p
        curve = p.alpha0
        if self.law in ("stribeck", "lugre", "maxwell_slip"):
            curve += p.alpha1 * np.exp(-((v / p.stribeck_velocity) ** 2))
        return float(curve * (1.0 + self.direction * p.asymmetry))

    def breakaway(self, direction: float) -> float:
        """Level [V] that holds a stuck arm."""
        extra = 0.0 if self.law == "coulomb" else self.p.alpha1
        return (self.p.alpha0 + extra) * (1.0 + direction * self.p.asymmetry)

    def friction(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """F [V] without the viscous part, and the rates of the law's own states."""
        p, v = self.p, float(x[1])
        level = self.level(v)
        if self.law == "maxwell_slip":
            slip = self.direction * self.shares * level / p.sigma0
            z = np.where(self.slips, slip, x[4:])
            return float(np.mean(p.sigma0 * z)), np.where(self.slips, 0.0, v)
        if self.law in ("lugre", "dahl"):
            rate = v - p.sigma0 * self.direction * v / level * x[4]
            damping = p.sigma1 if self.law == "lugre" else 0.0
            return p.sigma0 * x[4] + damping * rate, np.array([rate])
        return self.direction * level, np.zeros(0)

    def holding(self, x: np.ndarray) -> float:
        """Friction [V] that keeps the arm's acceleration at zero, v = 0."""
        u = float(self.gains @ x[:4])
        free = accelerations(0.0, x[2], x[3], u, self.body)[0]
        unit = accelerations(0.0, x[2], x[3], u - 1.0, self.body)[0]
        return float(free / (free - unit))

    def rate(self, _: float, x: np.ndarray) -> np.ndarray:
        """Derivative of the state in this phase."""
        v = 0.0 if self.stuck else float(x[1])
        force, own = (self.holding(x), np.zeros(0)) if self.stuck else self.friction(x)
        torque = float(self.gains @ x[:4]) - force - self.p.viscous * v
        v_dot, w_dot = accelerations(v, x[2], x[3], torque, self.body)
        return np.array([v, 0.0 if self.stuck else v_dot, x[3], w_dot, *own])

    def events(self) -> list[Callable[[float, np.ndarray], float]]:
        """Functions whose zeros end the phase."""
        if self.stuck:
            made = [lambda t, x, s=s: s * self.holding(x) - self.breakaway(s) for s in (1.0, -1.0)]
        else:
            made = [lambda t, x: -self.direction * float(x[1])]
            made += [lambda t, x, i=i: self.spring_margin(x, i) for i in range(self.springs)]
        for each in made:
            each.terminal, each.direction = True, 1.0  # type: ignore[attr-defined]
        return made

    def spring_margin(self, x: np.ndarray, i: int) -> float:
        """Positive where a spring must change: it reaches its level, or its level outruns it."""
        v, p = float(x[1]), self.p
        if not self.slips[i]:
            return float(self.direction * x[4 + i] - self.shares[i] * self.level(v) / p.sigma0)
        # dg/dt over v, which is smooth through v = 0.
        slope = -2.0 * p.alpha1 / p.stribeck_velocity**2 * (1.0 + self.direction * p.asymmetry)
        slope *= np.exp(-((v / p.stribeck_velocity) ** 2))
        return float(self.direction * self.shares[i] / p.sigma0 * slope * self.rate(0.0, x)[1] - 1)

    def switch(self, x: np.ndarray, event: int) -> np.ndarray:
        """Begin the next phase."""
        if self.stuck:
            self.stuck, self.direction = False, (1.0, -1.0)[event]
        elif event == 0:
            self.reverse(x)
        else:
            i = event - 1
            if self.slips[i]:
                x[4 + i] = self.direction * self.shares[i] * self.level(x[1]) / self.p.sigma0
            self.slips[i] = not self.slips[i]
        return x

    def reverse(self, x: np.ndarray) -> None:
        """The arm is at rest: it sticks, slides on or slides back."""
        x[1] = 0.0
        slip = self.direction * self.shares * self.level(0.0) / self.p.sigma0
        x[4 : 4 + self.springs] = np.where(self.slips, slip, x[4 : 4 + self.springs])
        self.slips[:] = False
        if self.law in ("coulomb", "stiction", "stribeck"):
            hold = self.holding(x)
            self.direction = 1.0 if hold > 0.0 else -1.0
            self.stuck = abs(hold) <= self.breakaway(self.direction)
        else:
            self.direction = -self.direction

    def run(self, x: np.ndarray, seconds: float, middle: float) -> Cycle:
        """The last cycle of a run from ``x``, between upward crossings of the angle ``middle``."""
        t, x = 0.0, np.array(x, dtype=float)
        self.direction = 1.0 if x[1] >= 0.0 else -1.0
        slip = self.direction * self.shares * self.level(x[1]) / self.p.sigma0
        self.slips = np.abs(x[4 : 4 + self.springs] - slip) < 1e-3 * np.abs(slip)
        turns: list[tuple[float, float]] = []
        crossings: list[float] = []
        crossing = _Crossing(middle)
        method: Any = "Radau" if self.law in ("lugre", "dahl") else "DOP853"
        for _ in range(MOST_PHASES):
            events = [*self.events(), crossing]
            found = solve_ivp(
                self.rate, (t, seconds), x, method=method, events=events, **TOLERANCES
            )
            t, x = float(found.t[-1]), found.y[:, -1].copy()
            crossings += list(found.t_events[-1])
            if found.status != 1:
                break
            event = next(i for i, each in enumerate(found.t_events) if len(each))
            if not self.stuck and event == 0:
                turns.append((t, float(x[0])))
            x = self.switch(x, event)
            x = x + NUDGE * self.rate(t, x)
            t += NUDGE
        first, last = crossings[-2:]
        angles = [angle for time, angle in turns if first < time < last]
        return Cycle(max(angles) - min(angles), last - first)


class _Crossing:
    """Event where the arm passes an angle upward; it does not end the phase."""

    terminal, direction = False, 1.0

    def __init__(self, angle: float) -> None:
        self.angle = angle

    def __call__(self, t: float, x: np.ndarray) -> float:
        return float(x[0]) - self.angle

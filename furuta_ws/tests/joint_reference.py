"""A linear loop with a friction joint in plain Python, by scipy, with events.

Independent of the project's engine: its own friction laws, its own switching, no scaled units.
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from furuta_model.friction.parameters import Friction

RTOL = 1e-11
REPEATED = 1e-9
MOST_PIECES = 3000
LONGEST_WAIT = 1e7  # [s]
MOST_TURNS = 16


class Motion(NamedTuple):
    """How the motion ended: cycle, rest or other; peak to peak and period of a cycle.

    A rest has the size of the largest slide to it.
    """

    kind: str
    peak_to_peak: float = 0.0
    period: float = 0.0


class ReferenceJoint:
    """ẋ = A x + r − b F, v = x[0]; friction by law name."""

    def __init__(self, a: np.ndarray, b: np.ndarray, r: np.ndarray, law: str, p: Friction) -> None:
        self.a, self.b, self.r, self.law, self.p = a, b, r, law, p
        self.n = len(b)
        # Stuck: F holds v = 0.
        self.a_stuck = a - np.outer(b, a[0]) / b[0]
        self.r_stuck = r - b * r[0] / b[0]

    def level(self, v: float, direction: float) -> float:
        """Level of friction while the joint slides at speed v."""
        p = self.p
        extra = p.alpha1 * np.exp(-((v / p.stribeck_velocity) ** 2))
        level = p.alpha0 + (extra if self.law in ("stribeck", "lugre") else 0.0)
        return float(level * (1.0 + direction * p.asymmetry))

    def breakaway(self, direction: float) -> float:
        """Level at which the joint leaves rest."""
        extra = 0.0 if self.law == "coulomb" else self.p.alpha1
        return (self.p.alpha0 + extra) * (1.0 + direction * self.p.asymmetry)

    def holding(self, x: np.ndarray) -> float:
        """Friction that holds the joint at rest."""
        return float((self.a[0] @ x + self.r[0]) / self.b[0])

    def slide(self, q: float, x: np.ndarray, z: float, direction: float, longest: float):  # type: ignore[no-untyped-def]
        """Integrate a slide to v = 0 or for ``longest``: (time, q, x, z, extremes of q, ended)."""
        p, bristle = self.p, self.law in ("lugre", "dahl")

        def rate(_: float, y: np.ndarray) -> np.ndarray:
            v, z = y[1], y[-1]
            level = self.level(v, direction)
            z_dot = 0.0
            if bristle:
                z_dot = v - p.sigma0 * direction * v / level * z
                force = p.sigma0 * z + (p.sigma1 * z_dot if self.law == "lugre" else 0.0)
            else:
                force = direction * level
            x_dot = self.a @ y[1:-1] + self.r - self.b * (force + p.viscous * v)
            return np.concatenate([[v], x_dot, [z_dot]])

        def reversal(_: float, y: np.ndarray) -> float:
            return float(direction * y[1])

        reversal.terminal, reversal.direction = True, -1.0  # type: ignore[attr-defined]
        start = np.concatenate([[q], x, [z]])
        # Step off the event by a series, so that it is not found again.
        nudge = 1e-7 * longest
        first = rate(0.0, start)
        start = start + nudge * first + 0.5 * nudge * (rate(0.0, start + nudge * first) - first)
        scale = np.maximum(np.abs(start), 1e-3 * np.abs(first))
        out = solve_ivp(
            rate,
            (0.0, longest),
            start,
            "LSODA" if bristle else "DOP853",
            events=reversal,
            rtol=RTOL if not bristle else 1e-10,
            atol=1e-13 * scale + 1e-15,
        )
        y = out.y[:, -1]
        ended = out.status == 1
        if ended:
            y[1] = 0.0
        return nudge + out.t[-1], y[0], y[1:-1], y[-1], ended

    def wait(self, x: np.ndarray) -> tuple[float, np.ndarray, bool]:
        """Stuck motion to breakaway by the matrix exponential and bisection."""
        m = np.zeros((self.n + 1, self.n + 1))
        m[:-1, :-1], m[:-1, -1] = self.a_stuck, self.r_stuck
        y = np.append(x, 1.0)

        def beyond(t: float) -> float:
            hold = self.holding((expm(m * t) @ y)[:-1])
            return max(hold - self.breakaway(1.0), -hold - self.breakaway(-1.0))

        step, t = 1e-3, 0.0
        while t < LONGEST_WAIT:
            if beyond(t + step) > 0.0:
                low, high = t, t + step
                for _ in range(100):
                    middle = 0.5 * (low + high)
                    low, high = (low, middle) if beyond(middle) > 0.0 else (middle, high)
                return high, (expm(m * high) @ y)[:-1], True
            t += step
            step = max(step, 0.02 * t)
        return t, x, False

    def run(self, x: np.ndarray, longest: float, disturbance: np.ndarray) -> Motion:
        """Follow from x until reversals repeat, under a law that truly sticks.

        A joint that comes to rest is disturbed once.
        """
        self.at_rest = x
        motion = self._follow(x, longest)
        if motion.kind == "rest":
            self.at_rest[0] = 0.0
            motion = self._follow(self.at_rest + disturbance, longest)
        return motion

    def _follow(self, x: np.ndarray, longest: float) -> Motion:
        """Slides of less than 1e-8 of the largest are a rest."""
        q, time, largest, lower, x = 0.0, 0.0, 0.0, 0.0, x.copy()
        reversals: list[tuple[float, float, float]] = []  # time, upper q, lower q before it
        for _ in range(MOST_PIECES):
            if -self.breakaway(-1.0) <= self.holding(x) <= self.breakaway(1.0):
                lasted, x, broke = self.wait(x)
                time += lasted
                if not broke:
                    return Motion("rest", largest)
            direction = 1.0 if self.holding(x) > 0.0 else -1.0
            before = q
            lasted, q, x, _, ended = self.slide(q, x, 0.0, direction, longest)
            time += lasted
            largest = max(largest, abs(q - before))
            self.at_rest = x
            if not ended:
                return Motion("rest" if abs(x[0]) * longest < 1e-3 * largest else "other", largest)
            lower = min(lower, q)
            if direction > 0.0 and abs(q - before) > 1e-6 * largest:
                reversals.append((time, q, lower))
                lower = q
                if repeated := self._repeated(reversals):
                    return repeated
            if abs(q - before) < 1e-8 * largest:
                return Motion("rest")
        return Motion("other")

    @staticmethod
    def _repeated(reversals: list[tuple[float, float, float]]) -> Motion | None:
        """The cycle of few reversals per period with which the motion ends."""
        for turns in range(1, MOST_TURNS + 1):
            if len(reversals) < 4 * turns:
                return None
            time, upper, lower = np.array(reversals).T
            periods = (time[turns:] - time[:-turns])[::-turns][:3]
            ends = [len(time) - k * turns for k in range(3)]
            sizes = [np.ptp([*upper[end - turns : end], *lower[end - turns : end]]) for end in ends]
            same = max(np.ptp(periods) / periods[-1], np.ptp(sizes) / sizes[-1])
            if same < REPEATED:
                return Motion("cycle", float(sizes[-1]), float(periods[-1]))
        return None

    def closes(self, x: np.ndarray, z: float, period: float) -> tuple[float, float]:
        """Follow a bristle from an upper reversal for a period.

        Returns the peak to peak, and the largest change of a state relative to its range.
        """
        start, q, time, direction = np.append(x, z), 0.0, 0.0, -1.0
        ends = [start]
        extremes = [0.0]
        while period - time > 1e-6 * period and len(ends) < MOST_PIECES:
            lasted, q, x, z, _ = self.slide(q, x, z, direction, period - time)
            time += lasted
            direction = -direction
            extremes.append(q)
            ends.append(np.append(x, z))
        change = np.abs(ends[-1] - start)[1:] / np.ptp(ends, axis=0)[1:]
        return float(np.ptp(extremes)), float(change.max())

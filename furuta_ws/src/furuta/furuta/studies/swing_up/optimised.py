"""The fastest swing-up from hanging to upright at rest, within voltage, arm travel and arm speed.

Single shooting: the unknowns are the torque u − F [V] at equal intervals and the duration; the
states follow from eq. (1), friction from its Coulomb and viscous parts. A swing-up takes about a
period of the pendulum, so the motion amplifies rounding by some hundreds only, and the gradient by
differences is exact enough. Sequential quadratic programming finds a local optimum. It starts from
switching torques with one switch more in each attempt, at a coarse discretisation; the fastest
result is refined.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import yaml
from scipy.optimize import Bounds, minimize

from furuta_control.modes.tracking import ROWS, TORQUE, roll_out
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, THETA, THETA_DOT
from furuta_sim.simulation.closed_loop import Loop

# Torques of the trajectory: in the first attempts, and of the result.
COARSE_TORQUES = 21
TORQUES = 41
# Share of the limits that a trajectory uses; the rest is for its tracking.
TRACKED_SHARE = 0.85
# Rows between two at which the limits are checked.
CHECKED_EVERY = 8
# Speed [rad/s] at which Coulomb friction has reached its level, for a smooth problem.
FRICTION_SPEED = 0.1
# Largest error at the end that counts as upright at rest [rad, rad/s].
END_ERROR = 1e-3
# Step of the gradient's differences.
DIFFERENCE = 1e-7
MOST_ITERATIONS = 150
# Switches of the torque in the first attempts, and their duration relative to the usual one.
SWITCHES = range(1, 6)
DURATIONS = (0.5, 0.8)

Function = Callable[[np.ndarray], np.ndarray]


class Trajectory(NamedTuple):
    """Torques u − F [V] at equal intervals over the ``duration`` [s]."""

    torques: tuple[float, ...]
    duration: float

    def parameter_file(self) -> str:
        """The trajectory as a ROS parameter file of the controller."""
        given = {"torques": list(self.torques), "duration": self.duration}
        content = {"controller": {"ros__parameters": {"swing_up": given}}}
        return yaml.safe_dump(content, sort_keys=False)


def fastest_swing_up(loop: Loop, share: float = TRACKED_SHARE) -> Trajectory:
    """The fastest swing-up of a loop's model with that ``share`` of the limits.

    Its friction is that of the compensator's model.

    Raises:
        ParameterError: No swing-up within the limits was found.
    """
    coarse, fine = (_Problem(loop, share, torques) for torques in (COARSE_TORQUES, TORQUES))
    attempts = (
        coarse.solve(coarse.switching(switches, duration))
        for switches in SWITCHES
        for duration in DURATIONS
    )
    solved = [trajectory for trajectory in attempts if trajectory is not None]
    start = min(solved, key=lambda trajectory: trajectory.duration, default=None)
    refined = fine.solve(fine.resampled(start)) if start else None
    if refined is None:
        raise ParameterError(
            f"found no swing-up with {fine.voltage:g} V, {fine.travel:g} rad and "
            f"{fine.speed:g} rad/s"
        )
    return refined


class _Problem:
    """The problem in scaled unknowns: torques over the voltage limit, and the duration."""

    def __init__(self, loop: Loop, share: float, torques: int) -> None:
        p, friction = loop.controller, loop.observer.friction
        self.voltage, self.travel = share * p.voltage_limit, share * p.arm_angle_limit
        self.speed = share * p.arm_speed_limit
        self._model, self._torques = p.model, torques
        self._level, self._viscous = friction.alpha0, friction.viscous
        self._table = np.zeros((ROWS, RIGID_STATES + 1))
        self._frequency = float(np.sqrt(p.model.delta / p.model.beta))
        # Rows of the table lie between two torques, at a part of the distance.
        places = np.arange(ROWS) / (ROWS - 1) * (torques - 1)
        self._first = np.minimum(places.astype(int), torques - 2)
        self._part = places - self._first

    def switching(self, switches: int, part: float) -> np.ndarray:
        """A torque that switches at equal intervals, of that ``part`` of half a period."""
        signs = (-1.0) ** np.floor(np.linspace(0.0, switches + 1 - 1e-9, self._torques))
        speed = min(self.speed, 50.0)
        size = 2.0 * speed * self._frequency / np.pi * self._model.alpha / self.voltage
        duration = (switches + 1) * part * np.pi / self._frequency
        return np.append(min(size, 0.8) * signs, duration)

    def resampled(self, start: Trajectory) -> np.ndarray:
        """The unknowns of a given trajectory."""
        places = np.linspace(0.0, 1.0, self._torques)
        given = np.linspace(0.0, 1.0, len(start.torques))
        torques = np.interp(places, given, start.torques) / self.voltage
        return np.append(torques, start.duration)

    def solve(self, unknowns: np.ndarray) -> Trajectory | None:
        """A local optimum; None if the end is not reached or a limit not kept."""
        shortest, longest = 0.2 * np.pi / self._frequency, 10.0 * np.pi / self._frequency
        largest = 2.0 * np.ones(self._torques)
        result = minimize(
            lambda x: x[-1],
            unknowns,
            jac=lambda x: np.append(np.zeros(self._torques), 1.0),
            method="SLSQP",
            bounds=Bounds(np.append(-largest, shortest), np.append(largest, longest)),
            constraints=[
                {"type": "eq", "fun": self._end, "jac": _slope(self._end)},
                {"type": "ineq", "fun": self._margins, "jac": _slope(self._margins)},
            ],
            options={"maxiter": MOST_ITERATIONS, "ftol": 1e-6},
        )
        kept = np.all(self._margins(result.x) > -END_ERROR)
        if not kept or np.max(np.abs(self._end(result.x))) > END_ERROR:
            return None
        torques = tuple(float(torque) * self.voltage for torque in result.x[:-1])
        return Trajectory(torques, float(result.x[-1]))

    def _rows(self, unknowns: np.ndarray) -> np.ndarray:
        """States and torque (ROWS, 5) along a trajectory, at equal intervals."""
        torques = unknowns[:-1] * self.voltage
        before, after = torques[self._first], torques[self._first + 1]
        self._table[:, TORQUE] = (1.0 - self._part) * before + self._part * after
        roll_out(self._table, unknowns[-1] / (ROWS - 1), self._model)
        return self._table

    def _end(self, unknowns: np.ndarray) -> np.ndarray:
        """Arm speed, pendulum angle and speed at the end, relative to what is usual."""
        end = self._rows(unknowns)[-1]
        speeds = end[PHI_DOT] / self._frequency, end[THETA_DOT] / self._frequency
        return np.array((speeds[0], np.sin(0.5 * end[THETA]), speeds[1]))

    def _margins(self, unknowns: np.ndarray) -> np.ndarray:
        """What is left to the limits, relative to them."""
        table = self._rows(unknowns)[::CHECKED_EVERY]
        v = table[:, PHI_DOT]
        level = self._level * np.tanh(v / FRICTION_SPEED)
        u = table[:, TORQUE] + level + self._viscous * v
        used = np.concatenate((u / self.voltage, v / self.speed))
        if np.isfinite(self.travel):
            used = np.append(used, table[:, PHI] / self.travel)
        return np.concatenate((1.0 - used, 1.0 + used))


def _slope(function: Function) -> Function:
    """The Jacobian of a function of the unknowns, by differences."""

    def slope(unknowns: np.ndarray) -> np.ndarray:
        here = function(unknowns)
        jacobian = np.empty((len(here), len(unknowns)))
        for i in range(len(unknowns)):
            moved = unknowns.copy()
            moved[i] += DIFFERENCE
            jacobian[:, i] = (function(moved) - here) / DIFFERENCE
        return jacobian

    return slope

r"""One joint with friction: the electro-mechanical positioning system (EMPS).

.. math::
    M \dot v = u(t - τ) - F_v v - a |v| - F - f_0 - k (x - x_0) - f_1 (t - t_0)

u is the force [N] of the drive, F the dry friction with the level
:math:`(F_c + s (x - x_0) + F_s e^{-(v/v_s)^2} + l|u|)(1 \pm a_c)`. Viscous friction differs by
direction by a. x₀ is the middle of the travel, t₀ that of the record. The joint truly sticks, or
moves a LuGre bristle if σ₀ > 0. Source: Janot, Gautier and Brunot, Data set and reference models of
EMPS, Nonlinear System Identification Benchmarks (2019).
"""

from __future__ import annotations

from math import exp
from pathlib import Path
from typing import NamedTuple

import numpy as np

from furuta_model.compiled import compiled
from furuta_model.friction.lugre import bristle_after
from furuta_model.friction.parameters import Friction

# Force per volt of the motor's voltage signal [N/V] (published).
FORCE_PER_VOLT = 35.15065
# Integration steps per sample of 1 ms.
STEPS = 2
# Middle of the travel [m].
MIDDLE = 0.12
# Samples at the start from which position and speed at the start are found.
START_SAMPLES = 20


class Joint(NamedTuple):
    """Parameters of the joint."""

    mass: float = 95.0  # M [kg]
    viscous: float = 200.0  # F_v [N s/m]
    coulomb: float = 20.0  # F_c [N]
    direction: float = 0.0  # a: what viscous friction is more for v > 0, and less for v < 0 [N s/m]
    offset: float = 0.0  # f₀ [N]
    level_slope: float = 0.0  # s: change of the level along the travel [N/m]
    spring: float = 0.0  # k [N/m]
    drift: float = 0.0  # f₁ [N/s]
    delay: float = 1e-3  # τ, as a lag [s]
    stiction: float = 0.0  # F_s [N]
    stribeck_velocity: float = 0.02  # v_s [m/s]
    asymmetry: float = 0.0  # a_c
    load: float = 0.0  # l
    stiffness: float = 0.0  # σ₀ [N/m]; 0: no presliding


class Record(NamedTuple):
    """A record: time [s], position [m] and force [N] (n,), evenly sampled.

    The middle of the whole record in time is at 0.
    """

    time: np.ndarray
    position: np.ndarray
    force: np.ndarray

    @property
    def step(self) -> float:
        """Time between two samples [s]."""
        return float((self.time[-1] - self.time[0]) / (len(self.time) - 1))

    def part(self, begin: int, end: int) -> Record:
        """The samples begin ≤ k < end; time is not shifted."""
        return Record(*(series[begin:end] for series in self))

    @property
    def start(self) -> tuple[float, float]:
        """Position [m] and speed [m/s] at the first sample, by a cubic through the first ones."""
        time = self.time[: START_SAMPLES + 1] - self.time[0]
        _, _, speed, position = np.polyfit(time, self.position[: START_SAMPLES + 1], 3)
        return float(position), float(speed)


def read_record(file: Path) -> Record:
    """Read a table with the columns time [s], position [m], reference [m], voltage signal [V].

    Raises ValueError with one line if it is another table.
    """
    try:
        table = np.genfromtxt(file, delimiter=",", skip_header=1, dtype=float)
    except ValueError as error:
        raise ValueError(f"{file}: {str(error).splitlines()[0]}") from None
    if table.ndim != 2 or table.shape[1] != 4 or len(table) < 10 * START_SAMPLES:
        raise ValueError(f"{file} must have four columns and {10 * START_SAMPLES} rows or more")
    if not np.all(np.isfinite(table)) or np.any(np.diff(table[:, 0]) <= 0.0):
        raise ValueError(f"{file} must have numbers only, and increasing times")
    time = table[:, 0] - 0.5 * (table[0, 0] + table[-1, 0])
    return Record(time, table[:, 1], FORCE_PER_VOLT * table[:, 3])


def predict(joint: Joint, record: Record) -> np.ndarray:
    """Free run: the position (n,) [m] from the force alone, and the position at the start."""
    return _free_run(record.force, record.time, *record.start, record.step, joint)


def error_mm(joint: Joint, record: Record) -> float:
    """Root mean square error of the free run [mm]."""
    return float(1e3 * np.sqrt(np.mean((predict(joint, record) - record.position) ** 2)))


@compiled
def _free_run(
    force: np.ndarray, time: np.ndarray, x: float, v: float, dt: float, p: Joint
) -> np.ndarray:
    positions = np.empty(len(force))
    u, z, h = force[0], 0.0, dt / STEPS
    share = 1.0 - exp(-dt / p.delay) if p.delay > 0.0 else 1.0
    for k in range(len(force)):
        positions[k] = x
        u += share * (force[k] - u)
        driving = u - p.offset - p.drift * time[k] - p.spring * (x - MIDDLE)
        level = p.coulomb + p.level_slope * (x - MIDDLE) + p.load * abs(u)
        for _ in range(STEPS):
            before = v
            free = driving - p.viscous * v - p.direction * abs(v)
            v, z = _after(v, z, free, level, h, p)
            x += 0.5 * h * (before + v)
    return positions


@compiled
def _after(
    v: float, z: float, free: float, level: float, h: float, p: Joint
) -> tuple[float, float]:
    """Speed [m/s] and bristle [m] after a step, for the force ``free`` of dry friction [N].

    ``level`` [N] is that of the friction without Stribeck effect and asymmetry.
    """
    if p.stiffness > 0.0:
        damping = 0.5 * (p.stiffness * p.mass) ** 0.5
        friction = Friction(
            p.stiffness,
            damping,
            level,
            p.stiction,
            p.stribeck_velocity,
            0.0,
            p.asymmetry,
        )
        end, mean = bristle_after(v, 0.0, z, h, friction)
        force = p.stiffness * mean + damping * (end - z) / h
        return v + h * (free - force) / p.mass, end
    level += p.stiction * exp(-((v / p.stribeck_velocity) ** 2))
    moved = v + h * free / p.mass
    change = h * level * (1.0 + p.asymmetry if moved > 0.0 else 1.0 - p.asymmetry) / p.mass
    if moved > change:
        return moved - change, z
    return (moved + change if moved < -change else 0.0), z

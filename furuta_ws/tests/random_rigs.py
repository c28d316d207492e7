"""Simulates recordings of random rigs with the faults of real ones, by equations of its own.

A rig has random inertias, unequal friction in both directions, waves of the motor's torque, a
tilted base, a drive with a ceiling, speeds that lag, a delay. Its recording has random units, zeros
and signs.
"""

from math import cos, pi, sin, tanh
from typing import NamedTuple

import numba
import numpy as np

from furuta_recordings.recording import Recording

# Step [s] of the integration, and speed [rad/s] over which friction changes its sign.
STEP, SLIDING = 2.5e-4, 0.01
# Steps per sample: 500 Hz.
PER_SAMPLE = 8
DEGREE, RPM = pi / 180.0, pi / 30.0
KINDS = ("step", "steps", "sine", "chirp", "multisine")
# Largest and smallest amplitude of the command [V], and length of a recording [s].
AMPLITUDES, SECONDS = (1.0, 6.0), 6.0


class Rig(NamedTuple):
    """Parameters of a rig: (1) in volts, friction, waves (k, 3), tilt, drive, sensors."""

    alpha: float
    beta: float
    gamma: float
    delta: float
    viscous: float
    forward: float
    backward: float
    pendulum_viscous: float
    waves: np.ndarray
    tilt_x: float
    tilt_y: float
    ceiling: float
    delay: float
    lag: float


class Readings(NamedTuple):
    """How the rig is recorded: unit [rad], signs, pendulum's zero [rad], missing first command."""

    unit: float = 1.0
    speed_unit: float = 1.0
    pendulum: float = 1.0
    motor: float = 1.0
    hanging: bool = True
    zero: float = 0.0
    first_missing: bool = False


def sampled(seed: int) -> tuple[Rig, Readings, Recording]:
    """A random rig, how it is recorded, and a recording of it."""
    rng = np.random.default_rng(seed)
    rig, readings = random_rig(rng), random_readings(rng)
    amplitude = float(rng.uniform(*AMPLITUDES))
    kind = KINDS[seed % len(KINDS)]
    return rig, readings, record(rig, kind, amplitude, SECONDS, readings, rng, f"{seed} {kind}")


def random_rig(rng: np.random.Generator) -> Rig:
    """A rig of a random size."""
    beta = 0.0025 * 10.0 ** rng.uniform(-0.5, 0.5)
    omega = rng.uniform(5.0, 12.0)
    ratio, coupling = rng.uniform(1.5, 6.0), rng.uniform(0.3, 0.8)
    alpha = ratio * beta
    coulomb, asymmetry = rng.uniform(0.05, 0.25), rng.uniform(-0.25, 0.25)
    waves = [(1.0, *(0.01 * rng.standard_normal(2)))]
    for order in rng.choice(np.arange(2, 25), rng.integers(0, 4), replace=False):
        waves.append((float(order), *(rng.uniform(0.02, 0.1) * _direction(rng))))
    tilt_x, tilt_y = 0.03 * rng.standard_normal(2)
    return Rig(
        alpha,
        beta,
        coupling * np.sqrt(alpha * beta),
        omega**2 * beta,
        alpha / rng.uniform(0.02, 0.06),
        coulomb * (1.0 + asymmetry),
        coulomb * (1.0 - asymmetry),
        2.0 * rng.uniform(0.003, 0.02) * omega * beta,
        np.array(waves),
        tilt_x,
        tilt_y,
        rng.choice([12.0, rng.uniform(2.5, 5.0)]),
        rng.uniform(0.0, 0.006),
        rng.choice([0.0, rng.uniform(0.002, 0.01)]),
    )


def _direction(rng: np.random.Generator) -> np.ndarray:
    angle = rng.uniform(0.0, 2.0 * pi)
    return np.array([cos(angle), sin(angle)])


def random_readings(rng: np.random.Generator) -> Readings:
    """Random units, signs and zero."""
    unit = rng.choice([1.0, DEGREE])
    return Readings(
        unit,
        rng.choice([unit, unit, RPM]),
        rng.choice([1.0, -1.0]),
        rng.choice([1.0, -1.0]),
        bool(rng.random() < 0.7),
        rng.normal(0.0, 0.05),
        bool(rng.random() < 0.2),
    )


def voltage(kind: str, amplitude: float, rng: np.random.Generator, time: np.ndarray) -> np.ndarray:
    """A command [V] at every time [s] after it starts."""
    if kind == "step":
        return np.full(len(time), amplitude)
    if kind == "steps":
        levels = amplitude * rng.choice([-1.0, -0.6, 0.6, 1.0], 100)
        return np.asarray(levels[(time // rng.uniform(0.4, 1.0)).astype(int)])
    if kind == "sine":
        return np.asarray(amplitude * np.sin(2 * pi * rng.uniform(0.5, 1.5) * time))
    if kind == "chirp":
        return np.asarray(amplitude * np.sin(2 * pi * (0.3 + 0.2 * time) * time))
    frequencies, phases = rng.uniform(0.3, 3.0, 4), rng.uniform(0.0, 2 * pi, 4)
    waves = np.sin(2 * pi * np.outer(time, frequencies) + phases)
    return np.asarray(amplitude * np.mean(waves, axis=1) * 1.5)


def record(
    rig: Rig,
    kind: str,
    amplitude: float,
    seconds: float,
    readings: Readings,
    rng: np.random.Generator,
    name: str = "rig",
) -> Recording:
    """The recording of a hanging pendulum under a command of a kind; it starts at rest."""
    rest, steps = 0.4, round(seconds / STEP)
    fine = STEP * np.arange(steps)
    u = np.where(fine < rest, 0.0, voltage(kind, amplitude, rng, np.maximum(fine - rest, 0.0)))
    shift = round(rig.delay / STEP)
    acting = np.clip(np.append(np.zeros(shift), u)[:steps], -rig.ceiling, rig.ceiling)
    start = rng.uniform(-pi, pi)
    states = _simulate(acting, start, *rig[:8], rig.waves, rig.tilt_x, rig.tilt_y, rig.lag)
    time = fine[::PER_SAMPLE]
    measured = states.copy()
    measured[:, 2] = readings.pendulum * (measured[:, 2] + readings.zero)
    measured[:, 3] *= readings.pendulum
    if readings.hanging:
        measured[:, 2] += pi
    measured[:, 2] -= 2 * pi * np.round(np.mean(measured[:, 2]) / (2 * pi))
    measured += rng.normal(0.0, [2e-4, 0.02, 2e-4, 0.02], measured.shape)
    measured /= [readings.unit, readings.speed_unit, readings.unit, readings.speed_unit]
    return Recording(name, time, measured, *_logged(kind, fine, u, rest, readings))


def _logged(
    kind: str, fine: np.ndarray, u: np.ndarray, rest: float, readings: Readings
) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and values of the commands in the log: each sample, or once a second for a step."""
    if kind == "step":
        first = rest + (1.0 if readings.first_missing else 0.0)
        times = np.arange(first, fine[-1], 1.0)
        return times, readings.motor * np.full(len(times), u[-1])
    chosen = slice(None, None, PER_SAMPLE)
    on = fine[chosen] >= rest
    return fine[chosen][on], readings.motor * u[chosen][on]


@numba.njit(cache=True, error_model="numpy")
def _rates(x, u, alpha, beta, gamma, delta, c, forward, backward, c2, waves, tx, ty, lag):  # type: ignore[no-untyped-def]
    phi, v, theta, w = x[0], x[1], x[2], x[3]
    s, k = sin(theta), cos(theta)
    level = forward if v > 0.0 else backward
    arm = u - c * v - level * tanh(v / SLIDING)
    for row in waves:
        arm += row[1] * cos(row[0] * phi) + row[2] * sin(row[0] * phi)
    arm += delta * s * (tx * cos(phi) + ty * sin(phi))
    arm += gamma * s * w * w - 2.0 * beta * s * k * v * w
    joint = beta * s * k * v * v + delta * (s - k * (ty * cos(phi) - tx * sin(phi))) - c2 * w
    a, b = alpha + beta * s * s, gamma * k
    determinant = a * beta - b * b
    rates = np.empty(8)
    rates[0], rates[2] = v, w
    rates[1] = (beta * arm - b * joint) / determinant
    rates[3] = (a * joint - b * arm) / determinant
    for slow in range(2):
        speed, first, second = x[1 + 2 * slow], x[4 + 2 * slow], x[5 + 2 * slow]
        rates[4 + 2 * slow] = 2.0 * (speed - first) / lag if lag > 0.0 else 0.0
        rates[5 + 2 * slow] = 2.0 * (first - second) / lag if lag > 0.0 else 0.0
    return rates


@numba.njit(cache=True, error_model="numpy")
def _simulate(u, phi, alpha, beta, gamma, delta, c, forward, backward, c2, waves, tx, ty, lag):  # type: ignore[no-untyped-def]
    x = np.zeros(8)
    x[0], x[2] = phi, pi + ty * cos(phi) - tx * sin(phi)
    out = np.empty((len(u) // PER_SAMPLE, 4))
    h = STEP
    for n in range(len(u)):
        if n % PER_SAMPLE == 0 and n // PER_SAMPLE < len(out):
            row = out[n // PER_SAMPLE]
            row[0], row[2] = x[0], x[2]
            row[1], row[3] = (x[5], x[7]) if lag > 0.0 else (x[1], x[3])
        p = (alpha, beta, gamma, delta, c, forward, backward, c2)
        k1 = _rates(x, u[n], *p, waves, tx, ty, lag)
        k2 = _rates(x + 0.5 * h * k1, u[n], *p, waves, tx, ty, lag)
        k3 = _rates(x + 0.5 * h * k2, u[n], *p, waves, tx, ty, lag)
        k4 = _rates(x + h * k3, u[n], *p, waves, tx, ty, lag)
        x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return out


# A rig with waves, tilt, unequal friction, a ceiling, a delay and speeds that lag.
EXAMPLE = Rig(
    alpha=0.0075,
    beta=0.0025,
    gamma=0.002,
    delta=0.22,
    viscous=0.25,
    forward=0.13,
    backward=0.11,
    pendulum_viscous=4e-4,
    waves=np.array([[1.0, 0.01, 0.0], [5.0, 0.06, 0.05]]),
    tilt_x=-0.03,
    tilt_y=0.02,
    ceiling=3.0,
    delay=0.003,
    lag=0.006,
)


def example(
    kind: str, amplitude: float, readings: Readings | None = None, seconds: float = 5.0
) -> Recording:
    """A recording of the example under a command of a kind."""
    rng = np.random.default_rng(len(kind))
    return record(EXAMPLE, kind, amplitude, seconds, readings or Readings(), rng, kind)

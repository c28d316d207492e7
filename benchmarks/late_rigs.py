"""The recommended compensation on random rigs with late drives, on a plant of its own.

    tools/in_environment python benchmarks/late_rigs.py --number 200
    tools/in_environment python benchmarks/late_rigs.py --number 200 --without tuned

The plant is that of two_masses.py, which shares no equation with the simulated plant. Estimator,
friction observer, controller and tuning are those of the project, at 1 ms, with their settings for
the paper's rig.

What is random, for each seed:

- pendulum: each coefficient of (1) off by up to 10 %,
- friction: one of six laws; levels 0 to 3 times those of the file; σ₀, σ₁ and Stribeck velocity off
  by up to 30 %; with ``stiction`` up to 20 % more in one direction than in the mean,
- drive: delay 0 to 15 ms, not in whole samples, and lag 0 to 20 ms,
- every second rig is elastic, which its file does not say: 20 to 150 Hz (uniform in the logarithm),
  damping ratio 0.03, 20 to 80 % of the inertia on the motor's side, a gap of 0 to 5 mrad, 0 to
  100 % of the friction on the arm's side, sensors on either side,
- noise of tachometer and potentiometer.

All but the last two are uniform. Encoder (250 counts), converters and start are the same for all.

Each rig runs with five settings, with the same noise:

- ``none``: no compensation,
- ``right``: recommended, delay and lag in the file are right (to a sample),
- ``wrong``: the same, each wrong by up to half of it,
- ``untold``: the file states neither,
- ``tuned``: what `furuta tune` makes of ``wrong`` on this rig; where it gives up, ``wrong``.

The swing is the arm's true angle, peak to peak over the last 20 of 40 s; infinite if the pendulum
falls at any time. A fresh start from 0.05 rad and other noise follow a tuning.

Not sensible: rigs on which the pendulum falls with feedback alone, as on a soft belt behind a late
drive with much friction. They are counted, and listed apart: no compensation can be expected to
stand there. Three times the friction is at the limit of a level that is learned from 1.

It prints a line for each rig, a table for each group of rigs, and the seeds of the failures: falls
where none stands, and swings that exceed that of none by more than a count.
"""

import argparse
from functools import cache
from math import inf, pi
from typing import NamedTuple

import numpy as np
from two_masses import (
    COUNTS,
    LAWS,
    THETA,
    VOLTAGE,
    Belt,
    DryFriction,
    TwoMasses,
    converted,
    move_plant,
    read_sensors,
    released,
    two_masses,
)

import furuta
from furuta.studies.trials import Compensation
from furuta.studies.tuning import GuardError, tune
from furuta.studies.tuning_plan import TuningPlan
from furuta_model.block import new_memory
from furuta_model.compiled import compiled
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import APPLIED_TORQUE, SIGNALS
from furuta_sim.simulation.closed_loop import Loop
from furuta_sim.simulation.control_system import (
    ControlMemory,
    ControlSystem,
    control_sample,
    design_control_system,
)

SETTINGS = ("none", "right", "wrong", "untold", "tuned")
SECONDS, SETTLED, DT = 40.0, 20.0, 1e-3
RELEASE = 0.05
COUNT = 2.0 * pi / COUNTS
BODY_ERROR, FRICTION_ERROR, FILE_ERROR, ASYMMETRY = 0.1, 0.3, 0.5, 0.2
LARGEST_LEVEL, LARGEST_DELAY, LARGEST_LAG = 3.0, 0.015, 0.020
FREQUENCIES, DAMPING, LARGEST_GAP = (20.0, 150.0), 0.03, 0.005
# Steps of delay and lag in a file [s].
STATED = 1e-3
# Random streams of a rig beside that of its parameters.
RUN, TUNING = 1, 2


class LateRig(NamedTuple):
    """A random rig: its plant, and delay and lag [s] that are right and that the file states."""

    name: str
    plant: TwoMasses
    elastic: bool
    level: float
    right: tuple[float, float]
    wrong: tuple[float, float]


def about(r: np.random.Generator, value: float, error: float) -> float:
    """A value that is off by up to an error."""
    return float(value * r.uniform(1.0 - error, 1.0 + error))


def about_body(r: np.random.Generator) -> tuple[float, float, float, float]:
    """Coefficients of (1) that are nearly those of the file."""
    alpha, beta, gamma, delta = (about(r, value, BODY_ERROR) for value in FurutaPendulum())
    return alpha, beta, gamma, delta


def random_rig(seed: int) -> LateRig:
    """The rig of a seed."""
    r = np.random.default_rng(seed)
    law, level = int(r.integers(len(LAWS))), float(r.uniform(0.0, LARGEST_LEVEL))
    delay, lag = float(r.uniform(0.0, LARGEST_DELAY)), float(r.uniform(0.0, LARGEST_LAG))
    errors = 1.0 + FILE_ERROR * r.uniform(-1.0, 1.0, 2)
    body = about_body(r)
    known, more = Friction(), float(r.uniform(-ASYMMETRY, ASYMMETRY))
    more = more if LAWS[law] == "stiction" else 0.0
    friction = DryFriction(
        law=law,
        forward=(1.0 + more) * level * known.alpha0,
        backward=(1.0 - more) * level * known.alpha0,
        added=level * known.alpha1,
        stribeck_velocity=about(r, known.stribeck_velocity, FRICTION_ERROR),
        stiffness=about(r, known.sigma0, FRICTION_ERROR),
        damping=about(r, known.sigma1, FRICTION_ERROR),
    )
    belt = _random_belt(r) if seed % 2 else None
    name = f"{LAWS[law]} x {level:.2f}, {1e3 * delay:.1f} + {1e3 * lag:.1f} ms"
    if belt is not None:
        side = "motor" if belt.senses_motor else "arm"
        name += f", {belt.frequency:.0f} Hz, gap {1e3 * belt.gap:.1f} mrad, sensors on the {side}"
    return LateRig(
        name=name,
        plant=two_masses(body, friction, belt, delay, lag, DT),
        elastic=belt is not None,
        level=level,
        right=(delay, lag),
        wrong=(float(errors[0] * delay), float(errors[1] * lag)),
    )


def _random_belt(r: np.random.Generator) -> Belt:
    low, high = FREQUENCIES
    return Belt(
        frequency=float(low * (high / low) ** r.uniform()),
        damping=DAMPING,
        motor_inertia=float(r.uniform(0.2, 0.8)),
        gap=float(r.uniform(0.0, LARGEST_GAP)),
        arm_friction=float(r.uniform(0.0, 1.0)),
        senses_motor=bool(r.integers(2)),
    )


def loop_told(delay: float, lag: float) -> Loop:
    """The recommended setting of a file that states these [s], in whole milliseconds."""
    return _loop_told(round(delay / STATED), round(lag / STATED))


@cache
def _loop_told(delay: int, lag: int) -> Loop:
    drive = {"drive.delay": round(delay * STATED / DT), "drive.lag": lag * STATED}
    return furuta.make_loop({"compensation": "recommended", **drive})


class RigLoop:
    """A rig in a closed loop; tuning takes it as a simulated or a real one."""

    def __init__(self, rig: LateRig, loop: Loop, key: tuple[int, int]) -> None:
        self._plant = rig.plant
        self._state, self._sent = released(RELEASE)
        self._noise = np.random.default_rng(key)
        self._memory, self._torque = new_memory(ControlMemory), np.zeros(1)
        self.apply(Compensation(loop.estimator, loop.observer, loop.controller))

    def apply(self, compensation: Compensation) -> None:
        """Set estimator, friction observer and controller between two samples."""
        self._system = design_control_system(*compensation)

    @property
    def presliding(self) -> float:
        """The presliding that the recommended compensation has learned [rad]."""
        return float(self._memory[0]["observer"]["predictive"]["learned"]["presliding"])

    def watch(self, seconds: float) -> np.ndarray:
        """Continue, and return the estimates (n, 5)."""
        return self.run(seconds)[0]

    def run(self, seconds: float) -> tuple[np.ndarray, np.ndarray]:
        """Continue, and return estimates (n, 5) and true φ, φ̇, θ, θ̇ (n, 4)."""
        samples = round(seconds / DT)
        estimates, states = np.empty((samples, SIGNALS)), np.empty((samples, 4))
        _run(
            self._memory,
            self._torque,
            self._state,
            self._sent,
            self._noise,
            self._plant,
            self._system,
            estimates,
            states,
        )
        return estimates, states


@compiled
def _run(
    memory: np.ndarray,
    torque: np.ndarray,
    x: np.ndarray,
    sent: np.ndarray,
    generator: np.random.Generator,
    plant: TwoMasses,
    system: ControlSystem,
    estimates: np.ndarray,
    states: np.ndarray,
) -> None:
    control = memory[0]
    measurement, estimate, noise = np.empty(SIGNALS), np.empty(SIGNALS), np.empty(2)
    for k in range(len(estimates)):
        noise[0], noise[1] = generator.standard_normal(), generator.standard_normal()
        read_sensors(x, noise, plant, measurement)
        measurement[APPLIED_TORQUE] = torque[0]
        _, command = control_sample(control, measurement, system, estimate)
        for i in range(SIGNALS):
            estimates[k, i] = estimate[i]
        for i in range(4):
            states[k, i] = x[i]
        torque[0] = converted(command, VOLTAGE)
        move_plant(x, sent, torque[0], plant)


def swing(rig: LateRig, loop: Loop, seed: int) -> float:
    """The arm's swing [rad]."""
    _, states = RigLoop(rig, loop, (seed, RUN)).run(SECONDS)
    if not np.max(np.abs(states[:, THETA])) < pi / 2:
        return inf
    return float(np.ptp(states[-round(SETTLED / DT) :, 0]))


def tuned(rig: LateRig, loop: Loop, seed: int) -> Loop:
    """The loop with what tuning finds on the rig; as it is where the motion leaves the guard."""
    start = Compensation(loop.estimator, loop.observer, loop.controller)
    try:
        found = tune(RigLoop(rig, loop, (seed, TUNING)), start, TuningPlan(), lambda *_: None)
    except GuardError:
        return loop
    estimator, observer, controller = found.after.compensation
    return loop._replace(estimator=estimator, observer=observer, controller=controller)


def study(seed: int, settings: tuple[str, ...] = SETTINGS) -> dict[str, float]:
    """The swing [rad] of a rig with each of the settings."""
    rig = random_rig(seed)
    loops = {
        "none": lambda: furuta.make_loop({"compensation": "none"}),
        "right": lambda: loop_told(*rig.right),
        "wrong": lambda: loop_told(*rig.wrong),
        "untold": lambda: loop_told(0.0, 0.0),
        "tuned": lambda: tuned(rig, loop_told(*rig.wrong), seed),
    }
    return {name: swing(rig, loops[name](), seed) for name in settings}


def main() -> None:
    """Run the study and print a line for each rig, then tables and failures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--number", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="seed of the first rig")
    parser.add_argument(
        "--without", nargs="*", choices=SETTINGS[1:], default=[], help="settings to leave out"
    )
    given = parser.parse_args()
    settings = tuple(name for name in SETTINGS if name not in given.without)
    seeds = range(given.first, given.first + given.number)
    rigs, swings = [], []
    for seed in seeds:
        rigs.append(random_rig(seed))
        swings.append(study(seed, settings))
        values = ", ".join(f"{name} {_in_mrad(value)}" for name, value in swings[-1].items())
        print(f"{seed}: {rigs[-1].name}: {values}", flush=True)
    by_name = {name: np.array([each[name] for each in swings]) for name in settings}
    elastic = np.array([rig.elastic for rig in rigs])
    level = np.array([rig.level for rig in rigs])
    groups = {
        "all": np.ones(len(rigs), dtype=bool),
        "rigid": ~elastic,
        "elastic": elastic,
        "friction to 1": level <= 1.0,
        "friction 1 to 2": (level > 1.0) & (level <= 2.0),
        "friction beyond 2": level > 2.0,
    }
    for group, chosen in groups.items():
        if np.any(chosen):
            _print_table(group, {name: each[chosen] for name, each in by_name.items()})
    for name in settings[1:]:
        _print_failures(name, np.array(seeds), by_name[name], by_name["none"])


def _in_mrad(value: float) -> str:
    return "falls" if value == inf else f"{1e3 * value:.1f}"


def _print_table(group: str, swings: dict[str, np.ndarray]) -> None:
    none = swings["none"]
    print(f"{group}: {len(none)} rigs")
    print(f"{'':10}{'in a count':>12}{'median':>9}{'95 %':>9}{'falls':>7}{'alone':>7}{'worse':>7}")
    for name, each in swings.items():
        within = 100.0 * np.mean(each <= COUNT)
        median, most = (np.quantile(each, part, method="higher") for part in (0.5, 0.95))
        falls = np.sum(each == inf)
        alone = np.sum((each == inf) & (none < inf))
        worse = np.sum(is_worse(each, none))
        print(
            f"{name:10}{within:11.1f}%{_in_mrad(median):>9}{_in_mrad(most):>9}"
            f"{falls:7d}{alone:7d}{worse:7d}"
        )


def is_worse(swings: np.ndarray, none: np.ndarray) -> np.ndarray:
    """Whether a swing exceeds that without compensation by more than a count, or is a fall."""
    return (none < inf) & (swings > none + COUNT)


def _print_failures(name: str, seeds: np.ndarray, swings: np.ndarray, none: np.ndarray) -> None:
    falls, worse = (swings == inf) & (none < inf), is_worse(swings, none) & (swings < inf)
    print(f"{name} falls where none stands: {_listed(seeds[falls])}")
    print(f"{name} worse than none: {_listed(seeds[worse])}")


def _listed(seeds: np.ndarray) -> str:
    return " ".join(map(str, seeds)) or "nowhere"


if __name__ == "__main__":
    main()

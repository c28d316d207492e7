"""Does what `furuta axis` tells end the hunting? Axes of a plant that shares no code with it.

    tools/in_environment python benchmarks/hunting_axes.py --first 5000 --number 60

The axes are random: friction that truly sticks, with a Stribeck curve or none, PID or cascade, 2000
to 65536 counts, samples of 1 to 4 ms, delays of up to two samples, a filtered derivative that the
study knows or not, in every third a load of up to the Coulomb level, known to 10 %. Only those that
hunt by more than 6 counts are taken. servo_plant.py moves them.

Each change that is told runs from 10 starts over two decades, in two of which the integral is wound
up the wrong way, with friction 0.8, 1 and 1.25 times as large and with a sample more of delay. It
is false if one of these 40 runs moves in the second half, or leaves an error above the told one
after 1.1 times the told time. ``servo`` is the controller of simulation and export, which takes
its speed from the observer. A compensation is false if
the error is more than a fourth and half a count above the told one.
"""

import argparse
import time
from collections import defaultdict
from collections.abc import Iterator
from math import pi
from typing import Any, NamedTuple

import numpy as np
from servo_plant import Control, Truth, moved, run

import furuta
from furuta.axis.axis import NO_RULE, IntegralRule, without_integral
from furuta.axis.cures import HOLDING
from furuta.axis.servo import (
    ServoDesign,
    ServoMemory,
    design_servo,
    observer_parameters,
    paper_units,
    servo_sample,
)
from furuta_model.block import block, new_memory
from furuta_model.compiled import compiled

LEVELS, SMALLEST = (0.8, 1.0, 1.25), 6.0
STARTS = (0.2, -0.5, 1.0, -2.0, 4.0, -8.0, 14.0, -20.0, 0.7, -3.0)
# Of the last starts, so many have an integral that pushes the wrong way.
WOUND = 2
# Under the library's controller every so many of them is run.
EVERY = 4
# Shortest and longest run [s], and its length relative to the told time.
SHORTEST, LONGEST, LONGER = 60.0, 900.0, 2.0


class Drawn(NamedTuple):
    """An axis, what its study is told, and what is true beside: filter, known part of the load."""

    axis: furuta.Axis
    controller: furuta.Pid | furuta.Cascade
    counts: int
    sample_time: float
    delay: int
    filter_time: float
    load: float
    known: float

    @property
    def resolution(self) -> float:
        """A count [rad]."""
        return 2.0 * pi / self.counts

    def truth(self, level: float = 1.0) -> Truth:
        """The plant with friction of this level."""
        p, sticks = self.axis.friction, self.axis.law == "stiction"
        velocity = 0.0 if sticks else p.stribeck_velocity
        dry = level * p.alpha0, level * p.alpha1
        return Truth(self.axis.inertia, *dry, velocity, p.viscous, self.load)

    def control(self, controller: furuta.Pid | furuta.Cascade, rule: IntegralRule) -> Control:
        """Its own controller."""
        if isinstance(controller, furuta.Cascade):
            k, speed, integral = controller
            gains = speed * k, -speed, integral * k, -integral
        else:
            gains = controller.kp, -controller.kd, controller.ki, 0.0
        return Control(*gains, self.filter_time, *rule, self.known * self.load)


@compiled
def run_servo(
    a: Truth, p: np.ndarray, memory: np.ndarray, count: float, delay: int, start: float,
    out: np.ndarray,
) -> None:  # fmt: skip
    """The same under the library's sample of controller and compensation, a block."""
    q, v, dt = start, 0.0, p[0].dt
    for k in range(out.shape[1]):
        measured = count * np.floor(q / count + 0.5)
        sent = out[1, k - 1] if k > 0 else 0.0
        out[0, k] = q
        out[1, k] = servo_sample(memory[0], measured, sent, 0.0, 0.0, p[0])
        q, v = moved(q, v, out[1, k - delay] if k >= delay else a.load, dt, a)


class Seen(NamedTuple):
    """Of all runs: part that hunts or leaves more than was told, error [rad], last motion [s]."""

    false: float
    error: float
    seconds: float
    chatter: float


def drawn(seed: int) -> Drawn:
    """A random axis."""
    r = np.random.default_rng(seed)
    dt = float(r.choice([1e-3, 2e-3, 4e-3]))
    inertia, bandwidth = 10.0 ** r.uniform(-3.5, 1.0), min(10.0 ** r.uniform(0.6, 1.6), 0.1 / dt)
    damping = r.uniform(0.3, 1.2)
    kp, kd = inertia * bandwidth**2, 2.0 * damping * inertia * bandwidth
    ki = kp * bandwidth * r.uniform(0.05, 0.8) * damping
    coulomb = inertia * r.uniform(5.0, 60.0)
    added = coulomb * r.uniform(0.1, 1.0)
    velocity = added / (inertia * bandwidth) * 10.0 ** r.uniform(-2.0, 0.0)
    friction = furuta.Friction(
        alpha0=coulomb,
        alpha1=added,
        stribeck_velocity=velocity,
        viscous=inertia * r.uniform(0.1, 2.0),
    )
    law = "stribeck" if r.random() < 0.75 else "stiction"
    filter_time = max(2.0 * dt, 0.1 * kd / kp) * 2.0 ** r.uniform(-1.0, 1.0)
    told = filter_time if r.random() < 0.5 else 0.0
    controller: furuta.Pid | furuta.Cascade = furuta.Pid(kp, ki, kd, told)
    if r.random() < 0.25:
        controller = furuta.Cascade(kp / kd, kd, ki * kd / kp)
    load = coulomb * r.uniform(-1.0, 1.0) if r.random() < 1 / 3 else 0.0
    counts = round(2000.0 * 2.0 ** r.uniform(0.0, 5.034))
    about = round(r.uniform(-0.5, 2.5)), filter_time, load, r.uniform(0.9, 1.1)
    return Drawn(furuta.Axis(inertia, friction, law), controller, counts, dt, *about)


def runs(
    d: Drawn, seconds: float, every: int = 1
) -> Iterator[tuple[Truth, int, float, float, np.ndarray]]:
    """Plant, delay, start [rad], integral and place for the run of each of the 40 scenarios."""
    p, out = d.axis.friction, np.empty((2, round(seconds / d.sample_time)))
    held = (p.alpha0 + p.alpha1) / d.controller.stiffness
    scenarios = [(level, d.delay) for level in LEVELS] + [(1.0, d.delay + 1)]
    for level, delay in scenarios:
        for k, start in list(enumerate(STARTS))[delay % every :: every]:
            wound = k >= len(STARTS) - WOUND
            push = -np.sign(start) * p.alpha0 if wound else 0.0
            yield d.truth(level), delay, start * held + 0.37 * d.resolution, d.load - push, out


def length(seconds: float) -> float:
    """Time [s] of a run that must rest after so many."""
    return min(max(LONGER * seconds, SHORTEST), LONGEST)


def judged(d: Drawn, out: np.ndarray, error: float, seconds: float) -> Seen:
    """One run."""
    q, torque = out
    moving = np.flatnonzero(np.abs(np.diff(q)) > 1e-12)
    last = (moving[-1] + 1) * d.sample_time if len(moving) else 0.0
    rest = np.max(np.abs(q[min(round(1.1 * seconds / d.sample_time), len(q) // 2) :]))
    half = slice(len(q) // 2, None)
    chatter = float(np.sqrt(np.mean(np.diff(torque[half]) ** 2)))
    still = np.ptp(q[half]) <= 1e-12
    return Seen(float(not (still and rest <= error * (1.0 + 1e-9))), float(rest), last, chatter)


def worst(found: list[Seen]) -> Seen:
    """The part of false runs, and the largest of the others."""
    false, *others = zip(*found, strict=True)
    return Seen(float(np.mean(false)), *(float(max(each)) for each in others))


def checked(d: Drawn, gains: Any, rule: IntegralRule, error: float, seconds: float) -> Seen:
    """A change of the integral, under a controller of its own."""
    control, found = d.control(gains, rule), []
    for truth, delay, start, integral, out in runs(d, length(seconds)):
        begin = d.known * d.load if control.of_error == 0.0 else integral
        run(truth, control, d.resolution, d.sample_time, delay, start, begin, out)
        found.append(judged(d, out, error, seconds))
    return worst(found)


def hunts(d: Drawn) -> bool:
    """Whether the axis hunts as it is given, by more than the smallest cycle."""
    out, start = np.empty((2, round(SHORTEST / d.sample_time))), 5.0 * d.axis.friction.alpha0
    control = d.control(d.controller, NO_RULE)
    start /= d.controller.stiffness
    run(d.truth(), control, d.resolution, d.sample_time, d.delay, start, d.load, out)
    settled = out[0, out.shape[1] // 2 :]
    return bool(SMALLEST * d.resolution < np.ptp(settled) < start)


def as_servo(
    d: Drawn, gains: Any, rule: IntegralRule, compensation: str, error: float, seconds: float
) -> Seen:
    """A change or compensation, under the library's controller."""
    units = paper_units(d.axis, gains)
    parameters = observer_parameters(
        d.axis, units, compensation, d.resolution, d.sample_time, d.delay * d.sample_time
    )
    parameters = parameters._replace(axis=parameters.axis._replace(offset=d.known * d.load))
    design: ServoDesign = design_servo(gains, parameters, rule)
    found = []
    every = EVERY if compensation == "none" else 1
    for truth, delay, start, integral, out in runs(d, length(seconds), every):
        memory = new_memory(ServoMemory)
        memory[0]["integral"] = integral
        run_servo(truth, block(design), memory, d.resolution, delay, start, out)
        found.append(judged(d, out, error, seconds))
    return worst(found)


def main() -> None:
    """A line for each axis and change, then the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--number", type=int, default=5, help="of hunting axes")
    asked = parser.parse_args()
    costs: list[float] = []
    rows, advised, seed = defaultdict(list), 0, asked.first
    while len(costs) < asked.number:
        d = drawn(seed)
        seed += 1
        if not hunts(d):
            continue
        begin = time.process_time()
        study = furuta.study_axis(
            d.axis,
            d.controller,
            counts=d.counts,
            sample_time=d.sample_time,
            delay=d.delay * d.sample_time,
        )
        costs.append(time.process_time() - begin)
        cycle = study.cycle.peak_to_peak
        print(f"{seed - 1} {d.axis.law} cycle {cycle / d.resolution:.0f} counts, {costs[-1]:.1f} s")
        advised += study.advice is not None
        for cure in study.cures or ():
            told = cure.error, cure.seconds
            for kind in ("", "servo: "):
                seen = (
                    as_servo(d, cure.controller, cure.rule, "none", *told)
                    if kind
                    else checked(d, cure.controller, cure.rule, *told)
                )
                rows[kind + cure.name].append((d, cycle, *told, seen))
        for each in study.comparison.residuals if study.comparison else ():
            if each.worth and each.compensation == "recommended":
                gains = d.controller if each.integral else without_integral(d.controller)
                rule, name = (NO_RULE, "PID") if each.integral else (HOLDING, "PD")
                most = 1.25 * each.error_rad + 0.5 * d.resolution
                seen = as_servo(d, gains, rule, "recommended", most, 25.0)
                seen = seen._replace(false=float(seen.error > most))
                rows[f"{name} + recommended"].append((d, cycle, each.error_rad, 0.0, seen))
        for name, found in rows.items():
            if found[-1][0] is d:
                _, _, error, seconds, seen = found[-1]
                print(
                    f"  {name:34} told {error / d.resolution:8.1f} "
                    f"seen {seen.error / d.resolution:8.1f} "
                    f"after {seconds:7.2f} {seen.seconds:7.2f} s, false {seen.false:.3f}",
                    flush=True,
                )
    print(
        f"\n{advised} of {len(costs)} axes get advice; CPU {np.median(costs):.1f} s in the median"
    )
    print(f"and {max(costs):.1f} s at most. Medians and largest; errors in counts.\n")
    print("| change | axes | false | told | seen | told, of the cycle | told [s] | seen [s] |")
    print("|---|---|---|---|---|---|---|---|")
    for name, found in rows.items():
        table = np.array(
            [
                (e / d.resolution, s.error / d.resolution, e / cycle, t, s.seconds)
                for d, cycle, e, t, s in found
            ]
        )
        middle, most = np.median(table, axis=0), np.max(table, axis=0)
        false = sum(s.false > 0.0 for *_, s in found)
        cells = [f"{m:.3g}; {w:.3g}" for m, w in zip(middle, most, strict=True)]
        print(f"| {name} | {len(found)} | {false} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()

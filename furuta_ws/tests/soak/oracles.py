"""The oracles: pure functions that return what is wrong, or an empty string.

Three kinds: physics, what the documentation specifies, and agreement of two ways to compute the
same. :data:`ORACLES` lists them.
"""

import re
from collections.abc import Mapping, Sequence
from math import isfinite, pi
from typing import Any

import numpy as np

from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum, energy
from furuta_model.state import PHI
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant import Plant, initial_plant, move

ORACLES = {
    "energy": "physics: the energy of pendulum and arm does not grow without drive",
    "bounds": "physics: the state is finite and the arm stays within its travel",
    "friction limit": "physics: |F̂| does not exceed the limit of its compensator",
    "hanging": "physics: a hanging pendulum is not driven",
    "unarmed": "physics: a rig that is not armed is not driven",
    "watchdog": "specification: 0 V in time after a node is silent",
    "answers": "specification: 0 V within the watchdog after the sample that was answered last",
    "arming": "specification: a rig is armed on request only",
    "stranger": "specification: no command of a second publisher is applied",
    "second graph": "specification: it ends with the reason, or runs in a namespace of its own",
    "refusal": "specification: invalid input is refused, valid input is not",
    "unchanged": "specification: a refused change leaves every parameter as it was",
    "output": "specification: what a node publishes is finite and within its limit",
    "survival": "specification: a node runs on, or gives one line with the reason",
    "recovery": "specification: the loop continues after an intrusion, and a reset balances it",
    "graph = simulation": "agreement: lock-step gives the simulation without ROS to the last bit",
    "twin": "agreement: refused messages leave a node as a twin that never received them",
    "rig = simulation": "agreement: the emulated rig moves as the simulated plant, to the last bit",
    "flat": "resources: memory, open files and threads of a process do not grow",
}

# Arm angle beyond which it is out of control [rad]: the limit of 2π, and the way to coast to rest.
ARM_TRAVEL = 100.0
# Angle from upright beyond which the pendulum has fallen [rad]: beyond every fall angle in use.
FALLEN = 0.5 * pi
# Time from the fall until the command must be 0 V [s]: the potentiometer's range ends earlier.
FALL_GRACE = 0.05
# Relative error of the energy that the integration may cause.
ENERGY_ERROR = 1e-3
# Growth of a process that counts as flat: memory [MB], open files, threads.
FLAT_MEMORY, FLAT_FILES, FLAT_THREADS = 16.0, 4, 4
# Fraction of a series at its begin that does not count, while caches fill.
WARM_UP = 0.3


def energy_growth(
    states: np.ndarray,
    volts: np.ndarray,
    model: FurutaPendulum,
    friction: Friction,
) -> str:
    """States (n, 4), ``volts`` (n,) applied after each of them; the bristle may give back its own.

    The energy within a stretch without drive may not exceed that at its begin.
    """
    stored = highest_level(friction) ** 2 / (2.0 * friction.sigma0)
    limit = np.inf
    for k in range(len(states)):
        now = energy(states[k], model)
        allowed = limit + stored + ENERGY_ERROR * (abs(limit) + model.delta)
        if now > allowed:
            return f"energy {now:.6g} V rad at sample {k}, was {limit:.6g} before, without drive"
        # The energy at the begin of a stretch bounds it until the next drive.
        limit = min(limit, now) if volts[k] == 0.0 else np.inf
    return ""


def out_of_bounds(states: np.ndarray) -> str:
    """States (n, 4) must be finite, and the arm within :data:`ARM_TRAVEL`."""
    if not np.all(np.isfinite(states)):
        return f"a state is not finite: {states[~np.isfinite(states).all(axis=1)][0]}"
    farthest = float(np.max(np.abs(states[:, PHI]), initial=0.0))
    return f"the arm reached {farthest:.1f} rad" if farthest > ARM_TRAVEL else ""


def beyond_friction_limit(estimate: float, limit: float) -> str:
    """|F̂| [V] must not exceed ``limit`` [V], to rounding."""
    if abs(estimate) <= limit * (1.0 + 1e-9):
        return ""
    return f"friction estimate {estimate!r} V, limit {limit:g} V"


def hanging_drive(theta: np.ndarray, volts: np.ndarray, sample_time: float) -> str:
    """True θ (n,) and the torque or command (n,) [V] of the same samples.

    Beyond :data:`FALLEN` for :data:`FALL_GRACE` the command must be 0 V until it is upright again.
    """
    upright = np.abs(np.remainder(theta + pi, 2 * pi) - pi) <= FALLEN
    grace = round(FALL_GRACE / sample_time)
    fallen = 0
    for k in range(len(theta)):
        fallen = 0 if upright[k] else fallen + 1
        if fallen > grace and volts[k] != 0.0:
            driven = int(np.count_nonzero(volts[k + 1 - fallen : k + 1]))
            return f"{volts[k]:g} V at sample {k}, {fallen} samples after the fall, {driven} driven"
    return ""


def unarmed_drive(volts: np.ndarray, armed: np.ndarray, requests: int) -> str:
    """Voltage [V] up to each sample of a rig, its arming after the sample, and requests to arm.

    A rig that is armed and stopped within one sample is driven in it. The log shows no arming then,
    so there may be as many such samples as requests without a visible arming.
    """
    armed_before = np.concatenate(([0.0], armed[:-1]))
    wrong = int(np.sum((volts != 0.0) & (armed == 0.0) & (armed_before == 0.0)))
    if wrong <= max(0, requests - _armings(armed)):
        return ""
    return f"{wrong} samples with a voltage while not armed, {requests} requests to arm"


def _armings(armed: np.ndarray) -> int:
    """How often a rig was armed, by its arming sample by sample."""
    return int(np.sum(np.diff(armed.astype(int), prepend=0) > 0))


def unanswered_drive(
    volts: np.ndarray, sample: np.ndarray, answered: np.ndarray, watchdog: int
) -> str:
    """Voltage [V] up to each sample of a rig, and which sample was answered last.

    The watchdog is checked at each sample, before the next one is driven: nothing depends on how
    busy the machine is.
    """
    age = (sample - answered) % 2**32
    wrong = (volts != 0.0) & (age > watchdog)
    if not np.any(wrong):
        return ""
    return f"driven {np.max(age[wrong]):.0f} samples after the last answer, watchdog {watchdog}"


def late_stop(
    time: np.ndarray, volts: np.ndarray, silent: float, back: float, allowed: float
) -> str:
    """The voltage from ``silent + allowed`` until the host is ``back`` must be 0 V; all in ns."""
    after = (time > silent + allowed) & (time < back)
    driven = after & (volts != 0.0)
    if not np.any(driven):
        return ""
    last = (float(time[driven][-1]) - silent) / 1e6
    return f"driven {last:.1f} ms after the host was silent, allowed {allowed / 1e6:.1f} ms"


def armed_without_request(armed: np.ndarray, requests: int) -> str:
    """A rig's arming, sample by sample, and the number of requests to arm."""
    armings = _armings(armed)
    return f"armed {armings} times, {requests} requests" if armings > requests else ""


def applied(volts: np.ndarray, strange: float, resolution: float = 0.0) -> str:
    """Voltages [V] that were applied (n,), and the one that only a second publisher sends.

    A controller may pass it by chance: with the ``resolution`` of a rig's line [V] it counts when
    it is applied three times in a row.
    """
    same = np.abs(volts - strange) <= resolution
    if resolution:
        same = same[2:] & same[1:-1] & same[:-2]
    return f"{np.sum(same)} samples with {strange:g} V of a second publisher" if same.any() else ""


def wrong_second_graph(status: int, out: str, alone: bool) -> str:
    """How a graph of 2 s ended that was started beside another one, ``alone`` in its namespace."""
    if alone:
        complete = status == 0 and out.startswith("2000 samples")
    else:
        complete = status == 1 and "a graph already runs" in out
    return "" if complete else f"status {status}: {out.strip()[-200:]}"


def wrong_refusal(should_refuse: bool | None, refused: bool, given: Any) -> str:
    """``should_refuse`` is None where both are correct."""
    if should_refuse is None or should_refuse == refused:
        return ""
    return f"{'accepted' if should_refuse else 'refused'}: {given!r}"[:300]


def changed_parameters(before: Mapping[str, Any], after: Mapping[str, Any]) -> str:
    """The parameters before and after a refused change."""
    names = [name for name in before if repr(before[name]) != repr(after.get(name))]
    return f"a refused change set {', '.join(names)}" if names else ""


def bad_output(value: float, limit: float) -> str:
    """A published value [V] must be finite and within ``limit`` [V]."""
    if isfinite(value) and abs(value) <= limit * (1.0 + 1e-9):
        return ""
    return f"published {value!r}, limit {limit:g}"


def unexplained_end(status: int | None, log: str) -> str:
    """Status (None: it runs) and log of a process that nobody ended."""
    if "Traceback" in log:
        return f"traceback: {log.strip().splitlines()[-1][:200]}"
    if status is None or re.search(r"^error: .+", log, re.MULTILINE):
        return ""
    return f"ended with status {status} without a reason"


def not_recovered(happened: bool, what: str, seconds: float) -> str:
    """Whether what the loop must do after an intrusion has happened in time."""
    return "" if happened else f"{what}: not within {seconds:g} s"


def different_run(samples: Sequence[int], got: np.ndarray, expected: np.ndarray) -> str:
    """Rows of ``got`` belong to the numbered samples of ``expected``; equal to the last bit."""
    if len(samples) and samples[-1] >= len(expected):
        return f"sample {samples[-1]} of a run of {len(expected)}"
    wrong = np.flatnonzero(np.any(got != expected[list(samples)], axis=1))
    if not len(wrong):
        return ""
    return f"{len(wrong)} of {len(samples)} samples differ, the first is {samples[wrong[0]]}"


def different_value(got: Any, expected: Any) -> str:
    """Two computations of one thing; NaN equals NaN."""
    return "" if repr(got) == repr(expected) else f"{got!r} instead of {expected!r}"[:300]


def different_motion(
    states: np.ndarray, volts: np.ndarray, plant: Plant, given: PlantParameters
) -> str:
    """Replay the log of an emulated rig from each moment at which it was held.

    ``volts`` (n,) were applied up to each of the states (n, 4).
    """
    start = initial_plant(given)
    memory: np.ndarray | None = None
    for k in range(len(states)):
        if np.array_equal(states[k], start["x"][0, :4]):
            memory = start.copy()
            continue
        if memory is not None:
            move(memory[0], volts[k], plant)
        if memory is None or not np.array_equal(states[k], memory["x"][0, :4]):
            # A rig that is driven while it is put upright moves at once.
            memory = start.copy()
            move(memory[0], volts[k], plant)
            if not np.array_equal(states[k], memory["x"][0, :4]):
                return f"row {k}: {states[k]}, neither continued nor begun anew"
    return ""


def growth(series: Sequence[Mapping[str, float]]) -> str:
    """Samples of the resources of a process: ``memory`` [MB], ``files``, ``threads``."""
    kept = series[round(WARM_UP * len(series)) :]
    third = len(kept) // 3
    if third < 2:
        return ""
    problems = []
    limits = (("memory", FLAT_MEMORY), ("files", FLAT_FILES), ("threads", FLAT_THREADS))
    for name, limit in limits:
        first, last = (np.median([s[name] for s in part]) for part in (kept[:third], kept[-third:]))
        if last - first > limit:
            problems.append(f"{name} grew from {first:g} to {last:g}")
    return "; ".join(problems)


def fallen(theta: float) -> bool:
    """Whether the pendulum has fallen."""
    return abs((theta + pi) % (2 * pi) - pi) > FALLEN

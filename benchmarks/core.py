"""Speed and error of the loop without ROS, compared with MuJoCo and scipy.

The simulators are measured in alternation, so that they meet the same load on the machine.
"""

from statistics import median
from time import thread_time

import numpy as np
from batches import ideal_batch_rate
from experiment import (
    LOOP,
    RELEASE,
    SECONDS,
    STEP,
    accurate_limit_cycle,
    simulated_limit_cycle,
    state_rate,
)
from mujoco_loop import MujocoLoop
from scipy.integrate import solve_ivp

from furuta.outcomes import outcome

ROUNDS = 7
# Pendulum time for the slow simulators [s].
SOLVER_SECONDS = 5.0
START = np.array([0.0, 0.0, RELEASE, 0.0, 0.0])
TOLERANCES = {"rtol": 1e-6, "atol": 1e-9}


def speed() -> dict[str, float]:
    """Samples per second of one core's CPU time, and the median of the ratios of all rounds."""
    mujoco = MujocoLoop()
    others = {
        "mujoco_python": mujoco.rate,
        "mujoco_python_tuned": mujoco.tuned_rate,
        "mujoco_c": mujoco.c_rate,
        "scipy": _scipy_rate,
    }
    outcome(LOOP, 1.0)  # loads the compiled code
    ideal_batch_rate()
    ours: list[float] = []
    batches: list[float] = []
    theirs: dict[str, list[float]] = {name: [] for name in others}
    for _ in range(ROUNDS):
        ours.append(_our_rate())
        batches.append(ideal_batch_rate())
        for name, measure in others.items():
            theirs[name].append(measure())
    ratios = {
        f"core_vs_{name}": median(a / b for a, b in zip(ours, rates, strict=True))
        for name, rates in theirs.items()
    }
    ratios["batch_vs_mujoco_python"] = median(
        a / b for a, b in zip(batches, theirs["mujoco_python"], strict=True)
    )
    rates = {f"{name}_samples_per_s": median(rates) for name, rates in theirs.items()}
    return ratios | {"core_samples_per_s": median(ours)} | rates


def errors() -> dict[str, float]:
    """Relative errors of the amplitude at a step of 1 ms against an accurate solution."""
    reference = accurate_limit_cycle()
    measured = {
        "amplitude_error": simulated_limit_cycle(),
        "amplitude_error_mujoco": MujocoLoop().limit_cycle(),
        "amplitude_error_mujoco_rk4": MujocoLoop("RK4").limit_cycle(),
    }
    return {
        name: abs(cycle.phi_peak_to_peak_rad / reference.phi_peak_to_peak_rad - 1.0)
        for name, cycle in measured.items()
    }


def _our_rate() -> float:
    start = thread_time()
    steps = outcome(LOOP, SECONDS).steps
    return steps / (thread_time() - start)


def _scipy_rate() -> float:
    """LSODA with continuous feedback; held feedback would restart the solver every millisecond."""
    times = np.arange(0.0, SOLVER_SECONDS, STEP)
    start = thread_time()
    solution = solve_ivp(
        state_rate, (0.0, SOLVER_SECONDS), START, method="LSODA", t_eval=times, **TOLERANCES
    )
    return len(solution.t) / (thread_time() - start)

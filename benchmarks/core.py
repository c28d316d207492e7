"""Speed and error of the loop without ROS, compared with MuJoCo, scipy and python-control.

The simulators are measured in alternation, so that they meet the same load on the machine.
"""

import warnings
from statistics import median
from time import thread_time

import control
import numpy as np
from batches import ideal_batch_rate
from experiment import (
    FEEDBACK,
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

from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.oscillation import Oscillation
from furuta.outcomes import outcome
from furuta_model.friction.laws import friction_law

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
        "python_control": _control_rate,
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
    """Relative errors of the limit cycle at a step of 1 ms against an accurate solution."""
    reference = accurate_limit_cycle()
    law = friction_law("lugre", LOOP.plant.friction.parameters)
    l1, l2, l3, l4 = FEEDBACK
    exact = limit_cycle(IdealLoop(LOOP.plant.model, law, l1, l2, l3, l4))
    results = {
        "reference_amplitude_rad": reference.phi_peak_to_peak_rad,
        "reference_period_s": reference.period_s,
        "continuous_amplitude_rad": exact.phi_peak_to_peak_rad,
        "continuous_period_s": exact.period_s,
    }
    for name, measured in {
        "": simulated_limit_cycle(),
        "_mujoco": MujocoLoop().limit_cycle(),
        "_mujoco_rk4": MujocoLoop("RK4").limit_cycle(),
    }.items():
        amplitude, period = _error(measured, reference)
        results |= {f"amplitude_error{name}": amplitude, f"period_error{name}": period}
    return results


def _error(measured: Oscillation, reference: Oscillation) -> tuple[float, float]:
    """Relative errors of amplitude and period."""
    return (
        abs(measured.phi_peak_to_peak_rad / reference.phi_peak_to_peak_rad - 1.0),
        abs(measured.period_s / reference.period_s - 1.0),
    )


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


def _control_rate() -> float:
    """The same closed loop in python-control, with the same solver and tolerances."""
    system = control.nlsys(lambda t, x, u, _: state_rate(t, x), None, inputs=1, outputs=5, states=5)
    times = np.arange(0.0, SOLVER_SECONDS, STEP)
    start = thread_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        response = control.input_output_response(
            system, times, 0, START, solve_ivp_method="LSODA", solve_ivp_kwargs=TOLERANCES
        )
    return len(response.time) / (thread_time() - start)

"""Speed and error of the loop without ROS, beside MuJoCo, scipy and python-control, in turns."""

from __future__ import annotations

import warnings
from statistics import median
from time import thread_time

import control
import numpy as np
from experiment import (
    FEEDBACK,
    LOOP,
    RELEASE,
    SECONDS,
    STEP,
    cycle_of_ours,
    rate,
    tight_reference,
)
from mujoco_loop import MujocoLoop
from scipy.integrate import solve_ivp

from furuta_analysis.limit_cycles.ideal_loop import IdealLoop
from furuta_analysis.limit_cycles.limit_cycle import limit_cycle
from furuta_analysis.simulation.closed_loop import outcome
from furuta_analysis.simulation.oscillation import Oscillation
from furuta_model.friction.laws import friction_law

TURNS = 7
SOLVER_SECONDS = 5.0  # of the pendulum, for the slow ones
START = np.array([0.0, 0.0, RELEASE, 0.0, 0.0])
TOLERANCES = {"rtol": 1e-6, "atol": 1e-9}


def speed() -> dict[str, float]:
    """Samples per second of one core's CPU time, and the median of the ratios turn by turn."""
    mujoco = MujocoLoop()
    rivals = {
        "mujoco_python": mujoco.rate,
        "mujoco_python_tuned": mujoco.tuned_rate,
        "mujoco_c": mujoco.c_rate,
        "scipy": _scipy_rate,
        "python_control": _control_rate,
    }
    outcome(LOOP, 1.0)  # loaded
    ours: list[float] = []
    theirs: dict[str, list[float]] = {name: [] for name in rivals}
    for _ in range(TURNS):
        ours.append(_our_rate())
        for name, measure in rivals.items():
            theirs[name].append(measure())
    ratios = {
        f"core_vs_{name}": median(a / b for a, b in zip(ours, rates, strict=True))
        for name, rates in theirs.items()
    }
    rates = {f"{name}_samples_per_s": median(rates) for name, rates in theirs.items()}
    return ratios | {"core_samples_per_s": median(ours)} | rates


def errors() -> dict[str, float]:
    """Relative errors of the limit cycle at a step of 1 ms against the tight reference."""
    reference = tight_reference()
    law = friction_law("lugre", LOOP.plant.friction.parameters)
    l1, l2, l3, l4 = FEEDBACK
    exact = limit_cycle(IdealLoop(LOOP.plant.model, law, l1, l2, l3, l4))
    figures = {
        "reference_amplitude_rad": reference.phi_peak_to_peak_rad,
        "reference_period_s": reference.period_s,
        "continuous_amplitude_rad": exact.phi_peak_to_peak_rad,
        "continuous_period_s": exact.period_s,
    }
    for name, found in {
        "": cycle_of_ours(),
        "_mujoco": MujocoLoop().cycle(),
        "_mujoco_rk4": MujocoLoop("RK4").cycle(),
    }.items():
        amplitude, period = _error(found, reference)
        figures |= {f"amplitude_error{name}": amplitude, f"period_error{name}": period}
    return figures


def _error(found: Oscillation, reference: Oscillation) -> tuple[float, float]:
    """Relative errors of amplitude and period."""
    return (
        abs(found.phi_peak_to_peak_rad / reference.phi_peak_to_peak_rad - 1.0),
        abs(found.period_s / reference.period_s - 1.0),
    )


def _our_rate() -> float:
    began = thread_time()
    steps = outcome(LOOP, SECONDS).steps
    return steps / (thread_time() - began)


def _scipy_rate() -> float:
    """LSODA under continuous feedback: held for 1 ms it would start anew for every sample."""
    times = np.arange(0.0, SOLVER_SECONDS, STEP)
    began = thread_time()
    solution = solve_ivp(
        rate, (0.0, SOLVER_SECONDS), START, method="LSODA", t_eval=times, **TOLERANCES
    )
    return len(solution.t) / (thread_time() - began)


def _control_rate() -> float:
    """The same closed loop through python-control, with the same solver and tolerances."""
    system = control.nlsys(lambda t, x, u, _: rate(t, x), None, inputs=1, outputs=5, states=5)
    times = np.arange(0.0, SOLVER_SECONDS, STEP)
    began = thread_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        response = control.input_output_response(
            system, times, 0, START, solve_ivp_method="LSODA", solve_ivp_kwargs=TOLERANCES
        )
    return len(response.time) / (thread_time() - began)

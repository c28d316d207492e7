"""The final motion agrees with a long simulation, for known hard cases and for random loops.

``FURUTA_RANDOM_LOOPS=500`` tries 500 random loops instead of a few.
"""

import os

import numpy as np
import pytest
import reference

from furuta.limit_cycles.continuation import Branch
from furuta.limit_cycles.limit_cycle import limit_cycle, state_at_rest
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import LimitCycle
from furuta.limit_cycles.rest_stability import rest_stability
from furuta.loops import ideal_loop
from furuta.outcomes import Outcome, outcome
from furuta.settings.settings import load_settings, loop
from furuta_model.parameters import ParameterError
from furuta_model.state import THETA

# Laws of the random loops.
ANALYSED = ("coulomb", "stiction", "stribeck", "lugre")
RANDOM_LOOPS = int(os.environ.get("FURUTA_RANDOM_LOOPS", "6"))
# Half a period of the slowest motion of the random loops, several times.
SIMULATED = 60.0  # [s]
LONGEST = 1000.0  # [s], if the kinds differ after the first time
SAMPLE_TIME = 1e-4  # [s]
IDEAL = (
    "sensors.ideal=true",
    f"sample_time={SAMPLE_TIME}",
    "actuator.bits=0",
    "actuator.voltage_range=1000",
    "voltage_limit=1000",
    "controller.arm_angle_limit=1e6",
    "controller.arm_error_limit=1e6",
    "controller.arm_speed_limit=1e6",
    # A disturbance of the torque, too small to matter but where a rest is unstable.
    "excitation.kind=sine",
    "excitation.amplitude=1e-8",
    "excitation.period=1.7",
    "excitation.excursion_limit=1000",
    "excitation.speed_limit=1000",
)
Gains = tuple[float, float, float, float]


def ideal(*assignments: str, law: str | None = None, feedback: Gains | None = None) -> IdealLoop:
    """The ideal loop."""
    return ideal_loop(loop(load_settings([], assignments)), {}, law, feedback)


def exact(*assignments: str, feedback: Gains | None = None) -> LimitCycle:
    """The final motion of the ideal loop."""
    return limit_cycle(ideal(*assignments, feedback=feedback))


def simulated(seconds: float, *assignments: str) -> Outcome:
    """The same loop, simulated with perfect sensors and a short sample time."""
    return outcome(loop(load_settings((), [*IDEAL, *assignments])), seconds)


def kind(run: Outcome) -> str:
    """Kind of the motion in the last half of a run."""
    if run.fell or not np.isfinite(run.phi_peak_to_peak_rad):
        return "unbounded"
    return "rest" if run.phi_peak_to_peak_rad < 1e-4 else "limit_cycle"


def test_an_unstable_rest_is_left() -> None:
    """The arm creeps to an unstable rest: it moves to and fro, with pauses set by disturbances."""
    motion = exact("zeta1=1.25")
    assert motion.kind == "limit_cycle"
    assert motion.period_s == np.inf
    run = simulated(200.0, "zeta1=1.25")
    assert motion.phi_peak_to_peak_rad == pytest.approx(run.phi_peak_to_peak_rad, rel=0.01)
    assert motion.growth_rate_1_s == pytest.approx(4.92, abs=0.005)


def test_growth_rate_at_rest_is_that_of_a_disturbance() -> None:
    """Independent integration leaves the rest at the rate of the eigenvalue, on the side of it."""
    given = ideal("zeta1=1.25")
    p = given.law.parameters
    rest = np.array([0.22, 0.0, 0.0, 0.0, given.l1 * 0.22 / p.sigma0])
    stability = rest_stability(rest, given)
    (direction,) = stability.directions
    start, gains = rest + 1e-4 * direction, np.array(given.gains)
    tilts = [
        reference.closed_loop(start, gains, seconds, given.body, p)[-1][THETA]
        for seconds in (0.3, 0.5)
    ]
    assert np.log(tilts[1] / tilts[0]) / 0.2 == pytest.approx(stability.growth_rate, rel=0.01)


@pytest.mark.parametrize("law", ["coulomb", "stiction"])
def test_a_stuck_arm_at_rest_is_unstable(law: str) -> None:
    """It leaves the upright rest with √(δ/β), whatever the feedback, and ends in the cycle."""
    stuck = ideal(law=law)
    assert rest_stability(np.zeros(5), stuck).growth_rate == pytest.approx(
        np.sqrt(stuck.body.delta / stuck.body.beta)
    )
    released = limit_cycle(stuck)
    from_rest = limit_cycle(stuck, np.zeros(5))
    assert from_rest.phi_peak_to_peak_rad == pytest.approx(released.phi_peak_to_peak_rad, rel=1e-6)


def test_a_branch_ends_where_its_period_grows_without_bound() -> None:
    """Over ζ₁ the cycle comes ever closer to an unstable rest, at 1.1654."""
    branch = Branch(lambda zeta1: ideal(f"zeta1={zeta1!r}"), 1.1, 1.5)
    points = branch.follow(1.15, exact("zeta1=1.15"))
    assert [point.event for point in (points[0], points[-1])] == ["end", "homoclinic"]
    assert points[0].value == 1.1
    assert points[-1].value == pytest.approx(1.16545, abs=1e-4)
    assert points[-1].cycle.period_s > 1.5 * points[0].cycle.period_s
    with pytest.raises(ParameterError, match="period is infinite"):
        branch.follow(1.25, exact("zeta1=1.25"))


def random_settings(random: np.random.Generator) -> list[str]:
    """Assignments of a random rig, friction law and pole placement."""

    def between(low: float, high: float) -> float:
        return float(low * (high / low) ** random.random())

    alpha, beta = between(0.01, 0.2), between(0.005, 0.05)
    level = between(0.02, 0.5)
    values = {
        "alpha": alpha,
        "beta": beta,
        "gamma": random.uniform(0.2, 0.8) * np.sqrt(alpha * beta),
        "delta": between(0.1, 2.0),
        "alpha0": level,
        "alpha1": level * random.uniform(0.0, 0.6),
        "sigma0": level * between(3.0, 1000.0),
        "stribeck_velocity": between(0.01, 0.2),
        "viscous": random.choice([0.0, between(1e-3, 0.1)]),
        "asymmetry": random.choice([0.0, random.uniform(-0.6, 0.6)]),
        "omega1": between(2.0, 12.0),
        "zeta1": random.uniform(0.3, 1.5),
        "omega2": between(2.0, 12.0),
        "zeta2": random.uniform(0.3, 1.5),
        "initial.theta": between(0.002, 0.05),
    }
    values["sigma1"] = between(0.1, 1.0) * 2.0 * np.sqrt(values["sigma0"] * alpha)
    law = random.choice(ANALYSED, p=[0.1, 0.1, 0.1, 0.7])
    return [*(f"{name}={float(value)!r}" for name, value in values.items()), f"friction.law={law}"]


def test_kinds_of_random_loops() -> None:
    random = np.random.default_rng(12)
    for number in range(RANDOM_LOOPS):
        given = random_settings(random)
        check_agreement(given, f"loop {number}: {' '.join(given)}")


def check_agreement(given: list[str], name: str) -> None:
    """Compare the exact motion from the release in ``given`` with the simulation."""
    release = next(float(text.split("=")[1]) for text in given if text.startswith("initial.theta"))
    try:
        motion = limit_cycle(ideal(*given), state_at_rest(release))
    except ParameterError as error:
        pytest.fail(f"{name}: {error}")
    for seconds in (SIMULATED, LONGEST):
        run = simulated(seconds, *given)
        if kind(run) == motion.kind and _same_size(motion, run):
            return
    pytest.fail(
        f"{name}: exact {motion.kind} {motion.phi_peak_to_peak_rad:.6g} rad, "
        f"{motion.period_s:.6g} s; simulated {kind(run)} {run.phi_peak_to_peak_rad:.6g} rad, "
        f"{run.period_s:.6g} s"
    )


def _same_size(motion: LimitCycle, run: Outcome) -> bool:
    if motion.kind != "limit_cycle" or not np.isfinite(motion.period_s):
        return True  # without a period, the disturbance decides where the arm pauses
    # Close to a rest, disturbances by the sampling decide the motion.
    tolerance = 0.02 if motion.rest_distance > 1e-4 else 0.3
    return abs(run.phi_peak_to_peak_rad / motion.phi_peak_to_peak_rad - 1.0) < tolerance

"""Exact periodic motions, compared with independent integration and known properties."""

import numpy as np
import pytest
import reference
from joint_reference import ReferenceJoint

from furuta.limit_cycles.continuation import Branch, BranchPoint, fold_value
from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import trace
from furuta.loops import LACKS, ideal_loop, left_out, make_loop
from furuta_model.friction.laws import FrictionLaw, friction_law
from furuta_model.friction.parameters import Friction
from furuta_model.linear import DesiredPoles, linearize, place_poles
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum

BODY = FurutaPendulum()
PAPER = Friction()


def ideal(
    lugre: Friction = PAPER, kind: str = "lugre", linear: bool = False, **poles: float
) -> IdealLoop:
    """The loop with the poles of the paper by default."""
    return IdealLoop(BODY, friction_law(kind, lugre), *_gain(**poles), linear)


def _gain(**poles: float) -> tuple[float, ...]:
    return tuple(float(-gain) for gain in place_poles(BODY, DesiredPoles(**poles)))


def test_values_of_the_paper() -> None:
    cycle = limit_cycle(ideal())
    assert cycle.kind == "limit_cycle"
    assert cycle.stable
    assert cycle.phi_peak_to_peak_rad == pytest.approx(0.5106, rel=5e-4)
    assert cycle.theta_peak_to_peak_rad == pytest.approx(0.0918, abs=0.00005)
    assert cycle.period_s == pytest.approx(2.370, rel=5e-4)


SETS = {
    "asymmetry": (Friction(asymmetry=0.3), {}),
    "soft bristle": (Friction(sigma0=20.0, sigma1=0.4), {"omega1": 9.0}),
    "all, other poles": (
        Friction(alpha0=0.3, alpha1=0.1, asymmetry=-0.2, viscous=0.03, stribeck_velocity=0.2),
        {"omega1": 6.0, "zeta1": 0.9, "omega2": 4.0},
    ),
}


@pytest.mark.parametrize("name", SETS)
def test_independent_integration_closes_the_orbit(name: str) -> None:
    """Radau on the plain equations returns after the period with the same amplitudes, to 0.01 %."""
    lugre, poles = SETS[name]
    loop = ideal(lugre, **poles)
    cycle = limit_cycle(loop)
    assert cycle.kind == "limit_cycle"
    gains = np.array(_gain(**poles))
    start = np.array(cycle.point)
    path = reference.closed_loop(start, gains, cycle.period_s, BODY, lugre)
    scale = np.array([1, 1, 1, 1, 1 / lugre.sigma0]) * cycle.phi_peak_to_peak_rad
    assert np.abs((path[-1] - start) / scale).max() < 1e-4
    assert np.ptp(path[:, 0]) == pytest.approx(cycle.phi_peak_to_peak_rad, rel=1e-4)
    assert np.ptp(path[:, 2]) == pytest.approx(cycle.theta_peak_to_peak_rad, rel=1e-4)


def test_stuck_arm_stands_still_and_breaks_away_at_the_level() -> None:
    """While stuck the holding force is within the breakaway level, and it ends at the level."""
    loop = ideal(Friction(alpha1=0.1), "stiction")
    motion = trace(loop, limit_cycle(loop))
    stuck = motion.state[:, 1] == 0.0
    held = np.abs(motion.friction[stuck])
    assert held.max() == pytest.approx(0.31, abs=1e-9)
    assert np.abs(motion.friction[~stuck]) == pytest.approx(0.21)


def test_friction_of_one_direction_only() -> None:
    """The arm slides back without friction; an integration with events moves alike."""
    friction, law = Friction(alpha1=0.1, asymmetry=1.0), "stiction"
    loop = ideal(friction, law, linear=True)
    cycle, (a, b) = limit_cycle(loop), linearize(BODY)
    order = [1, 0, 2, 3]  # the speed of the joint comes first
    closed = (a + np.outer(b, loop.gains))[np.ix_(order, order)]
    events = ReferenceJoint(closed, b[order], np.zeros(4), law, friction)
    found = events.run(np.array(cycle.point)[order], 30.0, np.zeros(4))
    assert cycle.phi_peak_to_peak_rad == pytest.approx(found.peak_to_peak, rel=1e-7)
    assert cycle.period_s == pytest.approx(found.period, rel=1e-7)


@pytest.mark.parametrize(("law", "l2"), [("coulomb", 1.0), ("lugre", 7.0)])
def test_positive_speed_feedback_alone_rotates(law: str, l2: float) -> None:
    """Fig. 4 c and d: steady rotation at the speed where l₂v is the friction."""
    loop = IdealLoop(BODY, friction_law(law), 0.0, l2, 60.0, 20.0)
    motion = limit_cycle(loop)
    assert motion.kind == "steady"
    speed = abs(motion.rotation_rate_rad_s)
    lugre = Friction()
    bump = lugre.alpha1 * np.exp(-((speed / lugre.stribeck_velocity) ** 2))
    assert l2 * speed == pytest.approx(0.21 + (bump if law == "lugre" else 0.0), rel=1e-6)


def test_without_arm_feedback_friction_accelerates_the_arm() -> None:
    """Fig. 4 b: no limit cycle; friction accelerates the arm without bound."""
    assert (
        limit_cycle(IdealLoop(BODY, friction_law("coulomb"), 0.0, 0.0, 60.0, 20.0)).kind
        == "unbounded"
    )


def test_loop_without_friction_comes_to_rest() -> None:
    assert limit_cycle(ideal(Friction(alpha0=0.0, alpha1=0.0, viscous=0.01))).kind == "rest"


def test_floquet_multiplier_is_the_decay_of_a_disturbance() -> None:
    loop = IdealLoop(BODY, FrictionLaw(), 10.0, 4.0, 60.0, 20.0)
    cycle = limit_cycle(loop)
    largest = abs(cycle.floquet_multipliers[0])
    start = np.array(cycle.point)
    disturbed = start.copy()
    disturbed[0] += 1e-3
    gains = np.array([10.0, 4.0, 60.0, 20.0])
    turns = reference.upper_reversals(disturbed, gains, 5 * cycle.period_s, BODY, Friction())
    off = [abs(turn[0] - start[0]) for turn in turns]
    assert off[3] / off[2] == pytest.approx(largest, rel=0.02)


@pytest.fixture(scope="module")
def points() -> list[BranchPoint]:
    """The cycle over viscous friction, through the fold."""

    def loop_at(viscous: float) -> IdealLoop:
        return ideal(Friction(viscous=viscous))

    return Branch(loop_at, 0.0, 0.3).follow(0.0, limit_cycle(loop_at(0.0)))


def test_branch_folds_where_the_cycle_disappears(points: list[BranchPoint]) -> None:
    (fold,) = (i for i, point in enumerate(points) if point.event == "fold")
    value = fold_value(points, fold, "phi_peak_to_peak_rad")
    assert limit_cycle(ideal(Friction(viscous=value - 0.004))).kind == "limit_cycle"
    assert limit_cycle(ideal(Friction(viscous=value + 0.004))).kind == "unbounded"
    multiplier = abs(points[fold].cycle.floquet_multipliers[0])
    assert multiplier == pytest.approx(1.0, abs=0.15)


def test_unstable_cycle_bounds_the_region_of_attraction(points: list[BranchPoint]) -> None:
    """A start just inside the unstable cycle ends in the stable one, just outside it falls."""
    unstable = next(p for p in points if not p.cycle.stable and p.value < 0.15)
    loop = ideal(Friction(viscous=unstable.value))
    point = np.array(unstable.cycle.point)
    ends = {limit_cycle(loop, point * (1.0 + d)).kind for d in (-0.01, 0.01)}
    assert ends == {"limit_cycle", "unbounded"}


def test_a_part_that_the_ideal_loop_lacks_is_refused() -> None:
    """Every parameter of the plant, also a new one, unless it is declared to change nothing."""
    for name, value in LACKS.items():
        other = {tuple: [0.01], float: 0.1}.get(type(value)) or type(value)(1)
        given = {f"plant.{name}": other}
        if name == "coupling.backlash":
            given["plant.coupling.frequency"] = 1.0
        with pytest.raises(ParameterError, match=f"leave out .*plant.{name} = "):
            ideal_loop(make_loop(given))


def test_what_changes_nothing_is_accepted_and_what_is_idealised_named() -> None:
    """Without cogging its phase has no effect; perfect sensors have no counts."""
    given = make_loop(
        {"cogging.phase": 1.0, "coupling.damping": 0.5, "plant.sensors.encoder_counts": 7}
    )
    assert ideal_loop(given) == ideal_loop()
    assert left_out(given) == ("plant.sensors.encoder_counts",)
    assert not left_out(make_loop())

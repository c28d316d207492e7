"""Any linear loop with a friction joint: cycles by the engine and by independent integration."""

from typing import NamedTuple

import numpy as np
import pytest
from joint_reference import ReferenceJoint
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_are

import furuta.limit_cycles.limit_cycle as engine
from furuta.axis.axis import Axis, Cascade, Controller, Pid, released, servo_joint
from furuta.limit_cycles.joint import Joint, JointCycle, joint, joint_cycle
from furuta_model.friction.parameters import Friction

LAWS = ("coulomb", "stiction", "stribeck", "lugre", "dahl")
Random = np.random.Generator


class Loop(NamedTuple):
    """A random loop: ẋ = A x − b F, v = x[0], its start and a time scale."""

    a: np.ndarray
    b: np.ndarray
    axis: Axis
    start: np.ndarray
    frequency: float

    @property
    def scaled(self) -> Joint:
        """The loop for the engine."""
        return joint(self.a, self.b, np.eye(len(self.b))[0], self.axis.friction, self.axis.law)

    @property
    def reference(self) -> ReferenceJoint:
        """The loop for the independent integration."""
        return ReferenceJoint(
            self.a, self.b, np.zeros(len(self.b)), self.axis.law, self.axis.friction
        )


def random_loop(random: Random) -> Loop:
    """A stable servo loop of order 2 to 8: any law, PID or cascade, with up to two loads."""
    while True:
        law = str(random.choice(LAWS))
        inertia, w, level = 10.0 ** random.uniform((-3.0, 0.5, -2.0), (0.0, 1.5, 1.0))
        kp = inertia * w * w * random.uniform(0.7, 2.0)
        controller: Controller
        if random.integers(2):
            ki, kd = kp * w * random.uniform(0.05, 0.4), 2 * inertia * w * random.uniform(0.3, 1.2)
            controller = Pid(kp, ki, kd, float(random.choice([0.0, 0.1 / w])))
        else:
            units = (w, inertia * w, inertia * w * w)
            controller = Cascade(*random.uniform((0.2, 1.0, 0.1), (0.7, 2.0, 0.7)) * units)
        stiffness = kp * 10.0 ** random.uniform(1.0, 2.0)
        friction = Friction(
            sigma0=stiffness,
            sigma1=np.sqrt(stiffness * inertia) * random.uniform(0.3, 1.0) * (law == "lugre"),
            alpha0=level,
            alpha1=0.0 if law in ("coulomb", "dahl") else level * random.uniform(0.1, 1.0),
            stribeck_velocity=level / (inertia * w) * 10.0 ** random.uniform(-2.0, -0.3),
            viscous=inertia * w * random.uniform(0.0, 0.2),
            asymmetry=random.uniform(-0.3, 0.3) * random.integers(2),
        )
        axis = Axis(inertia, friction, law)
        made = servo_joint(axis, controller)
        basis, time = made.units.basis, made.units.time
        a = basis @ made.loop.a @ np.linalg.inv(basis) / time
        start = released(axis, controller, len(a))
        for _ in range(random.integers(0, 3)):
            a = with_load(a, inertia, w, random)
        b = np.zeros(len(a))
        b[0] = 1.0 / inertia
        closed = a - np.outer(b, np.eye(len(a))[0]) * friction.viscous
        if np.linalg.eigvals(closed).real.max() < -1e-3 * w:
            return Loop(a, b, axis, np.append(start, np.zeros(len(a) - len(start))), w)


def with_load(a: np.ndarray, inertia: float, w: float, random: Random) -> np.ndarray:
    """The loop with a load on a damped spring at the joint: twist and speed of the load."""
    n, load = len(a), inertia * random.uniform(0.2, 1.0)
    spring = load * (w * random.uniform(2.0, 8.0)) ** 2
    damper = 0.2 * np.sqrt(spring * load)
    more = np.zeros((n + 2, n + 2))
    more[:n, :n] = a
    twist = np.zeros(n + 2)
    twist[n], twist[0], twist[n + 1] = spring, damper, -damper
    more[0] -= twist / inertia
    more[n, 0], more[n, n + 1] = 1.0, -1.0
    more[n + 1] = twist / load
    return more


MANY = pytest.param(200, marks=[pytest.mark.long, pytest.mark.timeout(7200)])


@pytest.mark.parametrize("count", [6, MANY])
def test_random_loops_move_as_integrated_independently(count: int) -> None:
    """The kinds agree, and size and period of a cycle within 1e-6."""
    random = np.random.default_rng(20261124)
    kinds = []
    for _ in range(count):
        loop = random_loop(random)
        cycle = joint_cycle(loop.scaled, loop.start)
        kinds.append(cycle.kind)
        if loop.axis.law in ("lugre", "dahl"):
            if cycle.kind == "limit_cycle" and cycle.scaled is not None:
                z = cycle.scaled.point[-1] * loop.scaled.units.position
                size, change = loop.reference.closes(np.array(cycle.start), z, cycle.period_s)
                assert size == pytest.approx(cycle.peak_to_peak, rel=1e-6)
                assert change < 1e-5
            continue
        longest, disturbance = 3000.0 / loop.frequency, 1e-6 * np.abs(loop.start)
        motion = loop.reference.run(loop.start, longest, disturbance)
        if cycle.period_s == np.inf:  # a rest that the slightest disturbance leaves, for a while
            assert motion.kind == "rest"
            assert motion.peak_to_peak == pytest.approx(cycle.peak_to_peak, rel=1e-3)
            continue
        assert (motion.kind == "cycle") == (cycle.kind == "limit_cycle"), (loop, cycle, motion)
        if motion.kind == "cycle":
            assert motion.peak_to_peak == pytest.approx(cycle.peak_to_peak, rel=1e-6)
            assert motion.period == pytest.approx(cycle.period_s, rel=1e-6)
    assert {"rest", "limit_cycle"} <= set(kinds)


class Servo(NamedTuple):
    """An axis under PID or cascade, whose reference moves at ``speed``."""

    law: str
    controller: Controller
    speed: float

    def cycle(self, side: int, asymmetry: float = 0.0) -> JointCycle:
        """The final motion from rest of the axis or of its mirror image."""
        friction = Friction(
            alpha0=0.1,
            alpha1=0.1,
            stribeck_velocity=0.1,
            viscous=0.005,
            asymmetry=side * asymmetry,
        )
        axis = Axis(0.01, friction, self.law)
        made = servo_joint(axis, self.controller, side * self.speed)
        return joint_cycle(made, side * released(axis, self.controller, len(made.loop.b)))


PID = Pid(1.0, 2.0, 0.08)
CASCADE = Cascade(8.0, 0.08, 0.3)


@pytest.mark.parametrize(
    ("law", "size", "period"),
    [
        ("stiction", 0.124630, 1.598781),
        ("stribeck", 0.140827, 1.755528),
        ("lugre", 0.119140, 1.586317),
    ],
)
def test_a_reference_that_moves_backward_moves_the_axis_as_its_mirror_image(
    law: str, size: float, period: float
) -> None:
    backward = Servo(law, PID, 0.1).cycle(-1)
    assert backward.kind == "limit_cycle"
    assert backward.stable
    assert backward.peak_to_peak == pytest.approx(size, abs=1e-6)
    assert backward.period_s == pytest.approx(period, abs=1e-6)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(
    ("controller", "speed", "asymmetry"),
    [(PID, 0.05, 0.2), (CASCADE, 0.1, 0.0), (PID, 0.0, 0.35), (PID, 0.0, 0.9), (CASCADE, 0.4, 0.3)],
)
def test_mirror_images_have_the_same_size_and_period(
    law: str, controller: Controller, speed: float, asymmetry: float
) -> None:
    servo = Servo(law, controller, speed)
    forward, backward = (servo.cycle(side, asymmetry) for side in (1, -1))
    assert forward.kind == backward.kind
    assert forward.peak_to_peak == pytest.approx(backward.peak_to_peak, rel=1e-7)
    assert forward.period_s == pytest.approx(backward.period_s, rel=1e-7, nan_ok=True)


def test_a_cycle_of_an_axis_that_slides_backward_only_can_be_drawn() -> None:
    """From its start over one period, in which the axis covers what the reference does."""
    made = servo_joint(Axis(0.01, Friction(alpha0=0.1, alpha1=0.1), "stiction"), PID, -0.1)
    cycle = joint_cycle(made, np.zeros(3))
    path = cycle.trace()
    assert path.time[-1] == pytest.approx(cycle.period_s, rel=1e-9)
    assert path.state[-1, 0] - path.state[0, 0] == pytest.approx(-0.1 * cycle.period_s, rel=1e-6)
    np.testing.assert_allclose(path.state[-1, 1:], path.state[0, 1:], atol=1e-9)
    assert path.state[:, 1].max() == 0.0


@pytest.mark.parametrize("side", [1, -1])
def test_a_belt_carries_a_mass_alike_in_both_directions(side: int) -> None:
    spring = np.array([[0.0, 1.0], [-1.0, 0.0]])
    unit = np.array([0.0, 1.0])
    friction = Friction(alpha0=0.5, alpha1=0.5)
    made = joint(spring, unit, unit, friction, "stiction", np.array([0.1 * side, 0.0]))
    cycle = joint_cycle(made, np.zeros(2))
    assert cycle.kind == "limit_cycle"
    # A slide is an ellipse about 0.5, from the breakaway at 1: (x - 0.5)² + 0.1² = const.
    assert cycle.peak_to_peak == pytest.approx(2.0 * np.hypot(0.5, 0.1), rel=1e-9)
    slide = np.pi + 2.0 * np.arctan2(0.1, 0.5)
    assert cycle.period_s == pytest.approx(1.0 / 0.1 + slide, rel=1e-9)


def relay_loop(frequency: float, damping: float, pole: float) -> Joint:
    """Relay feedback of (s - 1)² / (s + λ)(s² + 2 ζ ω s + ω²), which is Coulomb friction of 1."""
    w, x = frequency, damping
    a = np.array(
        [[-2 * x * w - pole, 1, 0], [-2 * x * w * pole - w * w, 0, 1], [-pole * w * w, 0, 0]]
    )
    b, c = np.array([1.0, -2.0, 1.0]), np.array([1.0, 0.0, 0.0])
    return joint(a, b, c, Friction(alpha0=1.0), "coulomb")


def test_a_published_orbit_of_seven_slides_is_found() -> None:
    """Johansson, Rantzer and Åström, Fast switches in relay feedback systems (1999)."""
    cycle = joint_cycle(relay_loop(25.0, 0.05, 1.0), np.array([0.05, -0.01, 0.1]))
    assert cycle.kind == "limit_cycle"
    assert cycle.peak_to_peak == pytest.approx(0.0045756, abs=1e-7)
    assert cycle.period_s == pytest.approx(5.961837, abs=1e-6)
    assert cycle.scaled is not None
    assert cycle.scaled.turns == 7


def test_a_bounded_motion_that_stops_for_an_instant_is_not_at_rest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Some slides are shorter than any that is seen, but the loop goes on."""
    monkeypatch.setattr(engine, "RETURNS", 800)
    cycle = joint_cycle(relay_loop(10.0, -0.07, 0.05), np.array([0.05, -0.01, 0.1]))
    assert cycle.kind == "irregular"
    assert 0.05 < cycle.peak_to_peak < 0.2


@pytest.mark.parametrize(
    "start", [[0, 0, 0.05, 0], [0.2, 0, 0, 0], [0.01, 0, 0, 0], [0, 0, 1e-6, 0]]
)
def test_a_cart_with_a_pendulum_has_one_period_from_all_starts(start: list[float]) -> None:
    """LQR and Coulomb friction; each slide ends close to where the cart would slide on."""
    cart, pole, damping, inertia, length = 0.5, 0.2, 0.1, 0.006, 0.3
    moment, coupling = inertia + pole * length**2, pole * length
    p = moment * (cart + pole) - coupling**2
    a = np.zeros((4, 4))
    a[0, 1] = a[2, 3] = 1.0
    a[1, 1:3] = np.array([-moment * damping, coupling**2 * 9.8]) / p
    a[3, 1:3] = np.array([-coupling * damping, coupling * 9.8 * (cart + pole)]) / p
    b = np.array([0.0, moment, 0.0, coupling]) / p
    weights = np.diag([5000.0, 0.0, 100.0, 0.0])
    gain = b @ solve_continuous_are(a, b[:, None], weights, np.eye(1))
    friction = Friction(alpha0=0.5)
    made = joint(a - np.outer(b, gain), b, np.array([0.0, 1.0, 0.0, 0.0]), friction, "coulomb")
    cycle = joint_cycle(made, np.array(start, dtype=float))
    assert cycle.kind == "limit_cycle"
    assert cycle.stable
    assert cycle.period_s == pytest.approx(9.386273, abs=1e-6)


@pytest.mark.parametrize("x", [(0.1, 0.05), (0.2, 0.05), (0.1, 0.0), (0.0, 0.02), (1e-8, 0.0)])
def test_a_cart_that_creeps_past_an_unstable_rest_is_not_at_rest(x: tuple[float, float]) -> None:
    """By an integration of others with events, DOP853 at tolerances of 1e-7 and 1e-10."""
    a = np.zeros((4, 4))
    a[0, 1] = a[2, 3] = 1.0
    a[1] = 25.19616457796809, 19.208869873079223, -81.55622456154812, -19.0959613532984
    a[3] = 46.504310626208095, 35.45362027588904, -132.43975074254266, -35.245226142727034
    b = np.array([0.0, 0.7246609826490673, 0.0, 1.3374995758391375])
    friction = Friction(
        alpha0=1.0552872772014696,
        alpha1=0.4370600014058327,
        stribeck_velocity=0.06974245901777326,
        asymmetry=-0.06003256651439831,
        sigma0=757.9445288231205,
        sigma1=16.029289679072516,
    )
    cart = joint(a, b, np.eye(4)[1], friction, "lugre")
    cycle = joint_cycle(cart, np.array([x[0], 0.0, x[1], 0.0]))
    assert (cycle.kind, cycle.stable) == ("limit_cycle", True)
    assert cycle.peak_to_peak == pytest.approx(0.08556968, abs=1e-8)
    assert cycle.period_s == pytest.approx(17.865258, abs=1e-6)
    path = cycle.trace()
    assert path.time[-1] == pytest.approx(cycle.period_s)
    exactly = joint_cycle(cart, np.zeros(4))
    assert (exactly.kind, exactly.stable) == ("rest", False)


def test_a_cycle_has_its_smallest_period(monkeypatch: pytest.MonkeyPatch) -> None:
    """A motion that nears it from both sides in turn comes near itself after two periods first."""
    made = servo_joint(Axis(0.01, Friction(alpha0=0.1, alpha1=0.1), "stiction"), PID, 0.1)
    usual = joint_cycle(made)
    monkeypatch.setattr(engine, "_recurrences", lambda points: [(4, 1e-3)][: len(points) // 5])
    cycle = joint_cycle(made)
    assert cycle.scaled is not None
    assert cycle.scaled.turns == 1
    assert cycle.period_s == pytest.approx(usual.period_s, rel=1e-9)


@pytest.mark.parametrize("side", [1, -1])
def test_pauses_that_grow_end_in_a_long_period(side: int) -> None:
    """Asymmetric stiction: pauses up to 2984 s. Values of :meth:`ReferenceJoint.run`, in 3 s."""
    servo = Servo("stiction", PID, 0.0)
    cycle = servo.cycle(side, 0.3)
    assert cycle.kind == "limit_cycle"
    assert cycle.stable
    assert cycle.peak_to_peak == pytest.approx(0.2145001798, rel=1e-8)
    assert cycle.period_s == pytest.approx(3297.647177, rel=1e-9)


@pytest.mark.parametrize("side", [1, -1])
def test_a_joint_that_never_stops_can_still_have_a_cycle(side: int) -> None:
    """Where friction falls a little faster than the damping rises, the joint only slows down."""
    damping, speed, p = 3.5, 0.104, Friction(alpha0=0.5, alpha1=0.5, stribeck_velocity=0.1)
    a, unit = np.array([[0.0, 1.0], [-1.0, -damping]]), np.array([0.0, 1.0])
    made = joint(a, unit, unit, p, "stribeck", np.array([-side * speed, 0.0]))
    cycle = joint_cycle(made, side * np.array([-0.8, 0.09]))
    assert cycle.kind == "limit_cycle"
    assert cycle.stable

    def rate(_: float, y: np.ndarray) -> list[float]:
        level = p.alpha0 + p.alpha1 * np.exp(-((y[1] / p.stribeck_velocity) ** 2))
        return [y[1] - speed, -y[0] - damping * y[1] - level]

    def falls(_: float, y: np.ndarray) -> float:
        return float(y[1] - 0.1)

    falls.direction = -1.0  # type: ignore[attr-defined]
    run = solve_ivp(
        rate, (0.0, 600.0), [-0.8, 0.09], "DOP853", events=falls, rtol=1e-10, atol=1e-12
    )
    assert np.diff(run.t_events[0])[-1] == pytest.approx(cycle.period_s, rel=1e-7)
    path = cycle.trace()
    assert path.time[-1] == pytest.approx(cycle.period_s, rel=1e-12)
    np.testing.assert_allclose(path.state[-1, 1:], path.state[0, 1:], atol=1e-9)


def test_a_slide_without_end_is_followed_for_a_while_only() -> None:
    """Friction that does not fall on a belt without damping: every motion goes on as it is."""
    spring, unit = np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([0.0, 1.0])
    made = joint(spring, unit, unit, Friction(alpha0=0.5), "coulomb", np.array([0.1, 0.0]))
    cycle = joint_cycle(made, np.array([0.5, -0.05]))
    assert cycle.kind == "irregular"
    # 0.1, and what the ends of the time that was seen add to the mean motion.
    assert 0.1 <= cycle.peak_to_peak <= 0.2

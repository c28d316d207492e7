"""Any linear loop with a friction joint: cycles by the engine and by independent integration."""

from typing import NamedTuple

import numpy as np
import pytest
from joint_reference import ReferenceJoint

from furuta.axis.axis import Axis, Cascade, Controller, Pid, released, servo_joint
from furuta.limit_cycles.joint import Joint, joint, joint_cycle
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

"""The friction of any joint, on joints with friction that truly sticks and is not the model's."""

from math import nan

import numpy as np
import pytest

from furuta_friction.compensation import ObserverParameters
from furuta_friction.joint_observer import (
    JointMemory,
    JointModel,
    JointSample,
    ObserverNodeParameters,
    design_joint,
    joint_step,
)
from furuta_model.block import block, new_memory
from furuta_model.friction.parameters import Friction
from furuta_model.late_drive import LateDrive
from furuta_model.parameters import build

INERTIA, LEVEL, GRAVITY, VISCOUS = 0.2, 2.0, 6.0, 0.3
RESOLUTION = 2.0 * np.pi / 2**16
MODEL = JointModel(
    inertia=INERTIA,
    viscous=VISCOUS,
    gravity_sin=GRAVITY,
    resolution=RESOLUTION,
    friction_process_noise=3.0,
)
AT_ONCE = LateDrive()
DRY = Friction(sigma0=2e4, sigma1=50.0, alpha0=LEVEL, alpha1=0.0, stribeck_velocity=0.05)


class Observer:
    """The observer of a joint, sample by sample."""

    def __init__(
        self,
        compensation: str = "none",
        model: JointModel = MODEL,
        dt: float = 1e-3,
        dry: Friction = DRY,
        drive: LateDrive = AT_ONCE,
    ) -> None:
        usual = ObserverParameters(compensation, dry, drive=drive, sample_time=dt)
        design = design_joint(ObserverNodeParameters(usual, "elbow_joint", model))
        self._memory, self._design = new_memory(JointMemory), block(design)

    def estimate(self, x: JointSample, samples: int = 1) -> float:
        """F̂ for a sample so many samples after the last one, 0 for a new start."""
        return joint_step(self._memory, x, self._design, samples)


class TrueJoint:
    """A joint under gravity, with Coulomb friction as a set-valued force, in steps of 0.1 ms."""

    def __init__(self, position: float = 0.0) -> None:
        self.position, self.speed, self.friction = position, 0.0, 0.0

    def move(self, torque: float, dt: float) -> None:
        """Hold a torque for a sample."""
        for _ in range(round(dt / 1e-4)):
            load = GRAVITY * np.sin(self.position) + VISCOUS * self.speed
            free = self.speed + 1e-4 * (torque - load) / INERTIA
            self.friction = float(np.clip(free * INERTIA / 1e-4, -LEVEL, LEVEL))
            self.speed = free - 1e-4 * self.friction / INERTIA
            self.position += 1e-4 * self.speed

    @property
    def measured(self) -> float:
        """The position in counts of an encoder."""
        return RESOLUTION * np.floor(self.position / RESOLUTION + 0.5)


def pull(time: float, position: float) -> float:
    """A torque that holds the weight and moves the joint back and forth."""
    return 3.5 * np.sin(4.0 * time) + GRAVITY * np.sin(position)


def compensated(
    observer: Observer, late: int, dt: float, seconds: float, share: float = 1.0
) -> np.ndarray:
    """The same, and the torque (n, 5), of a joint whose torque contains F̂ some samples late."""
    joint, rows, applied, sent = TrueJoint(), [], 0.0, [0.0] * 8
    for k in range(round(seconds / dt)):
        sent = [observer.estimate((joint.measured, nan, applied, nan)), *sent[:-1]]
        rows.append((k * dt, joint.friction, sent[0], joint.speed, applied))
        feedback = 1.5 * np.sin(4.0 * k * dt) + GRAVITY * np.sin(joint.position)
        applied = feedback + share * sent[late]
        joint.move(applied, dt)
    return np.array(rows)


@pytest.mark.parametrize("level", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("late", [0, 1, 3])
@pytest.mark.parametrize("dt", [0.002, 5e-4])
def test_estimate_is_the_true_friction(dt: float, late: int, level: float) -> None:
    """Of a wrong level, and however late it is part of the torque, which does not chatter.

    While the joint slides, within 10 % of the level after 0.1 s.
    """
    dry = DRY._replace(alpha0=level * LEVEL)
    rows = compensated(Observer("recommended", dt=dt, dry=dry), late, dt, 6.0)
    sliding = np.abs(rows[:, 3]) > 0.3
    settled = sliding & np.roll(sliding, round(0.1 / dt)) & (rows[:, 0] > 0.5)
    error = rows[settled, 2] - rows[settled, 1]
    assert np.count_nonzero(settled) > 1000
    assert np.sqrt(np.mean(error**2)) < 0.1 * LEVEL
    assert np.sqrt(np.mean(np.diff(rows[rows[:, 0] > 3.0, 4]) ** 2)) < 0.25 * LEVEL


@pytest.mark.parametrize("late", [0, 1, 3])
@pytest.mark.parametrize("share", [0.0, 0.2, 0.5])
def test_an_estimate_need_not_be_applied(share: float, late: int) -> None:
    """A joint that mostly sticks, or hardly slides: F̂ is near the friction and does not chatter."""
    rows = compensated(Observer("recommended"), late, 1e-3, 6.0, share)[1000:]
    assert np.sqrt(np.mean((rows[:, 2] - rows[:, 1]) ** 2)) < 0.25 * LEVEL
    assert np.sqrt(np.mean(np.diff(rows[:, 2]) ** 2)) < 0.1 * LEVEL


@pytest.mark.parametrize("compensation", ["coulomb", "lugre", "recommended"])
def test_compensation_lets_a_weak_torque_move_the_joint(compensation: str) -> None:
    """A torque of a tenth of the level moves nothing alone; with 0.9 F̂ it moves the joint."""

    def swing(name: str) -> float:
        observer, joint, applied = Observer(name), TrueJoint(), 0.0
        moved = []
        for k in range(4000):
            friction = observer.estimate((joint.measured, nan, applied, nan))
            wanted = 4.0 * np.sin(2.0 * k * 1e-3) if k < 1000 else 0.2 * np.sin(2.0 * k * 1e-3)
            applied = wanted + GRAVITY * np.sin(joint.position) + 0.9 * friction
            joint.move(applied, 1e-3)
            moved.append(joint.position)
        return float(np.ptp(moved[2000:]))

    assert swing("none") < 1e-3
    assert swing(compensation) > 0.1


def test_missing_samples_and_a_new_start() -> None:
    """One lost sample in three changes little; after a gap the estimate begins anew."""

    def error(lost: bool) -> tuple[float, Observer]:
        observer, joint = Observer("recommended"), TrueJoint()
        applied, since, estimate, errors = 0.0, 0, 0.0, []
        for k in range(6000):
            since += 1
            if k % 3 or not lost:
                sample = (joint.measured, nan, applied, nan)
                estimate, since = observer.estimate(sample, since), 0
            errors.append(estimate - joint.friction)
            load = GRAVITY * np.sin(joint.position)
            applied = 1.5 * np.sin(4.0 * k * 1e-3) + load + estimate
            joint.move(applied, 1e-3)
        return float(np.sqrt(np.mean(np.square(errors[1000:])))), observer

    (whole, _), (gappy, observer) = error(lost=False), error(lost=True)
    assert gappy < 1.1 * whole
    weight = GRAVITY * np.sin(5.0)
    assert observer.estimate((5.0, nan, weight, nan), 0) == pytest.approx(0.0, abs=1e-9)


def test_speed_of_the_reference_takes_over_where_it_is_fast() -> None:
    """Far above reference_speed only the reference counts, at rest only the own speed."""
    model = JointModel(reference_speed=0.1)
    observer = Observer("coulomb", model)
    for reference, own, expected in (
        (2.0, -0.1, LEVEL),
        (0.001, -0.1, -LEVEL),
        (0.0, -0.1, -LEVEL),
        (nan, -0.1, -LEVEL),
        (-2.0, 0.1, -LEVEL),
    ):
        assert observer.estimate((0.0, own, nan, reference)) == expected


def test_without_an_inertia_the_measured_speed_counts() -> None:
    """Coulomb compensation needs neither a model nor an effort; no friction is observed."""
    observer = Observer("coulomb", JointModel())
    assert observer.estimate((1.0, 0.2, nan, nan)) == LEVEL
    observed = Observer("stiction", JointModel())
    assert observed.estimate((1.0, 0.0, 5.0, nan)) == 0.0


def test_an_effort_that_is_missing_once_is_held() -> None:
    """A single NaN does not disturb the estimate of the speed."""
    rows = []
    for missing in (False, True):
        observer, joint, applied = Observer("coulomb"), TrueJoint(), 0.0
        for k in range(2000):
            effort = nan if missing and k % 50 == 7 else applied
            rows.append(observer.estimate((joint.measured, nan, effort, nan)))
            applied = pull(k * 1e-3, joint.position)
            joint.move(applied, 1e-3)
    whole, holey = np.array(rows).reshape(2, -1)
    assert np.mean(whole != holey) < 0.02


def test_impossible_numbers_and_models() -> None:
    """A huge position is no sample; the arm and a joint have bounds of their own."""
    assert np.isnan(Observer("lugre").estimate((1e9, 0.0, 0.0, nan)))
    assert build(ObserverNodeParameters, {"axis.inertia": 1e-300}).joint == "arm"
    assert build(ObserverNodeParameters, {"joint": "elbow", "alpha0": 150.0}).joint == "elbow"

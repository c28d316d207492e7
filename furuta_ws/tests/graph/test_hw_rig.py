"""Rig files, calibration and the normalised model."""

from math import pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from furuta.outcomes import outcome
from furuta.settings.settings import load_settings, loop, rig_settings
from furuta_hw.bridge.guarded_rig import SLEW, SampleClock
from furuta_hw.drivers.serial_protocol.driver import SampleConverter
from furuta_hw.protocol.frames import ARMED, FAULT, WATCHDOG, SensorsFrame
from furuta_hw.rigs.calibration import SpeedSensor
from furuta_hw.rigs.channels import converter, encoder
from furuta_hw.rigs.known_rigs import find_rig, rig_directory
from furuta_hw.rigs.physical import PhysicalParameters, normalise
from furuta_hw.rigs.rig import Rig
from furuta_hw.rigs.rig_file import load_rig
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import accelerations
from furuta_model.sensors import convert

PHYSICAL = PhysicalParameters(
    arm_inertia=2e-4,
    rotor_inertia=4e-6,
    gear_ratio=3.0,
    arm_length=0.085,
    pendulum_mass=0.024,
    pendulum_length=0.0645,
    pendulum_inertia=3.3e-5,
    resistance=8.4,
    torque_constant=0.042,
    back_emf_constant=0.04,
    arm_damping=2.7e-4,
    friction_torque=1e-3,
)


def in_newton_metres(u: float, v: float, theta: float, w: float) -> tuple[float, float]:
    """Accelerations of the physical rig: rods, motor and gear, without any normalisation.

    From the positions of arm and pendulum by d'Alembert with numerical derivatives of the
    pendulum's centre of mass; nothing of eq. (1) is used.
    """
    p = PHYSICAL

    def centre(q: np.ndarray) -> np.ndarray:
        phi, t = q
        along = np.array((np.cos(phi), np.sin(phi), 0.0))
        across = np.array((-np.sin(phi), np.cos(phi), 0.0))
        up = np.array((0.0, 0.0, 1.0))
        rod = p.pendulum_length
        return p.arm_length * along + rod * (np.sin(t) * across + np.cos(t) * up)

    def kinetic(q: np.ndarray, rate: np.ndarray) -> float:
        h = 1e-5
        velocity = (centre(q + h * rate) - centre(q - h * rate)) / (2 * h)
        # A thin rod: inertia about its centre across it, none along it.
        spin = p.pendulum_inertia * (rate[1] ** 2 + (np.sin(q[1]) * rate[0]) ** 2)
        arm = (p.arm_inertia + p.gear_ratio**2 * p.rotor_inertia) * rate[0] ** 2
        return float(0.5 * (p.pendulum_mass * velocity @ velocity + spin + arm))

    q, rate, e, h = np.array((0.3, theta)), np.array((v, w)), np.eye(2), 1e-3

    def momentum(q: np.ndarray, rate: np.ndarray) -> np.ndarray:
        return np.array(
            [(kinetic(q, rate + h * e[i]) - kinetic(q, rate - h * e[i])) / (2 * h) for i in (0, 1)]
        )

    mass = np.column_stack(
        [(momentum(q, rate + h * e[i]) - momentum(q, rate - h * e[i])) / (2 * h) for i in (0, 1)]
    )
    turning = (momentum(q + h * rate, rate) - momentum(q - h * rate, rate)) / (2 * h)
    pull = [(kinetic(q + h * e[i], rate) - kinetic(q - h * e[i], rate)) / (2 * h) for i in (0, 1)]
    current = (u - p.gear_ratio * p.back_emf_constant * v) / p.resistance
    motor = p.gear_ratio * p.torque_constant * current - p.arm_damping * v
    motor -= p.friction_torque * np.sign(v)
    weight = p.pendulum_mass * p.gravity * p.pendulum_length * np.sin(theta)
    result = np.linalg.solve(mass, np.array((motor, weight)) - turning + pull)
    return float(result[0]), float(result[1])


@pytest.mark.parametrize(
    ("u", "v", "theta", "w"), [(2.0, 0.5, 0.1, 0.0), (-1.0, -3.0, 2.0, 4.0), (0.0, 1.0, 3.0, -2.0)]
)
def test_normalised_model_moves_as_the_physical_one(
    u: float, v: float, theta: float, w: float
) -> None:
    """Eq. (1) with the normalised coefficients and friction: the same accelerations."""
    model, viscous, coulomb, _ = normalise(PHYSICAL)
    got = accelerations(v, theta, w, u - coulomb * np.sign(v) - viscous * v, model)
    np.testing.assert_allclose(got, in_newton_metres(u, v, theta, w), rtol=1e-4, atol=1e-3)


def test_rigs_of_the_workspace() -> None:
    """Each loads, names its sources, and has a valid model; the paper's is the default."""
    files = sorted(rig_directory().glob("*.yaml"))
    assert {"odrive_furuta", "paper", "qube_servo_2"} <= {file.stem for file in files}
    for file in files:
        rig = load_rig(file)
        assert rig.model.determinant > 0
        assert "sources:" in file.read_text()
        loop(load_settings([], [], rig_settings(rig)))
    paper, default = load_rig(rig_directory() / "paper.yaml"), Rig()
    np.testing.assert_allclose(paper.model, default.model, rtol=1e-12)
    assert paper._replace(model=default.model) == default


@pytest.mark.parametrize("name", sorted(file.stem for file in rig_directory().glob("*.yaml")))
def test_rigs_of_the_workspace_balance(name: str) -> None:
    """With the rig's own poles and nothing else given; `odrive_furuta` once fell."""
    balanced = outcome(loop(load_settings([], [], rig_settings(find_rig(name)))), 20.0)
    assert not balanced.fell
    assert balanced.theta_peak_to_peak_rad < 0.5


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("legs: {counts: 3}", "unknown: legs.counts"),
        ("arm: {sign: 0}", "arm.sign must be 1 or -1"),
        ("arm: {counts_per_turn: 2.5}", "must be an integer"),
        ("model: {alpha: 1}\nlinear: {a23: -1}", "one of model, linear, physical"),
        ("physical: {arm_length: 1}", "physical needs pendulum_mass"),
        ("line: {watchdog: 0.001}", "line.watchdog must be 2 to 65535 samples"),
        ("uncertainty: {standard_errors: {mass: 1}}", "uncertainty of unknown mass"),
        ("waves: {orders: [1, 2], cosine: [0.1], sine: [0.1]}", "must have one length"),
    ],
)
def test_a_bad_rig_file_is_one_line(tmp_path: Path, text: str, reason: str) -> None:
    """The message names the file and the error."""
    file = tmp_path / "rig.yaml"
    file.write_text(text)
    with pytest.raises(ParameterError, match=r"rig\.yaml") as caught:
        load_rig(file)
    assert reason in str(caught.value)
    assert "\n" not in str(caught.value)


@given(st.floats(-20, 20), st.integers(4, 16), st.sampled_from((1, -1)))
def test_a_converter_is_the_simulated_one(value: float, bits: int, sign: int) -> None:
    """Conversion to a code and back equals the simulated rig's converter to the last bit."""
    channel = converter(10.0, bits, sign, 0.0)
    expected = sign * convert(sign * value, 10.0, bits)
    assert channel.to_si(channel.to_code(value)) == expected


@given(st.integers(-(2**31), 2**31 - 1), st.integers(1, 2**20), st.floats(-1e4, 1e4))
def test_an_encoder_loses_no_count(code: int, counts: int, zero: float) -> None:
    """Code → angle → code is the code."""
    channel = encoder(counts, -1, round(zero))
    assert channel.to_code(channel.to_si(code)) == code


def frame(sample: int, **codes: int) -> SensorsFrame:
    """Make a frame whose other fields are zero."""
    given = dict.fromkeys(SensorsFrame._fields, 0) | {"sample": sample} | codes
    return SensorsFrame(**given)


def test_speed_from_counts() -> None:
    """Without a tachometer: the filtered difference, exact at constant speed, also across gaps."""
    converter = SampleConverter(Rig(speed=SpeedSensor(sensor="encoder")))
    for k in [*range(300), *range(310, 600, 2)]:
        sample = converter.convert(frame(k, arm=k))
    assert sample.arm_speed == pytest.approx(2 * pi / 250 / 0.001, rel=1e-6)
    assert sample.arm_angle == pytest.approx(598 * 2 * pi / 250)
    assert sample.number == 598


def test_sample_has_the_state_of_the_rig() -> None:
    """Voltage, codes, each bit of the status, and converters at the end of their range."""
    converter = SampleConverter(Rig())
    sample = converter.convert(frame(1, drive=1024, arm=7, speed=8, pendulum=9))
    assert (sample.voltage, sample.codes) == (5.0, (7, 8, 9))
    for status in range(8):
        sample = converter.convert(frame(status, status=status))
        assert sample.armed == bool(status & ARMED)
        assert sample.watchdog == bool(status & WATCHDOG)
        assert sample.fault == bool(status & FAULT)
        assert not sample.at_rail
    assert converter.convert(frame(8, speed=2047)).at_rail
    assert converter.convert(frame(9, pendulum=-2048)).at_rail


def test_stamps_follow_the_rig_and_suppress_jitter() -> None:
    """Delays of up to 20 ms move stamps by less than their slew; the rig's drift is followed.

    Meanwhile the count of its samples begins anew.
    """
    random = np.random.default_rng(0)
    period, drift = 1_000_000, 50e-6
    clock = SampleClock(period)
    stamps = []
    for k in range(100_000):
        arrival = round(k * period * (1 + drift) + 1e5 + random.exponential(2e5))
        arrival += 20_000_000 * (k % 1000 == 0)
        stamps.append(clock.stamp((k - 50_000) % 2**32, arrival))
    steps = np.diff(stamps)
    assert np.all(np.abs(steps - period) <= SLEW * period + 1)
    assert abs(stamps[-1] - 99_999 * period * (1 + drift)) < 1_000_000

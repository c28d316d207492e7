"""The C firmware with an exported loop on the board: it balances without a host."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_loop import CompiledLoop, write_loop

import furuta
from furuta.export.values import DOUBLE, FLOAT
from furuta_hw.drivers.serial_protocol.driver import SampleConverter
from furuta_hw.emulator.compiled_firmware import CompiledFirmware
from furuta_hw.emulator.emulated_rig import EmulatedRig, plant_of
from furuta_hw.protocol import frames
from furuta_hw.protocol.frames import ARMED, FrameReader, SensorsFrame, encode
from furuta_hw.rigs.rig import Rig
from furuta_model.state import PHI, THETA
from furuta_sim.parameters import InitialState

pytest.importorskip("ziglang", reason="pip install -r firmware/requirements.lock")

SESSION, WATCHDOG = 77, 20
SAMPLES = 20_000
LOOP = furuta.make_loop({"compensation": "lugre"}, rig="paper")
# What a host does with a sample: the bytes that it sends.
Host = Callable[[SensorsFrame], bytes]


def emulated(rig: Rig, folder: Path | None) -> EmulatedRig:
    """An emulated rig in a session; ``folder`` has the loop on the board."""
    plant = plant_of(rig, InitialState(theta=0.02), 3)
    made = EmulatedRig(rig, plant, make_firmware=partial(CompiledFirmware, loop=folder))
    made.receive(encode(frames.HelloFrame(frames.VERSION, SESSION, 1000, WATCHDOG)))
    made.step()
    return made


def run(rig: EmulatedRig, samples: int, host: Host) -> np.ndarray:
    """The states (n, 4) while a host answers."""
    reader, states = FrameReader(), []
    for _ in range(samples):
        for frame in reader.read(rig.step()):
            if isinstance(frame, SensorsFrame):
                rig.receive(host(frame))
        rig.process_input()
        states.append(rig.x[:4].copy())
    return np.array(states)


def silent(_: SensorsFrame) -> bytes:
    """A host that has been killed."""
    return b""


def arming(frame: SensorsFrame) -> bytes:
    """A host that arms the rig and says nothing more."""
    return b"" if frame.status & ARMED else encode(frames.ArmFrame(SESSION, frame.sample))


def controlling_host(rig: Rig, loop: CompiledLoop) -> Host:
    """A host that drives as the graph does: the loop in double has the bits of the nodes."""
    converter = SampleConverter(rig)

    def answer(frame: SensorsFrame) -> bytes:
        _, phi, phi_dot, theta, volts, *_ = converter.convert(frame)
        reading = np.array([[phi, phi_dot, theta, np.nan, volts]])
        code = rig.drive.channel.to_code(loop.run(reading, np.zeros(1, dtype=np.uint8))[0, 0])
        return arming(frame) + encode(frames.DriveFrame(SESSION, frame.sample, code))

    return answer


def residual(states: np.ndarray) -> float:
    """Peak to peak of φ in the second half [rad]."""
    return float(np.ptp(states[len(states) // 2 :, PHI]))


@pytest.fixture
def exported(tmp_path: Path) -> Path:
    """The folder of a loop."""
    write_loop(LOOP, tmp_path, FLOAT, furuta.load_rig("paper"))
    return tmp_path


def test_residual_is_that_of_the_host(exported: Path, tmp_path_factory: Any) -> None:
    """Within an encoder count, with a host that only arms; the watchdog is fed on the board."""
    rig = furuta.load_rig("paper")
    host = controlling_host(rig, CompiledLoop(LOOP, tmp_path_factory.mktemp("host")))
    on_board, by_host = emulated(rig, exported), emulated(rig, None)
    alone, hosted = run(on_board, SAMPLES, arming), run(by_host, SAMPLES, host)
    print("residual", residual(alone), residual(hosted))
    assert on_board.firmware.armed and by_host.firmware.armed
    count = 2.0 * np.pi / rig.arm.counts_per_turn
    assert abs(residual(alone) - residual(hosted)) < count
    assert np.abs(alone[:, THETA]).max() < 0.1


def test_speed_from_an_encoder(tmp_path: Path) -> None:
    """The board's filter on the arm's speed is that of the driver: it balances."""
    name = "qube_servo_2"
    rig, loop = furuta.load_rig(name), furuta.make_loop({"compensation": "lugre"}, rig=name)
    write_loop(loop, tmp_path, DOUBLE, rig)
    assert np.abs(run(emulated(rig, tmp_path), SAMPLES, arming)[:, THETA]).max() < 0.1


def test_only_when_armed_and_until_told(exported: Path) -> None:
    """0 V before Arm, after Stop, after Hello, and at a fault; a host's Drive frames do nothing."""
    rig = emulated(furuta.load_rig("paper"), exported)
    run(rig, 100, silent)
    assert (rig.firmware.code, rig.firmware.driven) == (0, 0)
    run(rig, 200, arming)
    run(rig, 3 * WATCHDOG, silent)
    assert rig.firmware.armed and not rig.firmware.tripped

    def misleading(frame: SensorsFrame) -> bytes:
        return encode(frames.DriveFrame(SESSION, frame.sample, 2000))

    run(rig, 5, misleading)
    assert abs(rig.firmware.code) < 500
    for stop in (
        frames.StopFrame(SESSION),
        frames.HelloFrame(frames.VERSION, SESSION, 1000, WATCHDOG),
    ):
        assert rig.firmware.armed
        rig.receive(encode(stop))
        run(rig, 10, silent)
        assert (rig.firmware.code, rig.firmware.armed) == (0, False)
        rig.hold()
        run(rig, 200, arming)
    rig.faults = rig.faults._replace(rig_fault=True)
    run(rig, 2, silent)
    assert (rig.firmware.code, rig.firmware.armed) == (0, False)

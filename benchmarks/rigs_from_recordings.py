"""From a recording of an unknown rig to a pendulum that stands: random rigs, one after the other.

    tools/in_environment python benchmarks/rigs_from_recordings.py --rigs 10

Each rig hangs and is driven in open loop by a multisine, through its encoders and its converter.
The recording becomes a rig file as `furuta identify --write` makes it. The control system of that
file then balances the true rig with every compensation.
"""

import argparse
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from furuta.identification.identify import identify
from furuta.identification.options import Options
from furuta.identification.result.identified_rig import identified_rig
from furuta.lanes.batch import batch
from furuta.settings.settings import loop, rig_settings
from furuta.studies.comparison.candidates import parse_candidates
from furuta_control.control import ControllerParameters
from furuta_control.excitation import ExcitationParameters
from furuta_friction.compensation import COMPENSATIONS
from furuta_hw.rigs.calibration import ArmEncoder, DriveConverter, PendulumSensor, SpeedSensor
from furuta_hw.rigs.rig import Rig, RigLine, SafetyLimits
from furuta_hw.rigs.rig_file import load_rig, rig_file_text
from furuta_model.friction.parameters import Friction
from furuta_model.parts.disturbances import Tilt, TorqueWaves
from furuta_model.parts.motion import PendulumFriction
from furuta_model.pendulum import FurutaPendulum
from furuta_recordings.recording import Recording
from furuta_sim.simulation.closed_loop import Loop, simulate

# What is known of every rig before the recording: sensors, drive, timing, limits.
KNOWN = Rig(
    arm=ArmEncoder(8192),
    speed=SpeedSensor("encoder"),
    pendulum=PendulumSensor("encoder", counts_per_turn=8192),
    drive=DriveConverter(12.0),
    line=RigLine(sample_time=0.002),
    limits=SafetyLimits(voltage=12.0, pendulum_angle=6.28, arm_angle=1e6, arm_speed=100.0),
)
SECONDS, BALANCED_SECONDS = 12.0, 20.0
# Excitation: amplitude relative to the gravity torque of the pendulum, and period [s].
AMPLITUDE, PERIOD = 8.0, 4.0


def random_rig(seed: int) -> Rig:
    """A rig about as large as that of an enthusiast: everything is random within a factor."""
    rng = np.random.default_rng(seed)
    beta, delta = rng.uniform(0.0015, 0.004), rng.uniform(0.15, 0.35)
    gamma = beta * rng.uniform(0.6, 1.2)
    alpha = gamma**2 / beta + rng.uniform(0.003, 0.01)
    tilt, wave = rng.uniform(-0.02, 0.02, 2), rng.uniform(-0.02, 0.02, 4)
    return KNOWN._replace(
        model=FurutaPendulum(alpha, beta, gamma, delta),
        friction=Friction(
            sigma0=rng.uniform(40.0, 160.0),
            sigma1=rng.uniform(0.3, 1.0),
            alpha0=rng.uniform(0.06, 0.16),
            alpha1=rng.uniform(0.0, 0.02),
            viscous=rng.uniform(0.05, 0.3),
            asymmetry=rng.uniform(-0.1, 0.1),
        ),
        pendulum_friction=PendulumFriction(rng.uniform(1e-4, 6e-4), 0.0),
        drive=KNOWN.drive._replace(delay=0.002 * int(rng.integers(0, 3))),
        tilt=Tilt(*(float(angle) for angle in tilt)),
        waves=TorqueWaves((2.0, 14.0), tuple(wave[:2]), tuple(wave[2:])),
    )


def recorded(rig: Rig, seed: int) -> Recording:
    """The hanging pendulum, driven in open loop: codes of the encoders and the drive's voltage."""
    settings = rig_settings(rig)
    plant = loop(settings).plant
    plant = plant._replace(seed=seed, initial=plant.initial._replace(theta=pi - 0.01))
    signal = ExcitationParameters("multisine", AMPLITUDE * rig.model.delta, PERIOD, 3.0, 1e3, 1e3)
    control = ControllerParameters(mode="open_loop", excitation=signal, sample_time=0.002)
    run = simulate(Loop(plant, loop(settings).estimator, controller=control), SECONDS)
    count = 2 * pi / 8192
    measured = np.full((len(run.command), 4), np.nan)
    measured[:, 0] = np.round(run.state[:, 0] / count) * count
    measured[:, 2] = np.round(run.state[:, 2] / count) * count
    return Recording(f"rig {seed}", run.time, measured, run.time, run.command)


def balanced(truth: Rig, identified: Rig) -> dict[str, Any]:
    """The arm's peak to peak [rad] for every compensation, NaN where the pendulum fell."""
    settings = rig_settings(identified)
    settings["plant"] = rig_settings(truth)["plant"]
    candidates = parse_candidates(COMPENSATIONS, settings)
    loops = [loop(candidate.applied_to(settings)) for candidate in candidates]
    outcomes = batch(loops, BALANCED_SECONDS)
    return {
        name: float("nan") if outcome.fell else outcome.phi_peak_to_peak_rad
        for name, outcome in zip(COMPENSATIONS, outcomes, strict=True)
    }


def main() -> None:
    """Run the study and print a line for each rig."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rigs", type=int, default=10)
    parser.add_argument("--first", type=int, default=0, help="seed of the first rig")
    options = parser.parse_args()
    stood, seeds = 0, range(options.first, options.first + options.rigs)
    for seed in seeds:
        residuals = study(seed)
        stood += not np.any(np.isnan(list(residuals.values())))
        text = ", ".join(f"{name} {residual:.3f}" for name, residual in residuals.items())
        print(f"rig {seed}: {text} rad", flush=True)
    print(f"{stood} of {len(seeds)} rigs stand with every compensation")


def study(seed: int) -> dict[str, float]:
    """Identify a random rig from its recording, write and read its file, balance the truth."""
    truth = random_rig(seed)
    model = identify([recorded(truth, seed)], Options(window=1.0))
    identified, uncertainty = identified_rig(model, KNOWN)
    with TemporaryDirectory() as directory:
        file = Path(directory) / "rig.yaml"
        file.write_text(rig_file_text(identified, uncertainty, f"rig {seed}"), encoding="utf-8")
        return balanced(truth, load_rig(file))


if __name__ == "__main__":
    main()

"""Checks the log of an emulated rig: when it was driven, and how it moved."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from furuta_hw.rigs.rig import Rig
from furuta_sim.emulator.emulated_rig import plant_of
from furuta_sim.plant import design_plant
from soak.oracles import (
    armed_without_request,
    different_motion,
    energy_growth,
    late_stop,
    out_of_bounds,
    unarmed_drive,
)
from soak.record import Record

RIG = Rig()
PERIOD = round(RIG.line.sample_time * 1e9)
# Time from the last sign of life to 0 V that is allowed: the watchdog, and a sample [ns].
ALLOWED = (RIG.watchdog_samples + 1) * PERIOD


def check_rig_log(
    record: Record,
    log: Mapping[str, np.ndarray],
    requests: int,
    silences: Iterable[tuple[int, int]],
) -> None:
    """Check a log from its begin, with the number of requests to arm.

    ``silences`` are the times [ns] from which, and until which, a node was dead or paused.
    """
    time, volts, armed = log["time_ns"], log["volts"], log["armed"]
    x = np.column_stack([log[name] for name in ("phi", "phi_dot", "theta", "theta_dot")])
    record.check("unarmed", unarmed_drive(volts, armed, requests))
    record.check("arming", armed_without_request(armed, requests))
    record.check("bounds", out_of_bounds(x))
    _check_physics(record, x, volts)
    for silent, back in silences:
        record.check("watchdog", late_stop(time, volts, silent, back, ALLOWED))
        driven = time[(volts != 0.0) & (time > silent) & (time < back)]
        if len(driven):
            record.measure("time to 0 V of the rig [ms]", float(driven[-1] - silent) / 1e6)
    record.tried["driven samples"] = int(np.sum(volts != 0.0))


def _check_physics(record: Record, x: np.ndarray, volts: np.ndarray) -> None:
    """The voltage of a row was applied up to its state."""
    held = np.all(x == x[0], axis=1)
    # Holding the pendulum moves it by hand.
    moved = held | np.append(held[1:], True)
    after = np.where(moved, 1.0, np.append(volts[1:], 0.0))
    record.check("energy", energy_growth(x, after, RIG.model, RIG.friction))
    plant = plant_of(RIG)
    record.check("rig = simulation", different_motion(x, volts, design_plant(plant), plant))

"""Floods of parameter changes on a graph in real time."""

from pathlib import Path
from typing import Any

import numpy as np
import parameter_storm
import pytest

from furuta_model.state import EFFORT, THETA
from furuta_recordings.bags.recorded_loop import read_recorded_loop
from furuta_ros import parameter_service


# Storm, graph and recorder together use two processors fully, so that any other load ends the run.
@pytest.mark.realtime
@pytest.mark.long
@pytest.mark.parametrize("rate", [50, 200, 500, 2000])
@pytest.mark.parametrize("changed", [("controller", "omega1", 7.0, 7.1)], ids=lambda c: c[0])
def test_pendulum_stays_upright_while_parameters_are_flooded(
    processes: Any, tmp_path: Path, rate: int, changed: tuple[str, str, float, float]
) -> None:
    """Changes beyond a rate are refused at once, so that samples go on."""
    bag = tmp_path / "bag"
    graph = processes.furuta("run", "--seconds", 8, "--record", bag)
    storm = processes.start(*parameter_storm.COMMAND, *changed, rate, 6)
    out, _ = storm.communicate(timeout=60)
    assert graph.wait(timeout=60) == 0, graph.stderr
    print(out)
    run = read_recorded_loop(bag)
    gaps = np.diff(run.stamps) * 1e-9
    stopped = np.mean(run.measurement[100:, EFFORT] == 0.0)
    angle = float(np.nanmax(np.abs(run.truth[:, THETA])))
    print(f"{rate}/s: longest standstill {gaps.max():.3f} s, at 0 V {stopped:.2%}, "
          f"largest angle {angle:.3f} rad")  # fmt: skip
    assert angle < 0.5
    assert rate <= parameter_service.RATE or " 0 refused" not in out

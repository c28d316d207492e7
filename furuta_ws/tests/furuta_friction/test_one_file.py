"""A compensator with a parameter and a memory is one new file and one line of the registry."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import furuta_friction

PART = """
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from furuta_friction.compensator import Compensator
from furuta_model.compiled import inlined
from furuta_model.parameters import About


@dataclass
class CountingMemory:
    samples: int = 0


class CountingParameters(NamedTuple):
    step: Annotated[float, About("counting: F of a sample", "V", 0, 1)] = 0.5


class Counting(NamedTuple):
    per_sample: float


def design(p: Any) -> Counting:
    return Counting(p.parts.counting.step * p.sample_time)


@inlined
def estimate(memory: Any, x: Any, p: Any) -> float:
    memory.parts.counting.samples += 1
    return memory.parts.counting.samples * p.parts.counting.per_sample


PART = Compensator(
    "counting", "F grows", estimate, parameters=CountingParameters, memory=CountingMemory,
    design=design,
)
"""
RUN = """
import json
from furuta_graph.settings.settings import load_settings, loop
from furuta_sim.simulation.closed_loop import simulate
given = loop(load_settings([], ["compensation=counting", "counting.step=0.25"]))
print(json.dumps(simulate(given, 0.05).friction_estimate.tolist()))
"""


def test_it_works_in_a_simulation(tmp_path: Path) -> None:
    """Its parameter is set by name, its memory is kept from sample to sample."""
    package = tmp_path / "furuta_friction"
    shutil.copytree(Path(furuta_friction.__file__).parent, package)
    (package / "compensators" / "counting.py").write_text(PART)
    registry = package / "compensation.py"
    registry.write_text(registry.read_text().replace('"none",\n', '"none",\n    "counting",\n', 1))
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-c", RUN],
        env={**os.environ, "PYTHONPATH": path, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == [0.25e-3 * k for k in range(1, 51)]

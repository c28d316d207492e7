"""Writes docs/results.md, the figures of this version: ``python docs/site/results.py``.

Limit cycles and the table of truths are computed. The demo and the benchmarks are read from
``output/``: call ``make demo`` and ``make bench`` before. The declaration of quality is text.
"""

import json
import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import furuta

ROOT = Path(__file__).resolve().parents[2]
LAWS = ("coulomb", "stiction", "stribeck", "lugre", "dahl")
# Feedback u = l·x of Fig. 4 a.
FIGURE_4A = (10.0, 4.0, 60.0, 20.0)
MISSING = "Not measured in this version."
# Compensations that the table leaves out, to be narrow enough to read.
OMITTED = ("stiction", "dither")
# The benchmarks that are shown, and their meaning. output/bench.md has all.
SPEED = {
    "core_vs_mujoco_python_tuned": "core over MuJoCo, fastest Python loop",
    "core_vs_mujoco_c": "core over MuJoCo's C code without feedback",
    "core_vs_scipy": "core over scipy's LSODA",
    "core_vs_python_control": "core over python-control",
    "batch_vs_mujoco_python": "lanes, per core, over MuJoCo in Python",
    "core_samples_per_s": "core [samples/s]",
    "batch_samples_per_s": "2000 loops with sensors in lanes [samples/s]",
    "million_loops_seconds": "10⁶ ideal loops of 10 s [s]",
    "amplitude_error": "amplitude error of the core",
    "amplitude_error_mujoco": "amplitude error of MuJoCo (Euler)",
    "amplitude_error_mujoco_rk4": "amplitude error of MuJoCo (RK4)",
    "lockstep_samples_per_s": "graph in lock-step [samples/s]",
    "lockstep_vs_bare_chain": "graph over bare chain of rclpy nodes",
    "lockstep_vs_raw_chain": "graph over chain with serialised messages",
    "latency_p50_s": "latency at 1 kHz, median [s]",
    "latency_p99_s": "latency at 1 kHz, 99th percentile [s]",
    "realtime_overrun_fraction": "late samples at 1 kHz",
}


def table(heads: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """A table in Markdown."""
    first, *others = ["| " + " | ".join(map(str, line)) + " |" for line in (heads, *rows)]
    return "\n".join([first, "|" + "---|" * (first.count("|") - 1), *others])


def demo_table(summary: Path) -> str:
    """The runs of the demo: amplitudes, period, command."""
    if not summary.exists():
        return MISSING
    runs = json.loads(summary.read_text())["runs"]
    keys = ("phi_peak_to_peak_rad", "theta_peak_to_peak_rad", "period_s", "command_rms_v")
    return table(
        ("compensation", "arm [rad]", "pendulum [rad]", "period [s]", "rms u [V]"),
        ((run["compensation"], *(number(run[key], 4) for key in keys)) for run in runs),
    )


def cycle_table() -> str:
    """Exact and predicted limit cycles of every law, for two feedbacks."""
    rows = []
    for name, feedback in (("controller's gain", None), ("Fig. 4 a", FIGURE_4A)):
        for law in LAWS:
            loop = furuta.ideal_loop(law=law, feedback=feedback)
            cycle = furuta.limit_cycle(loop)
            (predicted,) = furuta.predict_cycles(loop).cycles
            rows.append(
                (
                    name,
                    law,
                    number(predicted.phi_peak_to_peak_rad, 4),
                    number(cycle.phi_peak_to_peak_rad, 4),
                    number(cycle.theta_peak_to_peak_rad, 4),
                    number(cycle.period_s, 4),
                    f"{cycle.stuck_fraction:.0%}",
                )
            )
    heads = ("feedback", "law", "predicted arm [rad]", "arm [rad]", "pendulum [rad]")
    return table((*heads, "period [s]", "stuck"), rows)


def truths_table() -> str:
    """Residual of each compensation on each truth, in mrad."""
    command = [str(ROOT / "furuta"), "compare", "--truths", "--json"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    rows = json.loads(done.stdout)["rows"]
    candidates = [
        name for name in dict.fromkeys(r["compensation"] for r in rows) if name not in OMITTED
    ]
    residuals: dict[str, dict[str, Any]] = {}
    for row in rows:
        residuals.setdefault(row["truth"], {})[row["compensation"]] = row["phi_peak_to_peak_rad"]
    return table(
        ("truth", *candidates),
        (
            (truth, *(milliradians(values[candidate]) for candidate in candidates))
            for truth, values in residuals.items()
        ),
    )


def speed_table(bench: Path) -> str:
    """The figures of the last benchmark."""
    if not bench.exists():
        return MISSING
    figures: Mapping[str, Any] = json.loads(bench.read_text())
    rows = ((meaning, number(figures[name], 4)) for name, meaning in SPEED.items())
    return table(("benchmark", "figure"), rows)


def number(value: float | None, digits: int) -> str:
    """A number with some significant digits; a dash for none."""
    return "–" if value is None else f"{value:.{digits}g}"


def milliradians(value: float | None) -> str:
    """An angle [rad] in mrad; a fall has none."""
    return "falls" if value is None else f"{1000.0 * value:.1f}"


def page() -> str:
    """The page."""
    return f"""# Results and quality

`docs/site/results.py` generates this page. The last digits of a figure depend on seed, processor
and library versions. Speeds depend on the machine.

## The demo

`make demo` runs with the paper's sensors and seed 0. Amplitudes are peak to peak over the settled
part. One encoder count is 0.025 rad.

{demo_table(ROOT / "output" / "demo" / "summary.json")}

## Predicted and exact limit cycles

`furuta limit-cycle --predict` and `furuta limit-cycle`, peak to peak. With LuGre and Dahl friction
*stuck* is the fraction of time in which the arm is slower than 10 mrad/s.

{cycle_table()}

## Compensations on truths that they do not know

`furuta compare --truths`: residual motion of the arm, peak to peak [mrad]. One encoder count is
25.1 mrad. The verb also prints stiction compensation and dither.

{truths_table()}

## Speed

`make bench` measures all programs in one run, here on two cores of a virtual machine. They
simulate the ideal loop with a step of 1 ms. Figures with *over* are ratios of rates.
`output/bench.md` has all figures.

{speed_table(ROOT / "output" / "bench.json")}

## Declaration of quality

All packages claim quality level 4 of [REP-2004](https://www.ros.org/reps/rep-2004.html), because
nothing has been released yet. Level 3 would also need reviews by a second person, a coverage
report, which tools cannot make for compiled functions, and a policy for security reports.

- **Versions**: semantic. In 0.x names may still change ([changes](../CHANGELOG.md)).
- **Public interface**: topics, parameters, verbs and the library `furuta`.
- **Changes**: each one passes `.ci/run` in a clean checkout.
- **Documentation**: each feature has a page, and each public name a docstring.
- **Tests**: all features, and numbers against independent integrators.
- **Static analysis**: ruff, and mypy in strict mode.
- **Dependencies**: [CONTRIBUTING](../CONTRIBUTING.md#dependencies) gives a reason for each.
- **Platforms**: tested on Linux x86-64 with Python 3.11. ROS 2 Jazzy from packages is not tested.
- **Security**: [safety](safety.md) says who can connect.
"""


if __name__ == "__main__":
    (ROOT / "docs" / "results.md").write_text(page())

"""Writes docs/paper.md anew: ``python docs/site/paper.py``.

Each row has a command of ``furuta``, and a text with numbers of its JSON.
"""

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import yaml

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
ASYMMETRIC = "--set plant.friction.asymmetry=0.05"
SWEEP = f"sweep seed=0:9 {ASYMMETRIC} --set compensation="
MORE = " --set plant.friction.alpha0=0.273"  # 30 %
RANGE = "{smallest[phi_peak_to_peak_rad]:.3f} to {largest[phi_peak_to_peak_rad]:.3f} rad"
FIGURE_4 = "limit-cycle --law coulomb --feedback "
# A recording of the hanging pendulum, driven by all frequencies at once.
RECORDED = (
    "simulate --seconds 12 --out hanging.csv --set compensation=none "
    "--set plant.initial.theta=3.14159 \\\n"
    "        --set potentiometer_range=3.2 --set tachometer_range=40.0 "
    "--set controller.mode=open_loop \\\n"
    "        --set controller.excitation.kind=multisine "
    "--set controller.excitation.amplitude=1.0 \\\n"
    "        --set controller.excitation.speed_limit=40.0 "
    "--set controller.excitation.excursion_limit=100.0"
)
IDENTIFIED = ", ".join(
    f"{name} = {{{name}:.3f}} ± {{standard_errors[{name}]:.3f}}"
    for name in ("a23", "a43", "b21", "b41")
)


class Row(NamedTuple):
    """What the paper shows at a place, and the command whose JSON fills the text ``here``."""

    place: str
    paper: str
    command: str
    here: str
    difference: str = ""
    before: str = ""


ROWS = (
    Row(
        "(2), (3)",
        "poles 0, 0, ±√a43",
        "linearize",
        "0, 0, ±{open_loop_poles[3][0]:.4f} 1/s",
    ),
    Row(
        "4",
        "a23 = −11, a43 = 33, b21 = 45, b22 = −29; Fc = 0.21",
        "identify hanging.csv --window 1",
        IDENTIFIED + "; Fc = {coulomb:.4f} ± {standard_errors[coulomb]:.4f} V",
        "from 12 s of the simulated rig, whose truth is the paper's numbers; b22 is b41",
        before=RECORDED,
    ),
    Row(
        "(6), (7)",
        "ω₁ = 7, ω₂ = 5, ζ = 0.7; no L",
        "linearize",
        "L = ({L[0]:.3f}, {L[1]:.3f}, {L[2]:.3f}, {L[3]:.3f})",
    ),
    Row(
        "(10), Fig. 3",
        "b₀ = β, b₂ = −δ, a₀ = ζ",
        "linearize --figure-4",
        "Fig. 4 a: b₀ = {nyquist[a][numerator][0]:.5f}, b₂ = {nyquist[a][numerator][2]:.4f}, "
        "a₀ = {nyquist[a][denominator][0]:.3e}",
        "a₀ is αβ − γ²",
    ),
    Row(
        "Fig. 4 a",
        "a limit cycle may occur",
        FIGURE_4 + "10 4 60 20",
        "it does: {phi_peak_to_peak_rad:.4f} rad, {period_s:.3f} s",
    ),
    Row(
        "Fig. 4 b",
        "none",
        FIGURE_4 + "0 0 60 20",
        "{kind}",
        "friction tilts the pendulum, and the feedback of the tilt accelerates the arm",
    ),
    Row(
        "Fig. 4 c",
        "a limit cycle may occur",
        FIGURE_4 + "0 1 60 20",
        "{kind}: the arm rotates at ±{rotation_rate_rad_s:.3f} rad/s",
        "the curve starts on the axis at ω = 0, which means l₂v = F: a rotation, no oscillation",
    ),
    Row(
        "Fig. 4 d",
        "a limit cycle may occur",
        FIGURE_4 + "0 7 60 20",
        "{kind}: the arm rotates at ±{rotation_rate_rad_s:.3f} rad/s",
        "as in case c",
    ),
    Row(
        "3",
        "describing functions predict limit cycles; no number",
        "limit-cycle --predict --law coulomb",
        "{cycles[0][phi_peak_to_peak_rad]:.4f} rad, {cycles[0][period_s]:.3f} s",
        "26 % above the exact cycle: G amplifies the third harmonic, which the method neglects",
    ),
    Row(
        "4.1",
        "released upright without control, a highly irregular motion",
        "simulate --seconds 20 --set controller.enabled=false --set plant.initial.theta=0.001",
        "it falls, and swings through {theta_peak_to_peak_rad:.2f} rad in the last 10 s",
        "friction lets the arm rest while the pendulum falls; depends on the first angle",
    ),
    Row(
        "Fig. 5",
        "limit cycle with stiction, in the simulation stuck a little longer; no number",
        "simulate --seconds 60",
        "{phi_peak_to_peak_rad:.4f} rad, {period_s:.3f} s, stuck for {stuck_fraction:.0%}",
        "with sensors and samples; the next row is without",
    ),
    Row(
        "Fig. 5, exact",
        "not in the paper; two other codes: 0.5106 and 0.0918 rad, 2.370 s",
        "limit-cycle",
        "{phi_peak_to_peak_rad:.4f} and {theta_peak_to_peak_rad:.4f} rad, {period_s:.3f} s",
        "the codes are an implicit solver and the LuGre joint of MuJoCo",
    ),
    Row(
        "Fig. 6",
        "without compensation: asymmetric, stuck at reversals; no number",
        f"sweep seed=0:9 {ASYMMETRIC}",
        RANGE,
        "±5 % by direction is our choice; it shifts the motion by 0.01 rad",
    ),
    Row("Fig. 7", "Coulomb, F̂c = 0.21: smaller; no number", SWEEP + "coulomb", RANGE),
    Row(
        "Fig. 8",
        "LuGre: smaller still; no number",
        SWEEP + "lugre",
        RANGE,
        "both are about one count of the encoder, 0.025 rad",
    ),
    Row(
        "Fig. 9",
        "LuGre, carefully tuned: the resolution of the sensor, 0.025 rad",
        SWEEP + "lugre --set friction_observer.asymmetry=0.05 --set friction_observer.sigma1=1.75",
        RANGE,
        "levels as on the rig, and the best of eleven σ₁",
    ),
    Row(
        "5, [7], [11]",
        "adaptive compensation instead of tuning by hand",
        SWEEP + "adaptive" + MORE,
        RANGE,
        "friction 30 % above the model's",
    ),
    Row("the same friction", "not in the paper", SWEEP + "lugre" + MORE, RANGE),
    Row("the same friction", "not in the paper", SWEEP + "recommended" + MORE, RANGE),
    Row(
        "[4]",
        "passivity of LuGre friction",
        "linearize --passivity",
        "passive: {passive}",
        "σ₂α₀ ≥ σ₁α₁ fails, because the paper has no viscous friction",
    ),
    Row(
        "2.3, [10]",
        "ẑ converges to z without errors of the model",
        "linearize --passivity",
        "condition satisfied: {passivity[satisfied]}",
        "sufficient only; with K = 0 it converges by the distance that the arm travels",
    ),
    Row(
        "4, rig",
        "±10 V by 12 bits, 250 pulses, −π/4 to π/4 by 3.8·10⁻⁴ rad, 1 kHz",
        "param defaults plant",
        "±{actuator[voltage_range]} V by {actuator[bits]} bits, {sensors[encoder_counts]} counts, "
        "±{sensors[potentiometer_range]:.4f} rad by {sensors[potentiometer_bits]} bits, "
        "{sample_time} s",
        "12 bits of π/2 are 3.8·10⁻⁴ rad; the range of the tachometer is not in the paper",
    ),
)
HEAD = f"""# The paper, figure by figure

Gäfvert, Svensson and Åström, *Friction and Friction Compensation in the Furuta Pendulum*, ECC
1999. Each row has a place of the paper, what it says, a command, and what that finds. Sizes are
those of the arm, peak to peak. Exact cycles are right to 10⁻⁶; a range is that of ten seeds of the
noise. The paper's curves are measured on a rig and have no numbers.
[Model](model.md#differences-from-the-printed-paper) lists the misprints.

Row *4* identifies this recording:

    ./furuta {RECORDED}

"""
# What JSON and Python write, as a reader expects it.
WORDS = {"-": "−", "±−": "±", "e−04": "·10⁻⁴", "False": "no", "True": "yes"}
PICTURES = """
Which feedbacks give limit cycles, the subject of reference [15], is a [map](limit-cycles.md#maps).

![Nyquist plots of the four feedbacks of Fig. 4](nyquist.png)

Fig. 4, by `furuta linearize --figure-4 --figure nyquist.png`.

![The simulated rig and the exact limit cycle, with equal and with asymmetric friction](fig5.png)

Figs 5 and 6, by [examples/limit_cycle.py](../examples/limit_cycle.py).

![The last four seconds under Coulomb, LuGre and tuned LuGre compensation](fig9.png)

Figs 7 to 9, by [examples/compensations.py](../examples/compensations.py).
"""


def result_of(command: str, folder: Path) -> dict[str, Any]:
    """What a command prints with ``--json``, or the parameters of a file that it prints."""
    is_file = command.startswith("param")
    words = [
        str(ROOT / "furuta"),
        *command.replace("\\", "").split(),
        *([] if is_file else ["--json"]),
    ]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    if not done.stdout:
        raise RuntimeError(done.stderr)
    found: dict[str, Any] = yaml.safe_load(done.stdout) if is_file else json.loads(done.stdout)
    return found["plant"]["ros__parameters"] if is_file else found


def row_text(row: Row) -> str:
    """A row of the table, computed."""
    with tempfile.TemporaryDirectory() as folder:
        if row.before:
            result_of(row.before, Path(folder))
        here = row.here.format_map(result_of(row.command, Path(folder)))
    for written, read in WORDS.items():
        here = here.replace(written, read)
    return f"| {row.place} | {row.paper} | `{row.command}` | {here} | {row.difference} |\n"


def paper_page() -> str:
    """The whole page."""
    heads = "| place | paper | `furuta` | here | difference, and why |\n|---|---|---|---|---|\n"
    return HEAD + heads + "".join(map(row_text, ROWS)) + PICTURES


if __name__ == "__main__":
    (DOCS / "paper.md").write_text(paper_page(), encoding="utf-8")

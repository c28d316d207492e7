"""Builds the page in one file: ``python docs/site/one_page.py output/furuta.html``."""

import base64
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from page_designs import (
    BASE,
    CONTROL_KNOBS,
    KNOBS,
    PUSHES,
    SELECTING,
    Group,
    design_of,
    groups,
    loop_of,
)
from page_translation import Page, selected, translated

import furuta
from furuta.export.text import filled_text
from furuta.limit_cycles.periodic_orbit import trace
from furuta_hw.emulator.firmware_compiler import run_compiler

ROOT = Path(__file__).parents[2]
HERE = ROOT / "docs" / "site" / "page"
SCENES = ROOT / "furuta_ws/src/furuta_bringup/furuta_bringup/page/guided_scenes.yaml"
OPTIONS = "-std=c99", "-target", "wasm32-freestanding", "-O2", "-ffp-contract=off"
# The only library is the compiler's own, which has fma.
ALONE = "-nodefaultlibs", "-fno-builtin-memset", "-Wl,--no-entry", "-Wl,--strip-all"


def web_assembly(code: str) -> bytes:
    """The C code as WebAssembly."""
    with tempfile.TemporaryDirectory() as folder:
        source, out = Path(folder) / "loop.c", Path(folder) / "loop.wasm"
        source.write_text(code)
        run_compiler("cc", *OPTIONS, *ALONE, "-o", out, source)
        return out.read_bytes()


def encoded(data: bytes) -> str:
    """Bytes as text."""
    return base64.b64encode(data).decode()


def table(group: Group, page: Page) -> dict[str, Any]:
    """A group for the page: its knobs, and which numbers each row puts where."""
    names = [name for name in group.numbers if name not in SELECTING]
    places = [page.places[n] + i for n in names for i in range(group.numbers[n].shape[1])]
    rows = np.hstack([group.numbers[name] for name in names])
    return {
        "knobs": [knob.name for knob in group.knobs],
        "places": places,
        "rows": encoded(rows.astype("<f8").tobytes()),
        "law": [page.laws.get(selected(each, "plant"), 0) for each in group.designs],
        "control": [page.controls.get(selected(each, "control"), 0) for each in group.designs],
    }


def data() -> dict[str, Any]:
    """Everything that the page needs to know."""
    made = groups()
    page = translated(made)
    knobs = {knob.name: knob for group in made for knob in group.knobs}
    design = np.zeros(page.places[PUSHES] + design_of(BASE).numbers[PUSHES].size)
    for name, place in page.places.items():
        numbers = np.ravel(design_of(BASE).numbers[name]).astype(float)
        design[place : place + numbers.size] = numbers
    return {
        "wasm": encoded(web_assembly(page.code)),
        "design": encoded(design.astype("<f8").tobytes()),
        "pushes": page.places[PUSHES],
        "fall_angle": BASE.controller.fall_angle,
        "groups": [table(group, page) for group in made],
        "knobs": [
            {
                "name": knob.name,
                "title": knob.title,
                "meaning": knob.meaning,
                "values": list(knob.values),
                "initial": knob.initial,
            }
            for knob in knobs.values()
        ],
        "scenes": scenes(),
        "cycles": cycles(),
    }


def scenes() -> list[dict[str, Any]]:
    """The guided scenes, with the knobs that each step turns."""
    told = yaml.safe_load(SCENES.read_text())["scenes"]
    for scene in told:
        for step in scene["steps"]:
            step["knobs"] = turned(step.pop("settings", {}), step.pop("times", {}))
    return list(told)


def turned(settings: dict[str, Any], factors: dict[str, float]) -> dict[str, str]:
    """The values of knobs that a step sets. Raises ValueError if no knob sets one of them."""
    base = KNOB_VALUES["1"]
    wanted = settings | {name: factor * base[name] for name, factor in factors.items()}
    found = {
        knob.name: label
        for knobs in KNOBS.values()
        for knob in knobs
        for label, given in knob.values.items()
        if given and given.items() <= wanted.items()
    }
    missing = wanted.keys() - {
        name
        for knobs in KNOBS.values()
        for knob in knobs
        if knob.name in found
        for name in knob.values[found[knob.name]]
    }
    if missing:
        raise ValueError(f"no knob of the page sets {', '.join(sorted(missing))} as a scene does")
    return found


KNOB_VALUES = {
    "1": {
        name: value
        for knobs in KNOBS.values()
        for knob in knobs
        for name, value in knob.values.get("1", {}).items()
    }
}


def cycles() -> dict[str, Any]:
    """The exact cycle and its prediction for each value of the first poles, without compensation.

    ``orbit`` has arm angle and speed [rad, rad/s], ``exact`` and ``predicted`` are the arm's
    motion peak to peak [rad].
    """
    found = {}
    for label, settings in next(k for k in CONTROL_KNOBS if k.name == "omega1").values.items():
        loop = furuta.ideal_loop(loop_of(settings))
        cycle = furuta.limit_cycle(loop)
        predicted = furuta.predict_cycles(loop).cycles
        if cycle.kind != "oscillation" or not np.isfinite(cycle.period_s) or not predicted:
            continue
        orbit = trace(loop, cycle).state[:, :2]
        found[label] = {
            "exact": cycle.phi_peak_to_peak_rad,
            "predicted": predicted[-1].phi_peak_to_peak_rad,
            "orbit": orbit[:: 1 + len(orbit) // 300].round(5).tolist(),
        }
    return found


def build(out: Path) -> int:
    """Write the page; return its size in bytes."""
    html = filled_text(
        (HERE / "page.html").read_text(),
        style=(HERE / "page.css").read_text(),
        data=json.dumps(data()).replace("</", "<\\/"),
        script=(HERE / "loop.js").read_text() + (HERE / "page.js").read_text(),
    )
    out.parent.mkdir(parents=True, exist_ok=True)
    return out.write_text(html)


if __name__ == "__main__":
    written = build(Path(sys.argv[1]))
    print(f"{sys.argv[1]}: {written / 1000:.0f} kB")

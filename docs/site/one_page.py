"""Builds the page in one file: ``python docs/site/one_page.py output/furuta.html``.

With ``--package`` it writes the page into the package, and what it uses of three.js: after a change
of the page, of the closed loop or of the version of three.js.
"""

import base64
import gzip
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from page_designs import (
    ALL_KNOBS,
    BASE,
    LEVELS,
    PUSHES,
    SELECTING,
    STRENGTH,
    Group,
    Knob,
    design_of,
    groups,
    loop_of,
)
from page_translation import Page, selected, translated

from furuta.loops import ideal_loop
from furuta.quantities import QUANTITIES
from furuta_bringup.page.exact_cycle import described_cycle
from furuta_bringup.page.one_file import PACKED
from furuta_friction.compensation import TITLES
from furuta_hw.emulator.firmware_compiler import run_compiler

ROOT = Path(__file__).parents[2]
HERE = ROOT / "docs" / "site" / "page"
# The page of `furuta view`, which this one is too.
PACKAGE = ROOT / "furuta_ws/src/furuta_bringup/furuta_bringup/page"
WEB = PACKAGE / "web"
DECLARED = yaml.safe_load((PACKAGE / "guided_scenes.yaml").read_text(encoding="utf-8"))
MODULES = ROOT / "output" / "page" / "node_modules"
BUNDLER = MODULES / ".bin" / "esbuild"
OPTIONS = "-std=c99", "-target", "wasm32-freestanding", "-O2", "-ffp-contract=off"
# What one file has in place of what a server sends: its own policy, and all that it needs.
POLICY = (
    '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; '
    "script-src 'unsafe-inline' 'wasm-unsafe-eval'; style-src 'unsafe-inline'; "
    'img-src blob: data:">'
)
STYLE = '<link rel="stylesheet" href="page.css">'
SCRIPT = '<script type="module" src="page.js"></script>'
DATA = "@data@"
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
    design = np.zeros(page.places[PUSHES] + design_of(BASE).numbers[PUSHES].size)
    for name, place in page.places.items():
        numbers = np.ravel(design_of(BASE).numbers[name]).astype(float)
        design[place : place + numbers.size] = numbers
    return {
        "wasm": encoded(web_assembly(page.code)),
        "design": encoded(design.astype("<f8").tobytes()),
        "pushes": page.places[PUSHES],
        "strength": [place for name, place in page.places.items() if name.endswith("_strength")],
        "fall_angle": BASE.controller.balance.fall_angle,
        "encoder_counts": BASE.plant.sensors.encoder_counts,
        "groups": [table(group, page) for group in made],
        "knobs": [shown(knob) for knob in sorted(ALL_KNOBS.values(), key=rank)],
        "measured": DECLARED["measured"],
        "scenes": [scene | {"steps": steps(scene["steps"])} for scene in DECLARED["scenes"]],
        "words": DECLARED["words"],
        "what_if": steps(DECLARED["what_if"]),
        "cycles": cycles(),
        "lengths": [BASE.plant.model.arm_length, BASE.plant.model.pendulum_length],
        "quantities": {name: each._asdict() for name, each in QUANTITIES.items()},
    }


def rank(knob: Knob) -> int:
    """Place on the page: those in sight come first, in their order."""
    names = list(DECLARED["in_sight"])
    return names.index(knob.shows) if knob.shows in names else len(names)


def shown(knob: Knob) -> dict[str, Any]:
    """A knob as the page shows it: one that multiplies a number is a slider that shows it."""
    plain = DECLARED["in_sight"].get(knob.shows, {})
    words = TITLES if knob.name == "compensation" else knob.words
    idle = {
        other.name: value
        for name, value in plain.get("idle", {}).items()
        for other in ALL_KNOBS.values()
        if other.shows == name
    }
    base = {"base": BASE_VALUES[knob.shows]} if knob.shows in BASE_VALUES else {}
    return {
        "name": knob.name,
        "title": plain.get("name", knob.title),
        "symbol": plain.get("symbol", ""),
        "meaning": knob.meaning,
        "values": list(knob.values),
        "words": [words.get(value, value) for value in knob.values],
        "initial": knob.initial,
        "unit": knob.unit,
        "in_sight": bool(plain) and knob.shows != STRENGTH,
        "idle": idle or None,
        **base,
    }


def steps(told: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Steps of a scene or what-ifs, with the knobs that they turn instead of their settings."""
    return [
        {
            **{key: step[key] for key in step.keys() - {"settings", "times"}},
            "knobs": turned(step.get("settings", {}), step.get("times", {})),
        }
        for step in told
    ]


def turned(settings: dict[str, Any], factors: dict[str, float]) -> dict[str, str]:
    """The values of knobs that a step sets. Raises ValueError if no knob sets one of them."""
    wanted = settings | {name: factor * BASE_VALUES[name] for name, factor in factors.items()}
    found = {
        knob.name: label
        for knob in ALL_KNOBS.values()
        for label, given in knob.values.items()
        if given and given.items() <= wanted.items()
    }
    missing = wanted.keys() - {
        name for knob, label in found.items() for name in ALL_KNOBS[knob].values[label]
    }
    if missing:
        raise ValueError(f"no knob of the page sets {', '.join(sorted(missing))} as a scene does")
    return found


BASE_VALUES = {
    name: value for knob in ALL_KNOBS.values() for name, value in knob.values.get("1", {}).items()
}


def cycles() -> dict[str, Any]:
    """The exact cycle and its prediction without compensation, by friction level and first poles.

    For each level with the usual poles, and for all poles at the usual level.
    """
    levels, poles = (ALL_KNOBS[name].values for name in ("level", "omega1"))
    wanted = {(f"{level:g}", "1") for level in LEVELS} | {("1", pole) for pole in poles}
    found = {}
    for level, pole in sorted(wanted):
        loop = ideal_loop(loop_of({**levels[level], **poles[pole]}))
        if cycle := described_cycle(loop):
            found[f"{level} {pole}"] = cycle
    return found


def bundled(entry: Path, *options: str) -> str:
    """A script with all that it imports, minified; `make page-tools` installs what is needed."""
    usual = "--bundle", "--minify", "--format=esm", "--target=es2022", "--log-level=warning"
    command = [str(BUNDLER), str(entry), *usual, *options]
    found = os.environ | {"NODE_PATH": str(MODULES)}
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, env=found)
    return done.stdout


def library() -> dict[str, str]:
    """What the stage uses of three.js, and its licence, by the names of their files."""
    script = bundled(HERE / "three_parts.js", "--legal-comments=inline")
    licence = (MODULES / "three" / "LICENSE").read_text(encoding="utf-8")
    return {"three.js": script, "three.LICENSE": licence}


def built_page() -> str:
    """The page, HTML with all that it needs."""
    html = (WEB / "page.html").read_text(encoding="utf-8")
    script = bundled(WEB / "page.js").replace("</script", "<\\/script")
    style = (WEB / "page.css").read_text(encoding="utf-8")
    for part, content in {
        STYLE: f"{POLICY}\n<style>{style}</style>",
        DATA: encoded(gzip.compress(json.dumps(data()).encode(), mtime=0)),
        SCRIPT: f'<script type="module">{script}</script>',
    }.items():
        before, after = html.split(part)
        html = before + content + after
    return html


def packed() -> dict[Path, bytes]:
    """The files of the package that this builds."""
    scripts = {WEB / name: content.encode() for name, content in library().items()}
    return scripts | {PACKAGE / PACKED: gzip.compress(built_page().encode(), mtime=0)}


def main(target: str) -> None:
    """Write the page into a file, or into the package."""
    given = {Path(target): built_page().encode()} if target != "--package" else packed()
    for path, content in given.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        print(f"{path}: {len(content) / 1000:.0f} kB")


if __name__ == "__main__":
    main(*sys.argv[1:])

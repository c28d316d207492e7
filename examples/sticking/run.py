"""Put simulators of joints through the scenes of scenes.json: a table and a picture.

python run.py mujoco mujoco-lugre my_engine.py --out sticking

Each engine is a file with_NAME.py here, or a file of your own: see README.md. It needs that engine,
numpy and matplotlib, and nothing else of this project.
"""

import argparse
import json
import runpy
from collections import defaultdict
from math import inf, isfinite, nan, pi, sin
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

HERE = Path(__file__).parent
FILE = json.loads((HERE / "scenes.json").read_text())
STEPS = FILE["steps_s"]
RIGHT, STILL, SOFT = 0.01, 1e-4, 0.2
COLOURS = {"right": "#8fce8f", "soft": "#ffe08a", "wrong": "#f09a9a", "not offered": "#eeeeee"}
Scene = dict[str, Any]


def load(engine: str) -> tuple[SimpleNamespace, str]:
    """The names of an engine's file, and the variant."""
    own = engine.endswith(".py")
    name, _, variant = engine.partition("-")
    path = Path(engine) if own else HERE / f"with_{name}.py"
    if not path.exists():
        known = ", ".join(sorted(p.stem[5:] for p in HERE.glob("with_*.py")))
        raise SystemExit(f"error: there is no engine {engine}; give a file.py, or one of {known}")
    return SimpleNamespace(**runpy.run_path(str(path))), "" if own else variant


def torque(scene: Scene, t: float, q: float, v: float, integral: float) -> float:
    """The torque of a scene [N m]; ``integral`` is that of e."""
    p = defaultdict(float, scene["torque"])
    control = p["kp"] * (p["speed"] * t - q) + p["ki"] * integral + p["kd"] * (p["speed"] - v)
    wave = p["amplitude"] * sin(2.0 * pi * p["frequency"] * t)
    return p["constant"] + p["rate"] * t + wave + control


def simulate(module: SimpleNamespace, variant: str, scene: Scene, step: float) -> np.ndarray:
    """Rows of time, angle, speed and e, at the start and after each step."""
    q, v = scene["start"]["angle"], scene["start"]["speed"]
    p = {"viscous": 0.0, "height": scene["parameters"].get("gravity", 0.0) / 9.81}
    p |= scene["parameters"] | {"moment": scene["parameters"]["inertia"] - p["height"] ** 2}
    move = module.joint(scene["law"], p, q, v, step, variant)
    rows, integral = np.full((round(scene["seconds"] / step) + 1, 4), nan), 0.0
    for k in range(len(rows)):
        e = scene["torque"].get("speed", 0.0) * k * step - q
        rows[k] = k * step, q, v, e
        integral += step * e
        q, v = move(torque(scene, k * step, q, v, integral))
        if not abs(q) < 1e6:
            break
    return rows


def value(rows: np.ndarray, measured: dict[str, Any]) -> float:
    """What is measured, from the rows of a simulation."""
    t, q, v, e = rows.T
    what = measured["what"]
    if what == "angle":
        return float(q[-1])
    if what == "passes":
        k = int(np.argmax(q >= measured["angle"]))
        near = slice(k - 1, k + 1)
        return float(np.interp(measured["angle"], q[near], t[near])) if k else inf
    since = t >= measured["from"] - 1e-9
    if what == "fastest":
        return float(np.abs(v[since]).max())
    late = e[since]
    size = float(np.ptp(late))
    if what == "peak_to_peak":
        return size
    high = late > late.min() + 0.5 * size
    crossings = np.flatnonzero(high[1:] & ~high[:-1])
    moves = size > 0.01 and len(crossings) > 1
    return (t[1] - t[0]) * float(np.diff(crossings).mean()) if moves else inf


def error(found: float, measured: dict[str, Any]) -> float:
    """The error relative to the exact value, or to the scale where that is 0."""
    return abs(found - measured["exact"]) / measured["scale"] if isfinite(found) else inf


def verdict(found: list[float], scene: Scene) -> str:
    """The judgement of scenes.json on the values of the shortest step."""
    worst = 0
    for one, measured in zip(found, scene["measured"], strict=True):
        off = error(one, measured)
        close = off <= RIGHT if measured["exact"] else abs(one) <= STILL
        worst = max(worst, 0 if close else 1 if off <= SOFT else 2)
    return ("right", "soft", "wrong")[worst]


def tried(engine: str) -> dict[str, Any]:
    """Name, version, and for each scene the verdict and the values by time step."""
    module, variant = load(engine)
    if variant not in module.LAWS:
        raise SystemExit(f"error: {engine} is not a variant; there are {sorted(module.LAWS)}")
    result: dict[str, Any] = {"engine": engine, "version": module.VERSION, "scenes": {}}
    for scene in FILE["scenes"]:
        if scene["law"] not in module.LAWS[variant]:
            result["scenes"][scene["name"]] = {"verdict": "not offered", "values": []}
            continue
        runs = [simulate(module, variant, scene, step) for step in STEPS]
        values = [[value(rows, each) for each in scene["measured"]] for rows in runs]
        found = {"verdict": verdict(values[-1], scene), "values": values}
        result["scenes"][scene["name"]] = found
        text = "; ".join(" ".join(f"{one:.5g}" for one in each) for each in values)
        print(f"{engine:15} {scene['name']:11} {found['verdict']:6} {text}", flush=True)
    return result


def cell(found: dict[str, Any], scene: Scene) -> str:
    """The verdict, and the largest error at the longest and the shortest step."""
    errors = [
        max(error(*pair) for pair in zip(values, scene["measured"], strict=True))
        for values in found["values"]
    ]
    if not errors or (found["verdict"] == "right" and max(errors) < STILL):
        return found["verdict"]
    first, last = (f"{100.0 * off:.2g}" if off < 1.0 else ">100" for off in (errors[0], errors[-1]))
    return f"{found['verdict']} {last if first == last else f'{first} → {last}'} %"


def table(results: list[dict[str, Any]]) -> str:
    """The results as a table in Markdown."""
    scenes = FILE["scenes"]
    lines = ["| | " + " | ".join(scene["name"] for scene in scenes) + " |", "|---" * 13 + "|"]
    for result in results:
        cells = [cell(result["scenes"][scene["name"]], scene) for scene in scenes]
        text = " | ".join(cells).replace("not offered", "–")
        lines.append(f"| {result['engine']} {result['version']} | {text} |")
    return "\n".join(lines)


def draw(results: list[dict[str, Any]], path: Path) -> None:
    """The picture: scene by engine, coloured by verdict."""
    names = [scene["name"] for scene in FILE["scenes"]]
    figure, axes = plt.subplots(figsize=(1.0 + 1.15 * len(results), 5.0))
    for x, result in enumerate(results):
        for y, scene in enumerate(FILE["scenes"]):
            found = result["scenes"][scene["name"]]
            axes.add_patch(plt.Rectangle((x, y), 0.96, 0.92, color=COLOURS[found["verdict"]]))
            words = cell(found, scene).replace(" ", "\n", found["verdict"] != "not offered")
            axes.text(x + 0.48, y + 0.46, words, ha="center", va="center", fontsize=7)
    heads = [f"{r['engine'].replace('-', chr(10))}\n{r['version']}" for r in results]
    axes.set_xticks(np.arange(len(results)) + 0.48, heads, fontsize=9)
    axes.set_yticks(np.arange(len(names)) + 0.46, names)
    axes.set(xlim=(0, len(results)), ylim=(len(names), 0))
    axes.tick_params(length=0, labeltop=True, labelbottom=False)
    axes.spines[:].set_visible(False)
    figure.savefig(path, dpi=80, bbox_inches="tight")


def main() -> None:
    """Run the engines that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("engines", nargs="+", help="NAME or NAME-VARIANT, or your file.py")
    parser.add_argument("--out", default="sticking", help="OUT.png and OUT.json; adds to OUT.json")
    arguments = parser.parse_args()
    kept = Path(f"{arguments.out}.json")
    results = {r["engine"]: r for r in (json.loads(kept.read_text()) if kept.exists() else [])}
    for engine in arguments.engines:
        results[engine] = tried(engine)
        kept.write_text(json.dumps(list(results.values()), indent=1))
    print(table(list(results.values())))
    draw(list(results.values()), Path(f"{arguments.out}.png"))


if __name__ == "__main__":
    main()

"""The page in one file computes what Python computes, to the last bit, and needs nothing else."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterator
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import page_designs as designs
import pytest
from browser import OPTIONS, browser_path
from one_page import build

from furuta_model.block import block
from furuta_model.compiled import compiled
from furuta_model.parts.disturbances import Pushes
from furuta_model.state import APPLIED_TORQUE, SIGNALS
from furuta_sim.plant import initial_plant, move, read, true_friction
from furuta_sim.simulation.closed_loop import LoopMemory, new_memory
from furuta_sim.simulation.control_system import control_sample

pytest.importorskip("ziglang", reason="pip install -r firmware/requirements.lock")

RESULTS = 13
# A push that lets the pendulum fall in some of the cases: first sample, samples, torques [V].
PUSH = (300, 100, 0.5, 0.3)
CASES: dict[str, dict[str, str]] = {
    "noise": {"compensation": "recommended", "believed": "0.5"},
    "belt": {"belt": "50", "compensation": "recommended", "level": "1.5"},
    "swing_up": {"mode": "swing up", "compensation": "lugre"},
    "adaptive": {"stiffness": "3", "compensation": "adaptive"},
    "off": {"mode": "off"},
}


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built page."""
    out = tmp_path_factory.mktemp("page") / "furuta.html"
    build(out)
    return out


def python_results(knobs: dict[str, str], noise: np.ndarray) -> np.ndarray:
    """State with bristle, estimate, friction, its estimate and command (n, RESULTS)."""
    all_knobs = [knob for group in designs.KNOBS.values() for knob in group]
    chosen = [knob.values[knobs[knob.name]] for knob in all_knobs if knob.name in knobs]
    loop = designs.loop_of({name: value for each in chosen for name, value in each.items()})
    first, samples, arm, pendulum = PUSH
    dt = loop.plant.sample_time
    push = Pushes((first * dt,), (samples * dt,), (arm,), (pendulum,))
    loop = loop._replace(plant=loop.plant._replace(pushes=push))
    plant, control = designs.design_of(loop)
    memory = new_memory(LoopMemory)
    memory["plant"] = initial_plant(loop.plant)
    results = np.empty((len(noise), RESULTS))
    _run(memory, noise, plant, block(control), results)
    return results


@compiled
def _run(memory: Any, noise: Any, plant: Any, control: Any, results: Any) -> None:
    loop, measurement, estimate = memory[0], np.empty(SIGNALS), np.empty(SIGNALS)
    for k in range(len(noise)):
        read(loop.plant, noise[k], plant, measurement)
        measurement[APPLIED_TORQUE] = loop.torque
        estimated, u = control_sample(loop.control, measurement, control[0], estimate)
        results[k, :5], results[k, 5:10] = loop.plant.x, estimate
        results[k, 10] = true_friction(loop.plant, plant)
        results[k, 11], results[k, 12] = estimated, u
        loop.torque = move(loop.plant, u, plant)


def assert_same(results: np.ndarray, expected: np.ndarray) -> None:
    """The same bits; a NaN is a NaN, whichever."""
    differs = (results != expected) & ~(np.isnan(results) & np.isnan(expected))
    assert not differs.any(), np.argwhere(differs)[0]
    assert np.ptp(expected[:, 0]) > 0.01


@pytest.fixture(scope="module")
def page(page_file: Path) -> Iterator[Any]:
    """The page in Chromium without a network, with ``failures`` and ``requests`` as lists."""
    path = browser_path()
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - not where it is skipped

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=OPTIONS)
        opened: Any = browser.new_context(
            offline=True, viewport={"width": 1280, "height": 800}
        ).new_page()
        opened.failures, opened.requests = [], []
        opened.on("pageerror", lambda error: opened.failures.append(str(error)))
        opened.on("request", lambda request: opened.requests.append(request.url))
        opened.began = monotonic()
        opened.goto(page_file.as_uri())
        opened.wait_for_function("history.length > 0")
        opened.began = monotonic() - opened.began
        yield opened
        browser.close()


def test_it_is_small_and_asks_for_nothing(page: Any, page_file: Path) -> None:
    """Below 1 MB, and one request: that for the file."""
    assert page_file.stat().st_size < 1e6
    page.wait_for_timeout(1000)
    print(f"first motion after {page.began:.2f} s, {page.evaluate('frames')} frames in 1 s")
    assert page.requests == [page_file.as_uri()]
    assert not page.failures
    assert not re.search(r"(?:src|href)=|url\(|fetch\(|https?:", page_file.read_text())


@pytest.mark.parametrize("case", CASES)
def test_samples_have_the_same_bits(case: str, page: Any) -> None:
    """In the browser, from the same noise."""
    noise = np.random.default_rng(0).standard_normal((3000, 2))
    code = (
        "([knobs, push, noise]) => { const one = new Loop(DATA); one.turn(knobs);"
        "one.signals[13] = push[0]; one.push(...push.slice(1)); one.signals[13] = 0;"
        "let text = ''; for (const byte of new Uint8Array(one.replay("
        "Float64Array.from(noise)).buffer)) text += String.fromCharCode(byte); return btoa(text); }"
    )
    given = page.evaluate(code, [CASES[case], PUSH, noise.ravel().tolist()])
    results = np.frombuffer(base64.b64decode(given)).reshape(-1, RESULTS)
    assert_same(results, python_results(CASES[case], noise))


def test_scenes_show_what_they_say(page: Any) -> None:
    """The motion is the exact cycle's, compensation reduces it, and a fall is said.

    Under compensation the motion is irregular: its size is the median of five windows of 5 s.
    """
    sizes = []
    for scene, step in ((0, 0), (0, 1), (1, 1), (2, 1), (2, 2), (2, 3)):
        page.evaluate(f"enter({scene}, {step}); advance(20000)")
        windows = "[1, 2, 3, 4, 5].map(() => { advance(5000); return measured()[0]; })"
        sizes.append(np.median(page.evaluate(windows)))
    exact = page.evaluate("DATA.cycles['1'].exact"), page.evaluate("DATA.cycles['1.5'].exact")
    assert sizes[0] == pytest.approx(exact[0], rel=0.02)
    assert sizes[2] == pytest.approx(exact[1], rel=0.05)
    assert sizes[0] > sizes[3] > sizes[4] > sizes[5]
    assert sizes[1] < 0.1 * sizes[0]
    page.evaluate("enter(4, 1); advance(10000); tell()")
    assert page.locator("#fallen").is_visible()
    page.keyboard.press("r")
    page.evaluate("tell()")
    assert not page.locator("#fallen").is_visible()
    page.evaluate("enter(4, 2); advance(30000)")
    assert page.evaluate("Math.cos(loop.signals[2])") > 0.99
    assert not page.failures

"""The page in one file computes what Python computes, to the last bit, and needs nothing else."""

from __future__ import annotations

import base64
import csv
import gzip
import json
import re
import struct
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import page_designs as designs
import pytest
from browser import open_browser
from one_page import BUNDLER, WEB, built_page, library
from page_scenes import check_every_scene, check_looking_back

from furuta_bringup.page.one_file import one_file
from furuta_model.parts.disturbances import Pushes
from furuta_sim.simulation.closed_loop import simulate

pytest.importorskip("ziglang", reason="pip install -r firmware/requirements.lock")
if not BUNDLER.exists():
    pytest.skip("`make page-tools` installs what bundles the page", allow_module_level=True)

SAMPLES, RESULTS = 3000, 12
BRISTLE = 4  # a column that the page has too
# A push that lets the pendulum fall in some of the cases: first sample, samples, torques [V].
PUSH = (300, 100, 0.5, 0.3)
CASES: dict[str, dict[str, str]] = {
    "noise": {"compensation": "recommended", "believed": "0.5"},
    "belt": {"belt": "50", "compensation": "recommended", "level": "1.5"},
    "swing_up": {"mode": "swing up", "compensation": "lugre"},
    "adaptive": {"stiffness": "3", "compensation": "adaptive"},
    "off": {"mode": "off"},
    "late": {"motor": "late", "compensation": "lugre", "strength": "0.3", "level": "2"},
    "weak": {"compensation": "recommended", "strength": "0.3"},
}
SECOND = 1000  # samples


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built page."""
    out = tmp_path_factory.mktemp("page") / "furuta.html"
    out.write_text(built_page())
    return out


def python_results(knobs: dict[str, str], samples: int) -> np.ndarray:
    """State, estimate, friction, its estimate and command (n, RESULTS) of a simulation."""
    chosen = [designs.ALL_KNOBS[name].values[value] for name, value in knobs.items()]
    loop = designs.loop_of({name: value for each in chosen for name, value in each.items()})
    first, length, arm, pendulum = PUSH
    dt = loop.plant.sample_time
    push = Pushes((first * dt,), (length * dt,), (arm,), (pendulum,))
    run = simulate(loop._replace(plant=loop.plant._replace(pushes=push)), samples * dt)
    series = run.state, run.estimate, run.friction, run.friction_estimate, run.command
    return np.column_stack(series)


def assert_same(results: np.ndarray, expected: np.ndarray) -> None:
    """The same bits; a NaN is a NaN, whichever."""
    differs = (results != expected) & ~(np.isnan(results) & np.isnan(expected))
    assert not differs.any(), np.argwhere(differs)[0]
    assert np.ptp(expected[:, 0]) > 0.01


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Opens pages without a network."""
    with open_browser() as show:
        yield partial(show, offline=True)


@pytest.fixture(scope="module")
def opened(browser: Any, page_file: Path) -> Any:
    """The page, opened once."""
    return browser(page_file.as_uri())


@pytest.fixture
def page(opened: Any) -> Any:
    """The same for playwright."""
    return opened.page


def test_it_is_small_and_asks_for_nothing(opened: Any, page_file: Path) -> None:
    """At most 700 kB, and one request: that for the file. Its own policy allows no other one."""
    assert page_file.stat().st_size < 7e5
    assert opened.requests == [page_file.as_uri()]
    assert opened.errors == []
    assert "default-src 'none'" in page_file.read_text()
    own = "".join(file.read_text() for file in WEB.glob("*.[jhc][st]*") if file.stem != "three")
    assert not re.search(r"url\(|fetch\(|https?:", own)
    assert {"page.css", "page.js", "data:,"} == set(re.findall(r'(?:src|href)="([^"]*)"', own))


def test_three_js_in_the_package_is_what_the_stage_uses() -> None:
    """Of the version of package.json, with its licence."""
    for name, content in library().items():
        assert (WEB / name).read_text() == content


def test_the_page_in_the_package_is_current(page_file: Path) -> None:
    """Its text and code are the same; its numbers up to what another processor rounds."""
    data = re.compile(r'(?<=text/plain">)[^<]*')
    pages = one_file().decode(), page_file.read_text()
    packed, built = (data.sub("", page) for page in pages)
    assert packed == built, "python docs/site/one_page.py --package"
    found = (data.search(page) for page in pages)
    assert_close(*(json.loads(gzip.decompress(base64.b64decode(f[0]))) for f in found if f))


def assert_same_code(packed: bytes, built: bytes) -> None:
    """The same instructions, whose constants are the same to nine digits."""
    assert len(packed) == len(built)
    constant = b"\x44"  # f64.const, before eight bytes
    for at in [k for k, pair in enumerate(zip(packed, built, strict=True)) if pair[0] != pair[1]]:
        begins = [k + 1 for k in range(at - 8, at) if packed[k : k + 1] == constant]
        pairs = [
            [struct.unpack("<d", code[begin : begin + 8])[0] for code in (packed, built)]
            for begin in begins
        ]
        assert any(np.isclose(*pair, rtol=1e-9, atol=0.0) for pair in pairs), at


def assert_close(packed: Any, built: Any, key: str = "") -> None:
    """The same structure and text; numbers, also those in encoded tables, to nine digits."""
    assert type(packed) is type(built), key
    if isinstance(packed, dict):
        assert packed.keys() == built.keys(), key
        for name in packed:
            assert_close(packed[name], built[name], name)
    elif isinstance(packed, list):
        assert len(packed) == len(built), key
        for pair in zip(packed, built, strict=True):
            assert_close(*pair, key)
    elif key in ("rows", "design"):
        tables = [np.frombuffer(base64.b64decode(text)) for text in (packed, built)]
        np.testing.assert_allclose(*tables, rtol=1e-9, atol=1e-9, err_msg=key)
    elif key == "wasm":
        assert_same_code(*(base64.b64decode(text) for text in (packed, built)))
    else:
        expected = pytest.approx(built, rel=1e-6) if isinstance(built, float) else built
        assert packed == expected, key


@pytest.mark.parametrize("case", CASES)
def test_samples_have_the_same_bits(case: str, page: Any) -> None:
    """In the browser, from the same noise."""
    noise = np.random.default_rng(0).standard_normal((SAMPLES, 2))  # that of the simulation
    code = (
        "([knobs, push, noise]) => { const one = new page.Loop(page.DATA); one.set(knobs);"
        "one.signals[13] = push[0]; one.push(...push.slice(2), push[1]); one.signals[13] = 0;"
        "let text = ''; for (const byte of new Uint8Array(one.replay("
        "Float64Array.from(noise)).buffer)) text += String.fromCharCode(byte); return btoa(text); }"
    )
    given = page.evaluate(code, [CASES[case], PUSH, noise.ravel().tolist()])
    results = np.frombuffer(base64.b64decode(given)).reshape(-1, 1 + RESULTS)
    assert_same(np.delete(results, BRISTLE, 1), python_results(CASES[case], SAMPLES))


def run(page: Any, seconds: float) -> None:
    """Let time pass, faster than it does."""
    page.evaluate(f"page.motion.advance({seconds * SECOND}); page.tell()")


def test_every_scene_to_its_end(opened: Any, page: Any) -> None:
    """As the page computes it."""
    page.evaluate("page.state.paused = true; page.enter(0, 0)")
    check_every_scene(page, run)
    assert opened.errors == []


def test_looking_back(page: Any) -> None:
    """Also after a fall: one sees what happened."""
    page.evaluate("page.state.paused = true; page.enter(4, 1); page.motion.reset()")
    run(page, 12.0)
    page.evaluate("page.motion.push(0, 1)")
    run(page, 3.0)
    assert page.evaluate("page.motion.fell")
    check_looking_back(page)


def test_links_and_files_hold_the_settings(browser: Any, page_file: Path) -> None:
    """A shared link shows the same; a wrong one is refused with its reason."""
    shown = browser(page_file.as_uri() + "#scene=2&level=2&compensation=lugre&motor=late")
    page = shown.page
    assert page.locator("#knob-compensation").input_value() == "lugre"
    assert page.locator("#sliders output").first.inner_text() == "0.42 V"
    pressed = page.locator("#chips [aria-pressed=true]")
    assert pressed.all_inner_texts() == ["twice the friction", "a slow motor"]
    assert page.locator("fieldset label").last.inner_text().startswith("your settings")
    pressed.last.click()
    page.locator("#share").click()
    assert page.evaluate("location.hash") == "#scene=2&compensation=lugre&level=2"
    page.goto(page_file.as_uri() + "#scene=2&level=9")
    page.locator("#toast", has_text="level=9").wait_for()
    with page.expect_download() as numbers:
        page.locator("#numbers").click()
    rows = list(csv.DictReader(Path(numbers.value.path()).read_text().splitlines()))
    assert {"time_s", "phi_rad", "friction_estimate_v"} <= rows[0].keys()
    with page.expect_download() as picture:
        page.locator("#picture").click()
    assert Path(picture.value.path()).read_bytes()[:4] == b"\x89PNG"
    assert shown.errors == []


def test_the_pendulum_can_be_grabbed(page: Any) -> None:
    """It follows the pointer, and is let go where it is; keys push, reset and pause."""
    page.evaluate("page.state.paused = true; page.enter(2, 3); page.drawing.drawAll()")
    box = page.locator("#stage").bounding_box()
    x, y = page.evaluate("page.drawing.stage.pixels('pendulum', ...page.motion.pose)")
    page.mouse.move(box["x"] + x, box["y"] + y)
    page.mouse.down()
    page.mouse.move(box["x"] + x + 15, box["y"] + y, steps=5)
    held = page.evaluate("page.motion.pose[1]")
    assert abs(held) > 0.1
    page.mouse.up()
    page.keyboard.press(" ")
    assert page.evaluate("page.state.paused")
    run(page, 4.0)
    assert abs(page.evaluate("page.source.signals[2]")) < 0.01  # it is balanced again
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("ArrowRight")
    run(page, 0.05)
    assert page.evaluate("page.source.signals[1]") > 0.1
    page.keyboard.press("r")
    assert page.evaluate("[page.source.time, page.source.signals[0]]") == [0, 0]
    page.locator("fieldset input").first.focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    assert page.locator("fieldset input:focus").count() == 1
    assert page.evaluate("page.state.step") == 2


NARROW = [(820, 1180), (1024, 768), (844, 390), (390, 844)]


def test_the_chart_of_the_step_is_in_sight(browser: Any, page_file: Path) -> None:
    """On tablets, old projectors and phones, without scrolling; parameters are folded."""
    page = browser(page_file.as_uri(), *NARROW[0]).page
    assert not page.evaluate("document.querySelector('#more').open")
    for width, height in NARROW:
        page.set_viewport_size({"width": width, "height": height})
        box = page.locator("figure.named").bounding_box()
        assert box["y"] + box["height"] <= height, (width, height)
        assert page.evaluate("document.documentElement.scrollWidth") == width
    page.close()


def test_in_front_of_people(browser: Any, page_file: Path) -> None:
    """One chart beside the pendulum, nothing to scroll, words of 22 pixels; keys choose scenes."""
    shown = browser(page_file.as_uri() + "?present", 1280, 720, color_scheme="dark")
    page = shown.page
    for key, chart in (("1", "angles"), ("2", "phase"), ("4", "voltages")):
        page.keyboard.press(key)
        (canvas,) = page.locator("figure canvas:visible").all()
        assert canvas.get_attribute("id") == chart
        assert canvas.evaluate("(each) => getComputedStyle(each).fontSize") == "22px"
        box, stage = canvas.bounding_box(), page.locator("#stage").bounding_box()
        assert box["height"] > 250
        assert box["x"] > stage["x"] + stage["width"]
        assert page.evaluate("document.documentElement.scrollHeight") == 720
    words = "#scene h2, .look, fieldset span, .key dt, nav span, figcaption b"
    size = "(each) => parseFloat(getComputedStyle(each).fontSize)"
    assert min(each.evaluate(size) for each in page.locator(words).all() if each.is_visible()) >= 22
    assert shown.serious_violations("body") == []
    page.close()


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (390, "dark")])
def test_everybody_can_use_it(browser: Any, page_file: Path, width: int, scheme: str) -> None:
    """Axe-core finds nothing serious, nothing is wider than the page, and motion can wait."""
    about = {"color_scheme": scheme, "reduced_motion": "reduce"}
    shown = browser(page_file.as_uri() + "#scene=4&step=1", width, 844, **about)
    page = shown.page
    assert page.evaluate("page.state.paused")
    page.evaluate(
        "page.motion.advance(9000); page.tell(); document.querySelector('#more').open = true"
    )
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert shown.serious_violations("body") == []
    page.close()

"""``furuta view`` as a user has it: the page of a running graph in a headless Chromium."""

import os
import re
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browser import Page, open_browser
from page_scenes import check_every_scene, check_looking_back

pytestmark = pytest.mark.timeout(900)
SWING = "page.motion.remaining === 0 && page.motion.size * 180 / Math.PI"
# A motion that began with a pendulum that leans.
PUT = "page.motion.rows.length > 3 && Math.abs(page.motion.rows[0][3]) > 0.2"
# What arrives in three hours at a page that draws nothing, at once.
HIDDEN = """() => { const { source } = page, rows = new Float64Array(7 * 5000).fill(1e6);
    for (let i = 0; i < 200; i++) source.receive(rows);
    return source.rows.length; }"""
# A slider is moved twice; the node confirms both, and then somebody else sets it. Later it refuses.
CONFIRMED = """(name) => { const { source } = page, seen = [], send = source.send;
    const hear = (value, more) => {
        source.hear({ values: { [name]: value }, ...more });
        seen.push(source.values[name]);
    };
    source.send = () => {};
    for (const value of [0.3, 0.4]) source.set({ [name]: value });
    for (const value of [0.3, 0.4, 0.5]) hear(value);
    source.set({ [name]: 0.6 });
    hear(0.5, { failed: "no" });
    source.send = send;
    hear(0.21);
    return seen; }"""
COMPENSATION = "knob-friction_observer.compensation"
NODES_OF_SCENES = ("controller", "estimator", "friction_observer")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Opens pages; a test is skipped, with the reason, where there is no browser."""
    with open_browser() as show:
        yield show


def started(processes: Any, *arguments: str) -> tuple[Any, str]:
    """A view with its address, the first line that it prints."""
    process = processes.furuta("view", "--no-open", *arguments)
    address = process.stdout.readline().strip()
    assert address.startswith("http://127.0.0.1:"), process.communicate()
    return process, address


@pytest.mark.parametrize(
    ("options", "expected", "reason"),
    [
        (["--lockstp"], 2, "--lockstep"),
        (["--set", "sigma=80"], 1, "error: no parameter sigma; did you mean"),
    ],
)
def test_a_graph_that_cannot_start_is_told_before_any_address(
    processes: Any, options: list[str], expected: int, reason: str
) -> None:
    status, out, err = processes.run("view", "--no-open", "--", *options)
    assert (status, out) == (expected, "")
    assert reason in err


def children(parent: int) -> dict[int, str]:
    """Child processes with their command lines."""
    found = {}
    for directory in Path("/proc").glob("[0-9]*"):
        try:
            is_child = int(directory.joinpath("stat").read_text().split(") ")[1].split()[1])
            command = directory.joinpath("cmdline").read_text().replace("\0", " ")
        except OSError:
            continue
        if is_child == parent:
            found[int(directory.name)] = command
    return found


def parameter(furuta: Any, node: str, name: str) -> str:
    status, out, err = furuta("param", "get", node, name)
    assert status == 0, err
    return str(out.strip())


def opened(browser: Any, address: str, *size: int) -> Page:
    """The page, once it knows the graph."""
    page: Page = browser(address, *size)
    page.wait(
        lambda: page.page.evaluate("page.source.hasScenes && page.motion.rows.length"), "rows"
    )
    return page


def test_page_shows_and_changes_the_graph(processes: Any, furuta: Any, browser: Any) -> None:
    """It moves, makes the limit cycle disappear, shows a refusal, and does not hold up the graph.

    It starts in real time. Another page shows the same, also a reset and where the pendulum is put.
    If the server is killed, the page says so and the graph runs on.
    """
    process, address = started(processes, "--", "--lockstep")
    page, other = opened(browser, address), opened(browser, address, 390, 844)
    assert page.page.locator("fieldset input:checked + span").inner_text() == "with friction"
    assert page.page.locator("fieldset label").count() == 2  # no settings of one's own
    speed = page.page.locator("#speed")
    assert speed.locator("option:checked").inner_text() == "real time"
    speed.select_option("as fast as possible")
    before = page.wait(lambda: page.page.evaluate(SWING), "the limit cycle")
    assert 25.0 < before < 35.0
    page.wait(lambda: "period 2.3" in page.text("#figures"), "the period")
    page.page.locator(f"[id='{COMPENSATION}']").select_option("lugre")
    page.wait(lambda: 0 < (page.page.evaluate(SWING) or before) < before / 10, "a smaller swing")
    assert parameter(furuta, "friction_observer", "compensation") == "lugre"
    assert other.page.locator(f"[id='{COMPENSATION}']").input_value() == "lugre"

    speed.select_option("real time")
    page.wait(lambda: page.page.evaluate("page.motion.time - page.motion.rows[0][0] > 10"), "10 s")
    check_looking_back(page.page)
    page.page.evaluate("page.motion.reset()")
    other.wait(lambda: other.page.evaluate("page.motion.remaining > 5"), "a new measurement")
    page.page.evaluate("page.motion.reset(0.2, -0.25)")
    angles = "[1, 3].map(i => page.motion.rows[0][i])"
    for each in (page, other):
        each.wait(lambda each=each: each.page.evaluate(PUT), "the pendulum where it was put")
        assert each.page.evaluate(angles) == pytest.approx([0.2, -0.25], abs=0.02)

    page.page.evaluate("document.querySelector('#more').open = true")
    page.page.locator("#search").fill("observer alpha1")
    box = page.page.locator("[id='knob-friction_observer.alpha1']")
    box.fill("150")
    box.press("Enter")
    reason = page.wait(lambda: page.text(".refusal").strip(), "the node's reason")
    assert "alpha1" in reason
    assert "100" in reason
    assert float(box.input_value()) < 1.0
    assert page.errors == []
    allowed = (address, f"blob:{address}", "data:", address.replace("http", "ws"))
    assert all(each.startswith(allowed) for each in page.requests), page.requests
    for each in (page, other):
        assert each.serious_violations("body") == []
        assert each.page.evaluate("document.documentElement.scrollWidth <= innerWidth")

    confirmed = other.page.evaluate(CONFIRMED, "friction_observer.alpha0")
    assert confirmed == [0.4, 0.4, 0.5, 0.5, 0.21]
    assert 1000 < other.page.evaluate(HIDDEN) < 5000

    (of_page,) = (pid for pid, command in children(process.pid).items() if "--attach" in command)
    os.kill(of_page, signal.SIGKILL)
    page.wait(lambda: "lost its server" in page.text("#notice"), "the notice")
    assert parameter(processes.run, "friction_observer", "compensation") == "lugre"
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 0


@pytest.mark.long
def test_all_scenes(processes: Any, furuta: Any, browser: Any) -> None:
    """As on the page in one file; the user's own settings restore everything."""
    process, address = started(processes, "--", "--lockstep")
    page = opened(browser, address)
    before = [furuta("param", "list", node)[1] for node in NODES_OF_SCENES]

    def run(shown: Any, seconds: float) -> None:
        shown.wait_for_timeout(1500)  # until what was asked for is in force
        end = shown.evaluate("page.source.time") + seconds
        page.wait(lambda: shown.evaluate("page.source.time") > end, "time")
        page.wait(lambda: shown.evaluate("page.motion.result") is not None, "a result")

    page.press("1 Watch")
    page.page.locator("#speed").select_option("as fast as possible")
    check_every_scene(page.page, run)
    page.page.locator("fieldset label").last.click()
    page.wait(
        lambda: [furuta("param", "list", node)[1] for node in NODES_OF_SCENES] == before,
        "the parameters before",
    )
    assert page.errors == []
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 0


@pytest.mark.long
@pytest.mark.realtime
def test_rig_is_armed_and_disarmed_on_the_page(processes: Any, browser: Any) -> None:
    """With the emulated rig; the page says that it is armed, and why it stopped."""
    process, address = started(processes, "--", "--plant", "hardware", "--port", "mock")
    page = browser(address)
    arm = page.page.locator("#arm")
    page.wait(arm.is_visible, "the controls of the rig")
    arm.click()

    def has_been_armed() -> bool:
        """On a busy machine the guard may refuse, or stop the rig at once; the page says why."""
        status = page.text("#rig")
        if page.text("#toast").strip():
            arm.click()
        return "ARMED" in status or ("stops: " in status and "stops: 0" not in status)

    page.wait(has_been_armed, "armed")
    assert page.page.locator("#scene").is_hidden()
    assert page.page.locator("#key-f").is_hidden()
    assert page.page.get_by_role("button", name=re.compile("Disarm")).count() == 1
    assert page.page.locator("#reset").is_hidden()
    shown = page.wait(lambda: re.search(r"t = ([0-9.]+) s", page.text(".hint")), "the time")
    assert float(shown[1]) < 1000.0  # since the start, not since 1970
    page.press("Disarm: 0 V")
    page.wait(lambda: "not armed" in page.text("#rig"), "disarmed")
    assert page.errors == []
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 0

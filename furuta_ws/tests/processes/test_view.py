"""``furuta view`` as a user has it: the page of a running graph in a headless Chromium."""

import os
import re
import signal
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Page, open_browser

from furuta_bringup.page.guided_scenes import guided_steps

pytestmark = pytest.mark.timeout(900)

# Width and height of the page: a small one, because software draws it [pixels].
SIZE = (1000, 500)
NARROW = (400, 800)
NODES_OF_SCENES = ("controller", "estimator", "friction_observer")
ENCODER_COUNT = 360.0 / 250  # [°]


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
        (["--lockstep", "--set", "clock=realtime"], 1, "error: --lockstep sets plant.clock"),
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


def arm_size(page: Page) -> float:
    """Peak to peak of the arm in the last half of the chart [°]; 0 while it is not full."""
    values = page.curve("arm φ [°]")
    return float(np.ptp(values[len(values) // 2 :])) if len(values) > 300 else 0.0


def parameter(furuta: Any, node: str, name: str) -> str:
    status, out, err = furuta("param", "get", node, name)
    assert status == 0, err
    return str(out.strip())


def test_page_shows_and_changes_the_graph(processes: Any, furuta: Any, browser: Any) -> None:
    """It moves, makes the limit cycle disappear, shows a refusal, and does not hold up the graph.

    After a change there is no figure until it has measured anew. A number counts when it is
    complete. If the page is killed, the graph runs on.

    In lock-step, so that the limit cycle does not depend on how busy the machine is.
    """
    process, address = started(processes, "--", "--lockstep")
    page = browser(address, *SIZE)
    page.close_notice()
    before = page.wait(lambda: arm_size(page) > 25.0 and arm_size(page), "the limit cycle")
    assert page.wait(lambda: degrees(page, "arm"), "its figure") == pytest.approx(before, rel=0.03)
    pendulum = page.picture()  # all else stands still by now
    page.wait(lambda: page.picture() != pendulum, "another picture of the pendulum")

    page.choose("Compensation", "LuGre observer")
    page.wait(lambda: "measuring" in page.figures()["arm"], "a new measurement")
    page.wait(lambda: 0.0 < arm_size(page) < before / 10.0, "a limit cycle ten times smaller")
    page.wait(lambda: (degrees(page, "arm") or np.inf) < before / 10.0, "its figure")
    assert parameter(furuta, "friction_observer", "compensation") == "lugre"

    box = page.row("Friction the observer expects α̂₀ [V]").locator("input").last
    box.fill("150")
    reason = page.wait(lambda: page.text(".refusal").strip(), "the node's reason")
    assert "alpha0" in reason
    assert "100" in reason

    assert page.errors == []
    allowed = (address, f"blob:{address}", address.replace("http", "ws"))
    assert all(each.startswith(allowed) for each in page.requests), page.requests

    (of_page,) = (pid for pid, command in children(process.pid).items() if "--attach" in command)
    os.kill(of_page, signal.SIGKILL)
    # A new process: this one may have the port of the killed page, and would get no answer.
    assert parameter(processes.run, "friction_observer", "compensation") == "lugre"
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 0


def degrees(page: Page, name: str) -> float | None:
    """The angle in a row of a table [°]; infinite after a fall, None while it is measured."""
    angle, degree, _ = page.figures().get(name, "").partition("°")
    return np.inf if angle == "fallen" else float(angle) if degree else None


# Whether the parts of a scene lie below each other, and what scrolls cuts off none of them.
ALL_IN_SIGHT = """(() => {
    const scene = document.querySelector('.scene'), box = e => e.getBoundingClientRect();
    let end = 0;
    for (const part of scene.children) {
        if (box(part).top < end - 1) return false;
        end = box(part).bottom;
    }
    for (let e = scene.parentElement; e; e = e.parentElement)
        if (getComputedStyle(e).overflowY !== 'visible' && box(e).bottom < end - 1) return false;
    return true;
})()"""


def in_sight_on_wide_pages(page: Page, browser: Any) -> None:
    """Wait until all of a scene is in sight on other pages of the same graph."""
    for size in ((1280, 800), SIZE):
        wide = browser(page.address, *size)
        wide.wait(wide.page.locator(".scene").count, "the scene")
        wide.wait(lambda wide=wide: wide.page.evaluate(ALL_IN_SIGHT), f"all in sight at {size}")
        wide.page.close()


@pytest.mark.long
def test_all_scenes(processes: Any, furuta: Any, browser: Any) -> None:
    """Each to its end; what is measured agrees with the text, and free play restores everything.

    On a narrow page, which still shows the chart.
    """
    process, address = started(processes, "--", "--lockstep")
    page = browser(address, *NARROW)
    page.wait(lambda: arm_size(page) > 25.0, "the limit cycle")
    chart = page.page.locator(".uplot").first
    ends = "e => e.getBoundingClientRect().bottom"
    page.wait(lambda: chart.evaluate(ends) <= NARROW[1], "a chart in sight")
    before = [furuta("param", "list", node)[1] for node in NODES_OF_SCENES]
    sizes = {}
    steps = guided_steps()
    page.choose("scene", steps[0].scene.name)
    for step in steps:
        page.wait(lambda step=step: step.look in page.text(".scene"), step.name)
        assert step.name in page.text("[aria-current]")
        assert "measuring" in page.figures()[step.name]
        page.wait(lambda: page.page.evaluate(ALL_IN_SIGHT), "all in sight")
        if step.name == "feedback as it is":  # the most lines
            in_sight_on_wide_pages(page, browser)
        size = sizes[step.name] = page.wait(partial(degrees, page, step.name), step.name)
        assert ("exact cycle" in page.figures()) == step.scene.predict
        if step.scene.predict:
            assert degrees(page, "exact cycle") == pytest.approx(size, rel=0.02)
        if np.isfinite(size) and not step.push:
            assert arm_size(page) == pytest.approx(size, rel=0.03, abs=ENCODER_COUNT)
        swings = partial(degrees, page, step.name)
        if step.name.startswith("stiffer bristles"):  # 5 to 7 degrees, anew every 5 s
            page.wait(lambda swings=swings: (swings() or 0.0) > np.degrees(0.1), "a large swing")
        if "recommended" in step.name:  # now and then the change of settings dies out slowly
            page.wait(lambda swings=swings: (swings() or np.inf) < ENCODER_COUNT, "no swing")
            sizes[step.name] = swings()
        if step.name == "push on the pendulum":
            page.wait(lambda: "has fallen" in page.text(".fallen"), "a word of the fall")
            assert page.serious_violations(".fallen, .status, .scene") == []
        elif step.push:
            page.wait(lambda swings=swings: (swings() or np.inf) < ENCODER_COUNT, "recovery")
        page.press("next")
    page.page.wait_for_selector(".scene", state="hidden")
    assert sizes["without friction"] < np.degrees(0.01)
    assert sizes["Coulomb"] < sizes["none"] / 10
    assert sizes["recommended"] < sizes["LuGre observer"] < sizes["Coulomb"]
    assert sizes["friction × 1.5, LuGre observer"] > np.degrees(0.2)
    assert sizes["friction × 1.5, recommended"] < ENCODER_COUNT
    assert sizes["elastic belt, recommended"] < ENCODER_COUNT
    assert sizes["push on the pendulum"] == np.inf
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
    page = browser(address, *SIZE)
    arm = page.page.get_by_role("button", name="Arm", exact=True)
    page.wait(arm.count, "the controls of the rig")
    arm.click()

    def has_been_armed() -> bool:
        """On a busy machine the guard may refuse, or stop the rig at once; the page says why."""
        status = page.text(".rig")
        if page.text(".note").strip():
            arm.click()
        return "ARMED" in status or ("stops: " in status and "stops: 0" not in status)

    page.wait(has_been_armed, "armed")
    seconds = re.search(r"t = ([0-9.]+) s", page.text(".status"))
    assert seconds is not None
    assert float(seconds[1]) < 1000.0  # since the start, not since 1970
    page.page.get_by_role("button", name="Disarm: 0 V").click()
    page.wait(lambda: "not armed: " in page.text(".rig"), "disarmed")
    assert page.errors == []
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 0

"""``furuta view`` as a user has it: the page of a running graph in a headless Chromium."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Page, open_browser

from furuta_view.simulation_controls import FOREVER

pytestmark = [pytest.mark.realtime, pytest.mark.timeout(900)]

# Width and height of the page: a small one, because software draws it [pixels].
SIZE = (1000, 500)


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
    """Peak to peak of the arm in the last half of the chart [rad]; 0 while it is not full."""
    values = page.curve("arm φ [rad]")
    return float(np.ptp(values[len(values) // 2 :])) if len(values) > 300 else 0.0


def choose(page: Page, label: str, option: str) -> None:
    page.row(label).locator("input").first.click()
    page.page.get_by_role("option", name=option, exact=True).click()


def parameter(furuta: Any, node: str, name: str) -> str:
    status, out, err = furuta("param", "get", node, name)
    assert status == 0, err
    return str(out.strip())


def run_until(furuta: Any) -> float:
    return float(parameter(furuta, "plant", "run_until"))


def test_page_shows_and_changes_the_graph(processes: Any, furuta: Any, browser: Any) -> None:
    """It moves, makes the limit cycle disappear, shows a refusal, and does not hold up the graph.

    A number counts when it is complete. If the page is killed while it has paused the plant, the
    plant continues.

    In lock-step, so that the limit cycle does not depend on how busy the machine is.
    """
    process, address = started(processes, "--", "--lockstep")
    page = browser(address, *SIZE)
    pendulum = page.picture()
    page.wait(lambda: page.picture() != pendulum, "another picture of the pendulum")
    before = page.wait(lambda: arm_size(page) > 0.4 and arm_size(page), "the limit cycle")

    choose(page, "compensation", "lugre")
    page.wait(lambda: 0.0 < arm_size(page) < before / 10.0, "a limit cycle ten times smaller")
    assert parameter(furuta, "friction_observer", "compensation") == "lugre"

    box = page.row("alpha0 [V]").locator("input").last
    box.fill("150")
    reason = page.wait(lambda: page.text(".refusal").strip(), "the node's reason")
    assert "alpha0" in reason
    assert "100" in reason

    assert page.errors == []
    allowed = (address, f"blob:{address}", address.replace("http", "ws"))
    assert all(each.startswith(allowed) for each in page.requests), page.requests

    choose(page, "speed", "paused")
    page.wait(lambda: run_until(furuta) < FOREVER, "the plant paused")
    (of_page,) = (pid for pid, command in children(process.pid).items() if "--attach" in command)
    os.kill(of_page, signal.SIGKILL)
    # On a busy machine nodes write warnings before.
    assert any("the graph runs on" in line for line in process.stderr)
    page.wait(lambda: run_until(furuta) == FOREVER, "the plant continues")
    assert parameter(furuta, "friction_observer", "compensation") == "lugre"
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 0


@pytest.mark.long
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
    page.page.get_by_role("button", name="Disarm: 0 V").click()
    page.wait(lambda: "not armed: " in page.text(".rig"), "disarmed")
    assert page.errors == []
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 0

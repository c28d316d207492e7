"""All guided scenes on the page, whether it computes the motion or receives it from a graph."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from furuta_bringup.page.guided_scenes import CONTENT

# How closely the motion agrees with the exact cycle of its step.
EXACT = {"with friction": 0.02, "feedback as it is": 0.02, "faster feedback": 0.05}
# What is printed and what is measured at one time.
SEEN = """() => { page.tell(); const { rows } = page.motion, end = rows.at(-1)[0];
    const of = (selector) => document.querySelector(selector);
    const from = end - page.DATA.measured.window;
    const phi = rows.filter(([time]) => time > from).map((row) => row[1]);
    const row = of("fieldset label:has(:checked)"), printed = row.querySelector("output");
    return { swing: Math.max(...phi) - Math.min(...phi), exact: page.source.cycle?.exact,
        step: row.querySelector("span").textContent, printed: printed.textContent,
        big: of("#swing").textContent, said: of("#said").textContent, look: of(".look").textContent,
        known: of(".known b")?.textContent, fallen: !of("#fallen").hidden,
        cosine: Math.cos(page.source.now[3]) }; }"""


# What is shown while the page looks back: the row of that moment beside it, and how it is told.
PAST = """() => { const { motion } = page, of = (selector) => document.querySelector(selector);
    page.tell(); page.drawing.drawAll();
    const charts = [...document.querySelectorAll("figcaption")].map(({ dataset }) => dataset.at);
    return { row: motion.moment, ago: motion.time - (motion.moment?.[0] ?? NaN), charts,
        pose: motion.pose, end: motion.rows.at(-1)[0], phi: of("#now-phi").textContent,
        told: of("#past").hidden ? "" : of("#past").innerText }; }"""


def check_looking_back(page: Any) -> None:
    """A drag over the chart of the angles shows that moment everywhere; Escape comes back.

    The motion of the page is at least 10 s old. Meanwhile no row comes.
    """
    box = page.locator("#angles").bounding_box()
    middle = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 0.8 * box["width"], middle)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], middle, steps=5)
    page.mouse.up()
    past = page.evaluate(PAST)
    left, right = 3.6 * 11, 8  # pixels beside the curves
    expected = 10 * (1 - (0.5 * box["width"] - left) / (box["width"] - left - right))
    assert past["ago"] == pytest.approx(expected, abs=0.1)
    assert past["pose"] == [past["row"][1], past["row"][3]]
    shown = f"{np.rad2deg(past['row'][1]):.1f}°".replace("-", "−")
    assert past["phi"].replace("−0.0°", "0.0°") == shown.replace("−0.0°", "0.0°")
    assert past["told"].startswith(f"{past['ago']:.2f} s ago")
    assert past["charts"][:2] == [f"t −{past['ago']:.2f} s"] * 2
    assert all("φ" in each for each in past["charts"][2:])
    page.wait_for_timeout(300)
    assert page.evaluate(PAST)["end"] == past["end"]
    page.keyboard.press("Escape")
    page.mouse.move(1, 1)
    now = page.evaluate(PAST)
    assert now["row"] is None
    assert now["told"] == ""
    assert set(now["charts"]) == {""}


def check_every_scene(page: Any, run: Callable[[Any, float], None]) -> None:
    """What is printed is what is measured, and it agrees with what the scenes say.

    The motion is the exact cycle's, compensation reduces it, and a fall is said. Under compensation
    the motion is irregular: its size is the median of five windows. ``run`` lets seconds pass.
    """
    sizes = {}
    for scene in CONTENT["scenes"]:
        for step in scene["steps"]:
            run(page, 27.5)
            seen = page.evaluate(SEEN)
            assert (seen["step"], seen["look"]) == (step["name"], step["look"])
            assert seen["said"].startswith(f"{step['name']}: ")
            if step["name"] == "push on the pendulum":
                assert seen["printed"] == "fell"
                assert seen["fallen"]
                page.keyboard.press("r")
                run(page, 2.0)
                assert not page.evaluate(SEEN)["fallen"]
            else:
                size = np.rad2deg(seen["swing"])
                assert seen["printed"] == f"{size:.{1 if size >= 3.0 else 2}f}°" == seen["big"]
            if step["name"] in EXACT:
                assert seen["swing"] == pytest.approx(seen["exact"], rel=EXACT[step["name"]])
                if scene.get("predict"):
                    assert seen["known"] == f"{np.rad2deg(seen['exact']):.1f}°"
            sizes[step["name"]] = np.median([_later(page, run) for _ in range(5)])
            if step["name"] == "fall and swing up":
                assert page.evaluate(SEEN)["cosine"] > 0.99
            page.keyboard.press("n")
    assert sizes["without friction"] < 0.02 * sizes["with friction"]
    assert 0.1 * sizes["none"] > sizes["Coulomb"] > sizes["LuGre observer"] > sizes["recommended"]
    assert sizes["friction × 1.5, recommended"] < 0.1 * sizes["friction × 1.5, LuGre observer"]
    assert page.locator("#scenes .done").count() == len(CONTENT["scenes"]) - 1  # it begins again


def _later(page: Any, run: Callable[[Any, float], None]) -> float:
    run(page, 5.0)
    return float(page.evaluate(SEEN)["swing"])

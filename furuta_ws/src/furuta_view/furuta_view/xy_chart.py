"""Draws curves in a plane as SVG: one quantity over another, with axes, units and a legend."""

from __future__ import annotations

from html import escape
from math import ceil, floor, log10
from typing import NamedTuple, TypeVar

import numpy as np

WIDTH, HEIGHT = 420, 172
LEFT, RIGHT, TOP, BOTTOM = 58, 14, 26, 40
# Largest number of intervals between ticks.
INTERVALS = 6
Number = TypeVar("Number", float, np.ndarray)

GRID, INK = "#e3e8ef", "#334155"


class Curve(NamedTuple):
    """A curve with its name in the legend; a name that is empty is not in the legend."""

    name: str
    colour: str
    x: np.ndarray
    y: np.ndarray
    width: float = 2.0
    dash: str = ""


class Plane(NamedTuple):
    """Title, names of the axes with units, and the sizes that the axes reach at least."""

    title: str
    x_name: str
    y_name: str
    x_reach: float
    y_reach: float


def xy_chart(plane: Plane, curves: list[Curve]) -> str:
    """The chart as an SVG element; both axes are symmetric about 0."""
    reach_x = _reach(plane.x_reach, [each.x for each in curves])
    reach_y = _reach(plane.y_reach, [each.y for each in curves])
    drawn = "".join(_polyline(each, reach_x, reach_y) for each in curves)
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" style="width:100%;display:block;'
        f'font-family:system-ui,sans-serif;background:white">'
        f"{_axes(plane, reach_x, reach_y)}{drawn}{_legend(curves)}</svg>"
    )


def _reach(least: float, series: list[np.ndarray]) -> float:
    """The end of an axis: a round number that no value exceeds."""
    finite = [np.abs(each[np.isfinite(each)]) for each in series]
    largest = max([least, *(float(each.max()) for each in finite if len(each))])
    step = _step(largest)
    return ceil(largest / step - 1e-9) * step


def _step(reach: float) -> float:
    """A round distance of ticks, for an axis from -reach to reach."""
    rough = 2.0 * reach / INTERVALS
    power = 10.0 ** floor(log10(rough))
    return float(next(each * power for each in (1, 2, 5, 10) if each * power >= rough * 0.999))


def _to_x(x: Number, reach: float) -> Number:
    return LEFT + (x / reach + 1.0) / 2.0 * (WIDTH - LEFT - RIGHT)


def _to_y(y: Number, reach: float) -> Number:
    return TOP + (1.0 - y / reach) / 2.0 * (HEIGHT - TOP - BOTTOM)


def _polyline(curve: Curve, reach_x: float, reach_y: float) -> str:
    known = np.isfinite(curve.x) & np.isfinite(curve.y)
    if not known.any():
        return ""
    x, y = _to_x(curve.x[known], reach_x), _to_y(curve.y[known], reach_y)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    dash = f' stroke-dasharray="{curve.dash}"' if curve.dash else ""
    return (
        f'<polyline fill="none" stroke="{curve.colour}" stroke-width="{curve.width}" '
        f'stroke-linejoin="round"{dash} points="{points}"/>'
    )


def _axes(plane: Plane, reach_x: float, reach_y: float) -> str:
    middle = LEFT + (WIDTH - LEFT - RIGHT) / 2
    parts = [
        _text(LEFT, 18, plane.title, "start", 15, "600"),
        _text(middle, HEIGHT - 8, plane.x_name, "middle", 14),
        f'<g transform="rotate(-90)">'
        f"{_text(-(TOP + (HEIGHT - TOP - BOTTOM) / 2), 14, plane.y_name, 'middle', 14)}</g>",
    ]
    for value in _ticks(reach_x):
        x = _to_x(value, reach_x)
        parts.append(_line(x, TOP, x, HEIGHT - BOTTOM))
        parts.append(_text(x, HEIGHT - BOTTOM + 16, f"{value:g}", "middle", 13))
    for value in _ticks(reach_y):
        y = _to_y(value, reach_y)
        parts.append(_line(LEFT, y, WIDTH - RIGHT, y))
        parts.append(_text(LEFT - 6, y + 4, f"{value:g}", "end", 13))
    return "".join(parts)


def _ticks(reach: float) -> list[float]:
    step = _step(reach)
    count = floor(reach / step + 1e-9)
    return [round(k * step, 12) for k in range(-count, count + 1)]


def _legend(curves: list[Curve]) -> str:
    """Names in the colours of their curves, at the right of the title."""
    spans = [
        f'<tspan fill="{each.colour}" dx="10">{escape(each.name)}</tspan>'
        for each in curves
        if each.name
    ]
    return (
        f'<text x="{WIDTH - RIGHT - 4}" y="18" text-anchor="end" font-size="13" '
        f'font-weight="600">{"".join(spans)}</text>'
    )


def _line(x1: float, y1: float, x2: float, y2: float) -> str:
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{GRID}"/>'


def _text(x: float, y: float, text: str, anchor: str, size: int, weight: str = "400") -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}" '
        f'font-weight="{weight}" fill="{INK}">{escape(text)}</text>'
    )

"""Draws curves in a plane as SVG: one quantity over another, with axes, units and a legend.

The charts of viser need ascending values on the horizontal axis.
"""

from html import escape
from typing import NamedTuple, TypeVar

import numpy as np
from matplotlib.ticker import MaxNLocator

WIDTH, HEIGHT = 420, 172
LEFT, RIGHT, TOP, BOTTOM = 58, 14, 26, 40
# Round ticks, as many intervals as fit, from one end of the axis to the other.
TICKS = MaxNLocator(6, steps=[1, 2, 5, 10], symmetric=True)
Number = TypeVar("Number", float, np.ndarray)

GRID, INK = "#e3e8ef", "#334155"


class Curve(NamedTuple):
    """A curve with its name in the legend."""

    name: str
    colour: str
    x: np.ndarray
    y: np.ndarray
    width: float = 2.0


class Plane(NamedTuple):
    """Title, names of the axes with units, and the sizes that the axes reach at least."""

    title: str
    x_name: str
    y_name: str
    x_reach: float
    y_reach: float


def xy_chart(plane: Plane, curves: list[Curve]) -> str:
    """The chart as an SVG element; both axes are symmetric about 0."""
    x_ticks = _ticks(plane.x_reach, [curve.x for curve in curves])
    y_ticks = _ticks(plane.y_reach, [curve.y for curve in curves])
    drawn = "".join(_polyline(curve, x_ticks[-1], y_ticks[-1]) for curve in curves)
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" style="width:100%;display:block;'
        f'font-family:system-ui,sans-serif;background:white">'
        f"{_axes(plane, x_ticks, y_ticks)}{drawn}{_legend(curves)}</svg>"
    )


def _ticks(least: float, series: list[np.ndarray]) -> list[float]:
    """Ticks of an axis, whose ends no value exceeds."""
    sizes = np.abs(np.concatenate(series)) if series else np.zeros(0)
    reach = max(least, float(sizes.max(where=np.isfinite(sizes), initial=0.0)))
    return list(TICKS.tick_values(-reach, reach))


def _to_x(x: Number, reach: float) -> Number:
    return LEFT + (x / reach + 1.0) / 2.0 * (WIDTH - LEFT - RIGHT)


def _to_y(y: Number, reach: float) -> Number:
    return TOP + (1.0 - y / reach) / 2.0 * (HEIGHT - TOP - BOTTOM)


def _polyline(curve: Curve, x_reach: float, y_reach: float) -> str:
    known = np.isfinite(curve.x) & np.isfinite(curve.y)
    x, y = _to_x(curve.x[known], x_reach), _to_y(curve.y[known], y_reach)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return (
        f'<polyline fill="none" stroke="{curve.colour}" stroke-width="{curve.width}" '
        f'stroke-linejoin="round" points="{points}"/>'
    )


def _axes(plane: Plane, x_ticks: list[float], y_ticks: list[float]) -> str:
    middle = LEFT + (WIDTH - LEFT - RIGHT) / 2
    parts = [
        _text(LEFT, 18, plane.title, "start", 15, "600"),
        _text(middle, HEIGHT - 8, plane.x_name, "middle", 14),
        f'<g transform="rotate(-90)">'
        f"{_text(-(TOP + (HEIGHT - TOP - BOTTOM) / 2), 14, plane.y_name, 'middle', 14)}</g>",
    ]
    for value in x_ticks:
        x = _to_x(value, x_ticks[-1])
        parts.append(_line(x, TOP, x, HEIGHT - BOTTOM))
        parts.append(_text(x, HEIGHT - BOTTOM + 16, f"{value:g}", "middle", 13))
    for value in y_ticks:
        y = _to_y(value, y_ticks[-1])
        parts.append(_line(LEFT, y, WIDTH - RIGHT, y))
        parts.append(_text(LEFT - 6, y + 4, f"{value:g}", "end", 13))
    return "".join(parts)


def _legend(curves: list[Curve]) -> str:
    """A piece of each curve and its name, at the right of the title."""
    spans = [
        f'<tspan fill="{curve.colour}" dx="10">━</tspan>'
        f'<tspan fill="{INK}" dx="3">{escape(curve.name)}</tspan>'
        for curve in curves
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

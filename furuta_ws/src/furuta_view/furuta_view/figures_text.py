"""The figures of a motion as rows of a table."""

from __future__ import annotations

from math import isfinite

from furuta_view.figures import Figures


def figure_rows(of: Figures) -> list[tuple[str, str]]:
    """Names and values with units."""
    return [
        ("arm, peak to peak", _number(of.phi_peak_to_peak, 3, "rad")),
        ("pendulum, peak to peak", _number(of.theta_peak_to_peak, 4, "rad")),
        ("period", _number(of.period, 2, "s")),
        ("arm in encoder counts", _number(of.counts, 1, "")),
    ]


def _number(value: float, digits: int, unit: str) -> str:
    return f"{value:.{digits}f} {unit}".rstrip() if isfinite(value) else "–"

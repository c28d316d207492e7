"""The lines that ``furuta identify`` prints."""

from collections.abc import Iterator
from typing import Any

import numpy as np


def report_lines(result: dict[str, Any]) -> Iterator[str]:
    """The report of a model (:func:`furuta_identification.result.report.full_report`)."""
    yield from _values(result)
    for name, reason in result["undetermined"].items():
        yield f"{name:26} not determined by the data: {reason}"
    for kind in ("fit", "held_out"):
        for recording, fits in result[kind].items():
            yield f"{kind.replace('_', '-')} {recording}: {_percentages(fits, 1)}"
    for wave in result["waves"]:
        if wave["cos"] is not None and wave["sin"] is not None:
            size = np.hypot(wave["cos"], wave["sin"])
            yield f"torque wave, {wave['order']:2d} per turn {size:11.3g} V"
    yield from _laws(result)
    yield from _verdict(result["verdict"])
    for finding in result["findings"]:
        yield f"found: {finding}"
    for name in ("figure", "rig_file"):
        if name in result:
            yield f"{name.replace('_', ' ')}: {result[name]}"


def _values(result: dict[str, Any]) -> Iterator[str]:
    errors = result["standard_errors"]
    for group in (result, result["lugre"], result["setup"]):
        for name, value in group.items():
            if isinstance(value, float) and name in errors:
                error = errors[name]
                yield f"{name:26} {value:12.6g}" + (f"  ± {error:.2g}" if error else "")


def _percentages(values: dict[str, float], digits: int) -> str:
    known = {name: value for name, value in values.items() if not np.isnan(value)}
    return ", ".join(f"{n.replace('_', ' ')} {value:.{digits}f} %" for n, value in known.items())


def _laws(result: dict[str, Any]) -> Iterator[str]:
    for law in result.get("friction_laws", []):
        errors = ", ".join(f"{name} {error:.3f}" for name, error in law["errors"].items())
        title = f"{law['law']} ({law['parameters']} parameters)"
        yield f"law {title:31} held-out error over Coulomb's: {errors}"
    if "simplest_adequate_law" in result:
        yield f"law supported by the data: {result['simplest_adequate_law']}"


def _verdict(verdict: dict[str, Any]) -> Iterator[str]:
    for name, parts in verdict["coloured_percent"].items():
        yield f"coloured residuals (white: 5 %) {name}: {_percentages(parts, 0)}"
    yield f"usable: {verdict['usable']}" + "".join(f"; {why}" for why in verdict["reasons"])

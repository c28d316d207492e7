"""Writes the report of a soak: Markdown for people, JSON for programs."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

from soak.oracles import ORACLES

# Counts of what was tried that the totals at the head of the report sum up, by their prefix.
FRAMES, INTRUSIONS = "frame", ("kill", "pause")


def write_report(
    out: Path, results: list[dict[str, Any]], load: dict[str, float], seconds: float, seed: int
) -> int:
    """Write ``report.md`` and ``report.json``; returns 1 if an oracle is broken, otherwise 0."""
    summary = summarise(results) | {"load": load, "seconds": seconds, "seed": seed}
    (out / "report.json").write_text(json.dumps(summary | {"slices": results}, indent=1))
    text = markdown(summary)
    (out / "report.md").write_text(text)
    print(text)
    return int(bool(summary["broken"]))


def summarise(results: list[dict[str, Any]]) -> dict[str, Any]:
    """The sums over all slices, and every failure."""
    sums = {name: Counter[str]() for name in ("tried", "refused", "checks", "broken")}
    largest: dict[str, float] = {}
    for result in results:
        campaign = result["slice"].partition(":")[0]
        for name, total in sums.items():
            prefix = f"{campaign}: " if name in ("tried", "refused") else ""
            total.update({f"{prefix}{key}": count for key, count in result[name].items()})
        for key, value in result["largest"].items():
            largest[key] = max(value, largest.get(key, value))
    tried = sums["tried"]
    return {name: dict(total) for name, total in sums.items()} | {
        "largest": largest,
        "messages_mutated": sum(n for key, n in tried.items() if _is_mutated_message(key)),
        "frames_mutated": sum(n for key, n in tried.items() if ": frame " in key),
        "kills_and_pauses": sum(n for key, n in tried.items() if _is_intrusion(key)),
        "failures": [failure for result in results for failure in result["failures"]],
    }


def _is_mutated_message(key: str) -> bool:
    mutated = not any(word in key for word in (": valid", ": frame ", ": parameters"))
    return mutated and not _is_intrusion(key) and ": " in key and key.count(": ") > 1


def _is_intrusion(key: str) -> bool:
    return any(f": {word} " in key for word in INTRUSIONS)


def markdown(summary: dict[str, Any]) -> str:
    """The report for people."""
    load = summary["load"]
    failures = summary["failures"]
    lines = [
        "# Soak",
        "",
        f"{summary['seconds'] / 60:.1f} min, seed {summary['seed']}, {load['cores']:.0f} cores "
        f"busy to {load['busy_fraction']:.0%}, load average {load['mean_load']:.1f} "
        f"(largest {load['largest_load']:.1f}).",
        "",
        f"{summary['messages_mutated']} messages and {summary['frames_mutated']} frames mutated, "
        f"{summary['kills_and_pauses']} kills or pauses, {sum(summary['refused'].values())} "
        f"refusals, {sum(summary['checks'].values())} checks, "
        f"{sum(summary['broken'].values())} broken.",
        "",
        *_table("oracle", ("checks", "broken"), ORACLES, summary),
        *_table("tried", ("tried",), sorted(summary["tried"]), summary),
        *_table("refused", ("refused",), sorted(summary["refused"]), summary),
        *_table("largest", ("largest",), sorted(summary["largest"]), summary),
    ]
    lines += ["## Failures", ""] if failures else ["No oracle is broken.", ""]
    lines += [
        f"- **{each['oracle']}**, `make soak SLICE={each['slice']} SEED={each['seed']} "
        f"STEPS={each['step']}`: {each['detail']}"
        for each in failures
    ]
    return "\n".join(lines) + "\n"


def _table(title: str, columns: tuple[str, ...], rows: Any, summary: dict[str, Any]) -> list[str]:
    """A table with a row per name."""
    lines = [f"| {title} | {' | '.join(columns)} |", "|---|" + "---|" * len(columns)]
    for name in rows:
        cells = " | ".join(f"{summary[column].get(name, 0):.12g}" for column in columns)
        about = f": {rows[name]}" if isinstance(rows, dict) else ""
        lines.append(f"| {name}{about} | {cells} |")
    return [*lines, ""]

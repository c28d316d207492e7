"""Candidates of a comparison: settings of estimator, friction observer and controller.

A candidate does not change the plant.
"""

import re
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from furuta.settings.parameter_names import Match, by_node, parameters_named
from furuta.settings.settings import (
    Settings,
    default_settings,
    load_settings,
    merge_settings,
)
from furuta_friction.compensation import COMPENSATIONS
from furuta_model.parameters import ParameterError
from furuta_ros.yaml_files import parse_yaml

# A comma before a name separates settings; others are inside lists.
_SEPARATOR = re.compile(r",(?=\s*[A-Za-z_][\w.]*\s*=)")


class Candidate(NamedTuple):
    """Its name, and its settings by full name."""

    name: str
    settings: dict[str, Any]

    def applied_to(self, settings: Settings) -> Settings:
        """The settings with those of the candidate. ParameterError if they are impossible."""
        given = Settings(default_settings() | by_node(self.settings))
        return load_settings([], [], merge_settings(settings, given))


def _standard(compensation: str, **controller: Any) -> dict[str, Any]:
    """Settings by full name."""
    beside = {f"controller.{name}": value for name, value in controller.items()}
    return {"friction_observer.compensation": compensation, **beside}


# Averaged over its period, dither smooths friction (Pervozvanski and Canudas de Wit, Automatica 38,
# 2002). At 20 Hz 4 V are needed on the paper's rig.
_DITHER = {"excitation.kind": "sine", "excitation.amplitude": 4.0, "excitation.period": 0.05}
# Every compensation with its parameters as they are set, and methods without a friction estimate.
STANDARD = {name: _standard(name) for name in COMPENSATIONS} | {
    "integral": _standard("none", integral_time=5.0),
    "dither": _standard("none", **_DITHER),
}
# Without any compensation, whatever the settings add to it.
UNCOMPENSATED = Candidate("uncompensated", _standard("none"))
# Bandwidths [1/s] of the recommended compensation, among which the best one of a rig is searched;
# 0: no compensation.
BANDWIDTHS = (0.0, 12.5, 25.0, 35.0, 50.0, 70.0, 100.0)


def bandwidth_candidates() -> tuple[Candidate, ...]:
    """The recommended compensation with each of :data:`BANDWIDTHS`."""
    recommended = STANDARD["recommended"]
    return tuple(
        Candidate(
            f"{k:g}", recommended | {"friction_observer.bandwidth": k} if k else UNCOMPENSATED[1]
        )
        for k in BANDWIDTHS
    )


def parse_candidates(texts: Iterable[str], settings: Settings) -> tuple[Candidate, ...]:
    """Candidates NAME=PARAMETER=VALUE,... or the NAME of a standard one."""
    candidates = tuple(_parse(text, settings) for text in texts)
    names = [candidate.name for candidate in candidates]
    if len(set(names)) < len(names):
        raise ParameterError(f"a candidate may be named only once, given {', '.join(names)}")
    return candidates


def candidate_of(name: str, given: Mapping[str, Any], settings: Settings) -> Candidate:
    """A candidate with these values by name, or without any the standard one of this name."""
    if not given:
        return _parse(name, settings)
    matches = [(match, value) for key, value in given.items() for match in _beside_plant(key)]
    candidate = Candidate(name, {_full(m): m.parameter.parsed(value) for m, value in matches})
    candidate.applied_to(settings)
    return candidate


def _parse(text: str, settings: Settings) -> Candidate:
    name, separator, rest = text.partition("=")
    name = name.strip()
    if not separator and name in STANDARD:
        return Candidate(name, STANDARD[name])
    if not name or not rest.strip():
        raise ParameterError(
            f"expected NAME=PARAMETER=VALUE,... or one of {', '.join(STANDARD)}; given {text!r}"
        )
    candidate = Candidate(name, {})
    for setting in _SEPARATOR.split(rest):
        _set(candidate, setting)
    candidate.applied_to(settings)
    return candidate


def _set(candidate: Candidate, setting: str) -> None:
    """Add PARAMETER=VALUE to the candidate."""
    name, separator, value = (part.strip() for part in setting.partition("="))
    if not separator or not value:
        raise ParameterError(
            f"candidate {candidate.name}: expected PARAMETER=VALUE, given {setting!r}"
        )
    for match in _beside_plant(name):
        candidate.settings[_full(match)] = match.parameter.parsed(parse_yaml(value, name))


def _full(match: Match) -> str:
    return f"{match.node}.{match.parameter.name}"


def _beside_plant(name: str) -> list[Match]:
    """The parameters with this name outside the plant."""
    matches = [match for match in parameters_named(name) if match.node != "plant"]
    if not matches:
        raise ParameterError(f"a candidate cannot set {name}, which only the plant has")
    return matches

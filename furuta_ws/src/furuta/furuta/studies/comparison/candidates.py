"""Candidates of a comparison: settings of estimator, friction observer and controller.

A candidate does not change the plant. Parameters with a range are tuned within it.
"""

import re
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from furuta_friction.compensation import COMPENSATIONS
from furuta_graph.settings.nodes import NODES
from furuta_graph.settings.parameter_names import Match, parameters_named
from furuta_graph.settings.recommended import RECOMMENDED, recommended_values
from furuta_graph.settings.settings import Settings, default_settings, load_settings, merge_settings
from furuta_model.parameters import Declared, ParameterError, build, values
from furuta_ros.yaml_files import parse_yaml

# Factor by which tuning may change a parameter of a standard candidate, either way.
SPAN = 4.0
# A comma before a name separates settings; others are inside lists.
_SEPARATOR = re.compile(r",(?=\s*[A-Za-z_][\w.]*\s*=)")

Range = tuple[float, float]


class Candidate(NamedTuple):
    """Its name, its settings by full name, and the range of each parameter that is tuned."""

    name: str
    settings: dict[str, Any]
    ranges: dict[str, Range]

    def applied_to(self, settings: Settings) -> Settings:
        """The settings with those of the candidate. ParameterError if they are impossible."""
        given = default_settings()
        for name, value in self.settings.items():
            node, _, parameter = name.partition(".")
            given[node][parameter] = value
        return load_settings([], [], merge_settings(settings, given))


# Settings of a standard candidate by full name, and the parameters that can be tuned.
_Standard = tuple[dict[str, Any], tuple[str, ...]]


def _standard(compensation: str, *tunable: str, **controller: Any) -> _Standard:
    beside = {f"controller.{name}": value for name, value in controller.items()}
    return {"friction_observer.compensation": compensation, **beside}, tunable


def _observer(*names: str) -> tuple[str, ...]:
    return tuple(f"friction_observer.{name}" for name in names)


_COMBINED = _observer("combined.filter_time", "combined.reversal_speed", "combined.level_rate")
_TUNABLE = {
    "coulomb": _observer("alpha0"),
    "stiction": _observer("alpha0", "alpha1", "stribeck_velocity"),
    "lugre": _observer("sigma0", "sigma1", "alpha0", "alpha1"),
    "adaptive": _observer("sigma0", "sigma1", "adaptation_gain"),
    "disturbance_observer": ("estimator.friction_process_noise",),
    "combined": _COMBINED,
}
_TWISTING = "controller.super_twisting"
_BANDWIDTH = "controller.super_twisting_bandwidth"
# Averaged over its period, dither smooths friction (Pervozvanski and Canudas de Wit, Automatica 38,
# 2002). At 20 Hz 4 V are needed on the paper's rig.
_DITHER = {"excitation.kind": "sine", "excitation.amplitude": 4.0, "excitation.period": 0.05}
# Every compensation with its parameters as they are set, methods without a friction estimate, and
# the recommended setting, which follows from the model of the settings.
STANDARD = {name: _standard(name, *_TUNABLE.get(name, ())) for name in COMPENSATIONS} | {
    "combined_twisting": _standard("combined", *_COMBINED, _TWISTING, super_twisting=1.0),
    "super_twisting": _standard("none", _TWISTING, super_twisting=10.0),
    "integral": _standard("none", "controller.integral_time", integral_time=5.0),
    RECOMMENDED: ({}, (_TWISTING, _BANDWIDTH)),
    "dither": _standard("none", "controller.excitation.amplitude", **_DITHER),
}


def parse_candidates(
    texts: Iterable[str], settings: Settings, tuned: bool
) -> tuple[Candidate, ...]:
    """Candidates NAME=PARAMETER=VALUE,PARAMETER=LOW:HIGH,... or the NAME of a standard one.

    Only candidates that are to be ``tuned`` have ranges.
    """
    candidates = tuple(_parse(text, settings, tuned) for text in texts)
    names = [candidate.name for candidate in candidates]
    if len(set(names)) < len(names):
        raise ParameterError(f"a candidate may be named only once, given {', '.join(names)}")
    return candidates


def candidate_of(name: str, given: Mapping[str, Any], settings: Settings) -> Candidate:
    """A candidate with these values by name, or without any the standard one of this name."""
    if not given:
        return _parse(name, settings, tuned=False)
    matches = [(match, value) for key, value in given.items() for match in _beside_plant(key)]
    candidate = Candidate(name, {_full(m): m.parameter.parsed(value) for m, value in matches}, {})
    candidate.applied_to(settings)
    return candidate


def current_values(settings: Settings, names: Iterable[str]) -> list[float]:
    """Values of numeric parameters by full name."""
    nodes = {node: values(build(about.parameters, settings[node])) for node, about in NODES.items()}
    pairs = (name.partition(".")[::2] for name in names)
    return [float(nodes[node][parameter]) for node, parameter in pairs]


def _standard_candidate(name: str, settings: Settings) -> Candidate:
    given, tunable = STANDARD[name]
    if name == RECOMMENDED:
        given = recommended_values(settings)
    plain = Candidate(name, given, {})
    pairs = zip(tunable, current_values(plain.applied_to(settings), tunable), strict=True)
    ranges = {parameter: (value / SPAN, value * SPAN) for parameter, value in pairs if value}
    return plain._replace(ranges=ranges)


def _parse(text: str, settings: Settings, tuned: bool) -> Candidate:
    name, separator, rest = text.partition("=")
    name = name.strip()
    if not separator and name in STANDARD:
        candidate = _standard_candidate(name, settings)
        return candidate if tuned else candidate._replace(ranges={})
    if not name or not rest.strip():
        raise ParameterError(
            f"expected NAME=PARAMETER=VALUE,... or one of {', '.join(STANDARD)}; given {text!r}"
        )
    candidate = Candidate(name, {}, {})
    for setting in _SEPARATOR.split(rest):
        _set(candidate, setting)
    if candidate.ranges and not tuned:
        raise ParameterError(f"candidate {name}: a range LOW:HIGH needs --tune-budget")
    candidate.applied_to(settings)
    return candidate


def _set(candidate: Candidate, setting: str) -> None:
    """Add PARAMETER=VALUE or PARAMETER=LOW:HIGH to the candidate."""
    name, separator, value = (part.strip() for part in setting.partition("="))
    if not separator or not value:
        raise ParameterError(
            f"candidate {candidate.name}: expected PARAMETER=VALUE or PARAMETER=LOW:HIGH, "
            f"given {setting!r}"
        )
    for match in _beside_plant(name):
        full = _full(match)
        if ":" in value and match.parameter.kind is not str:
            candidate.ranges[full] = _checked_range(match.parameter, value)
        else:
            candidate.settings[full] = match.parameter.parsed(parse_yaml(value, name))


def _full(match: Match) -> str:
    return f"{match.node}.{match.parameter.name}"


def _beside_plant(name: str) -> list[Match]:
    """The parameters with this name outside the plant."""
    matches = [match for match in parameters_named(name) if match.node != "plant"]
    if not matches:
        raise ParameterError(f"a candidate cannot set {name}, which only the plant has")
    return matches


def _checked_range(parameter: Declared, text: str) -> Range:
    """The range LOW:HIGH of a real parameter."""
    try:
        low, high = (float(limit) for limit in text.split(":"))
    except ValueError:
        raise ParameterError(f"{parameter.name}: expected LOW:HIGH, given {text!r}") from None
    if parameter.kind is not float or not low < high:
        raise ParameterError(f"{parameter.name}: needs a real parameter and LOW < HIGH")
    return parameter.checked(low), parameter.checked(high)

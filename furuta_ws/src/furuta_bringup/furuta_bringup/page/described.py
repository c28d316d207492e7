"""A parameter as its node's services describe it, for the page and from the page."""

import math
from typing import Any, NamedTuple

from furuta_bringup.page.guided_scenes import COMPENSATION, IN_SIGHT
from furuta_friction.compensation import TITLES
from furuta_model.parameters import ParameterError, number_from_text
from furuta_ros.yaml_files import parse_yaml

CHOICES = "one of "
# A slider reaches so many times the value.
REACH = 3.0
# Steps of a slider.
STEPS = 1000


class Described(NamedTuple):
    """A parameter: name, value, meaning with unit, range and choices where there are any."""

    name: str
    value: Any
    meaning: str = ""
    constraints: str = ""
    low: float = float("-inf")
    high: float = float("inf")
    read_only: bool = False
    node: str = ""

    @property
    def choices(self) -> tuple[str, ...]:
        """The allowed words, if the node lists them, with the name of an own part if it is one."""
        if not isinstance(self.value, str) or not self.constraints.startswith(CHOICES):
            return ()
        words = self.constraints.removeprefix(CHOICES).split(", ")
        listed = (word for word in words if " " not in word)
        return tuple(dict.fromkeys([*listed, self.value]))

    @property
    def unit(self) -> str:
        """The unit at the end of the meaning, in brackets there, or nothing."""
        before, bracket, unit = self.meaning.rpartition("[")
        return unit[:-1] if bracket and unit.endswith("]") and before else ""

    @property
    def full_name(self) -> str:
        """Name with that of the node."""
        return f"{self.node}.{self.name}"

    def accepted(self, given: Any) -> Any:
        """A value of this parameter's type from what a page sends: a text or a value.

        Raises ParameterError for another one.
        """
        if isinstance(self.value, (str, bool)):
            if type(given) is type(self.value):
                return given
            kind = "text" if isinstance(self.value, str) else "true or false"
            raise ParameterError(f"{self.name} must be {kind}, given {given!r}")
        read = parse_yaml(given, self.name) if isinstance(given, str) else given
        if isinstance(self.value, (int, float)):
            number = number_from_text(read)
            if not is_number(number):
                raise ParameterError(f"{self.name} must be a number, given {given!r}")
            return float(number) if isinstance(self.value, float) else number
        numbers = [number_from_text(each) for each in (read if isinstance(read, list) else [read])]
        if not all(is_number(number) for number in numbers):
            raise ParameterError(f"{self.name} must be a list of numbers, given {given!r}")
        return [float(number) for number in numbers]

    def about(self) -> dict[str, Any]:
        """What the page makes a control of (web/controls.js)."""
        plain = IN_SIGHT.get(self.full_name)
        allowed = f"{self.low:g} to {self.high:g}" if math.isfinite(self.high - self.low) else ""
        limits = allowed or ("" if self.choices else self.constraints)
        about: dict[str, Any] = {
            "name": self.full_name,
            "title": plain["name"] if plain else self.name,
            "symbol": plain.get("symbol", "") if plain else "",
            "meaning": self.meaning + (f"; {limits}" if limits else ""),
            "unit": self.unit,
            "group": self.node,
            "fixed": self.read_only,
            "in_sight": list(IN_SIGHT).index(self.full_name) + 1 if plain else 0,
            "idle": plain.get("idle") if plain else None,
        }
        if isinstance(self.value, bool):
            about |= {"values": [True, False], "words": ["on", "off"]}
        elif self.full_name == COMPENSATION:
            words = [TITLES.get(each, each) for each in self.choices]
            about |= {"values": self.choices, "words": words}
        elif self.choices:
            about |= {"values": self.choices, "words": self.choices}
        elif plain and is_number(self.value) and self.low < self.high:
            about["slider"] = slider_range(self.value, self.low, self.high)
        return about


def is_number(value: Any) -> bool:
    """Whether it is a number that ROS can hold."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 2**63


def slider_range(value: float, low: float, high: float) -> tuple[float, float, float]:
    """Ends and step of a slider that moves ``value`` within the allowed range.

    The allowed range can be millions of times as wide as any useful value. So the slider reaches a
    few times the present one.
    """
    reach = REACH * abs(value) or 1.0
    power = 10.0 ** math.floor(math.log10(reach))
    reach = math.ceil(reach / power - 1e-9) * power  # rounded up
    low, high = max(low, 0.0 if value >= 0.0 else -reach), min(high, reach)
    return low, high, 10.0 ** math.floor(math.log10((high - low) / STEPS))

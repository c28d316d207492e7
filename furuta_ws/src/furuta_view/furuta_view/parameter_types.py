"""What the page knows of a parameter: only what the parameter services of its node tell."""

import math
from typing import Any, NamedTuple

from furuta_model.parameters import ParameterError, number_from_text
from furuta_ros.yaml_files import parse_yaml

CHOICES = "one of "
# A range of at most this many times the value is a slider's range as it is.
WHOLE_RANGE = 20.0
# Otherwise the slider reaches so many times the value.
REACH = 3.0
# Steps of a slider.
STEPS = 1000


class Described(NamedTuple):
    """A parameter: name, value, meaning with unit, range and choices where there are any.

    ``title`` is shown instead of the last part of its name, with the ``node`` before the name.
    """

    name: str
    value: Any
    meaning: str = ""
    constraints: str = ""
    low: float = float("-inf")
    high: float = float("inf")
    read_only: bool = False
    node: str = ""
    title: str = ""

    @property
    def choices(self) -> tuple[str, ...]:
        """The allowed words, if the node lists them, with the name of an own part if it is one."""
        if not isinstance(self.value, str) or not self.constraints.startswith(CHOICES):
            return ()
        words = self.constraints.removeprefix(CHOICES).split(", ")
        return tuple(dict.fromkeys([*(word for word in words if " " not in word), self.value]))

    @property
    def unit(self) -> str:
        """The unit at the end of the meaning, in brackets, or nothing."""
        before, bracket, unit = self.meaning.rpartition("[")
        return f" [{unit}" if bracket and unit.endswith("]") and before else ""

    @property
    def label(self) -> str:
        """Title or short name, and unit."""
        return (self.title or self.name.rpartition(".")[2]) + self.unit

    @property
    def hint(self) -> str:
        """Full name, meaning and what is allowed."""
        full_name = f"{self.node}.{self.name}".lstrip(".")
        bounded = math.isfinite(self.low) and math.isfinite(self.high)
        allowed = f"{self.low:g} to {self.high:g}" if bounded else self.constraints
        return f"{full_name}: {self.meaning}" + (f"; {allowed}" if allowed else "")

    @property
    def text(self) -> str:
        """The value as text, as a parameter file has it."""
        is_list = not isinstance(self.value, (str, bool, int, float))
        return str(list(self.value)) if is_list else str(self.value)

    def parsed(self, text: str) -> Any:
        """A value of this parameter's type from text. Raises ParameterError for other text."""
        value = parse_yaml(text, self.name)
        if isinstance(self.value, str):
            return text
        numbers = [number_from_text(n) for n in (value if isinstance(value, list) else [value])]
        if not all(isinstance(number, (int, float)) for number in numbers):
            raise ParameterError(f"{self.name} must be a list of numbers, given {text!r}")
        return [float(number) for number in numbers]


def slider_range(value: float, low: float, high: float) -> tuple[float, float, float]:
    """Ends and step of a slider that moves ``value`` within the allowed range.

    The allowed range can be millions of times as wide as any useful value. The slider then reaches
    a few times the present one, or far from 0, which tells no size. Of a whole number all three are
    whole.
    """
    reach = REACH * abs(value) or WHOLE_RANGE
    if not high - low <= WHOLE_RANGE * (abs(value) or 1.0):
        power = 10.0 ** math.floor(math.log10(reach))
        reach = math.ceil(reach / power - 1e-9) * power  # rounded up
        low, high = max(low, 0.0 if value > 0.0 and low == -math.inf else -reach), min(high, reach)
    low, high = min(low, value), max(high, value)
    if isinstance(value, int):
        return math.floor(low), math.ceil(high), 1
    return low, high, 10.0 ** math.floor(math.log10((high - low or 1.0) / STEPS))

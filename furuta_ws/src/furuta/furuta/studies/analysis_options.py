"""Parameters and ranges of an analysis, and the ideal loop that they describe."""

from typing import NamedTuple

import numpy as np

from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.loops import LACKS, ideal_loop, left_out
from furuta.settings.nodes import PLANT
from furuta.settings.parameter_names import parameters_named
from furuta.settings.settings import Settings, default_settings, loop, loop_with
from furuta_model.parameters import ParameterError

# Gains of u = l·x, which have names here although they are no parameters of a node.
GAINS = ("l1", "l2", "l3", "l4")
MAX_VALUES = 1000


class AnalysisOptions(NamedTuple):
    """Settings, friction law and feedback u = l·x of an analysis.

    Without a law it is the plant's, without a feedback the controller's.
    """

    settings: Settings = default_settings()
    law: str | None = None
    feedback: tuple[float, float, float, float] | None = None
    linear: bool = False

    def ideal_loop(self, values: dict[str, float] | None = None) -> IdealLoop:
        """The ideal loop with further values of parameters or of the gains l1 to l4."""
        values = values or {}
        named = {name: float(value) for name, value in values.items() if name not in GAINS}
        ideal = ideal_loop(loop_with(self.settings, named), law=self.law, linear=self.linear)
        gains = self.feedback or ideal.gains
        l1, l2, l3, l4 = (values.get(*pair) for pair in zip(GAINS, gains, strict=True))
        return ideal.with_gains((l1, l2, l3, l4))

    def left_out(self) -> list[str]:
        """Names of the given parameters that the ideal loop idealises."""
        return left_out(loop(self.settings))

    def value(self, name: str) -> float | None:
        """The value of a parameter or gain in the settings, None if nodes have different values."""
        if name in GAINS:
            return float(getattr(self.ideal_loop(), name))
        values = {
            self.settings[node].get(declared.name, declared.default)
            for node, declared in parameters_named(name)
        }
        return float(values.pop()) if len(values) == 1 else None


def parse_range(text: str, default_count: int) -> tuple[str, np.ndarray]:
    """Name and values of NAME=LOW:HIGH or NAME=LOW:HIGH:COUNT."""
    name, _, rest = text.partition("=")
    parts = rest.split(":")
    try:
        low, high = float(parts[0]), float(parts[1])
        count = int(parts[2]) if len(parts) > 2 else default_count
    except (ValueError, IndexError):
        raise ParameterError(
            f"expected NAME=LOW:HIGH[:COUNT], such as omega1=2:12, given {text!r}"
        ) from None
    if len(parts) > 3 or not (np.isfinite([low, high]).all() and low < high):
        raise ParameterError(f"{name}: needs finite LOW < HIGH, given {rest!r}")
    if not 2 <= count <= MAX_VALUES:
        raise ParameterError(f"{name}: COUNT must be 2 to {MAX_VALUES}, given {count}")
    return name.strip(), np.linspace(low, high, count)


def parse_varied(text: str, default_count: int) -> tuple[str, np.ndarray]:
    """Like :func:`parse_range`, for a number of the ideal loop; other names are rejected."""
    name, values = parse_range(text, default_count)
    for node, parameter in () if name in GAINS else parameters_named(name):
        if node == PLANT and parameter.name in LACKS:
            raise ParameterError(f"the ideal loop has no plant.{parameter.name} to vary")
        if parameter.kind not in (float, int):
            raise ParameterError(f"{name} is not a number")
    return name, values

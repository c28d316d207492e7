"""What each quantity is called and how it looks, on the page and in figures."""

from typing import Final, NamedTuple


class Quantity(NamedTuple):
    """Name, symbol, unit, and the colours on light and on dark ground."""

    name: str
    symbol: str
    unit: str
    light: str
    dark: str

    @property
    def title(self) -> str:
        """Name and symbol."""
        return f"{self.name} {self.symbol}"

    @property
    def axis(self) -> str:
        """The same with the unit, for an axis."""
        return f"{self.title} [{self.unit}]"


QUANTITIES: Final = {
    "arm": Quantity("arm", "φ", "rad", "#1b68c7", "#5aa6ff"),
    "pendulum": Quantity("pendulum", "θ", "rad", "#b85308", "#ff9a45"),
    "command": Quantity("voltage", "u", "V", "#7d41b3", "#c490f2"),
    "friction": Quantity("friction", "F", "V", "#1d2733", "#e9eef4"),
    "estimate": Quantity("estimate", "F̂", "V", "#087a59", "#34c795"),
}

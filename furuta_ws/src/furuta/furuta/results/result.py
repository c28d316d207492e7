"""What every result can do: be a dictionary, be read, be drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from textwrap import fill
from typing import Any, ClassVar

from furuta.results.plain import plain
from furuta.results.text import WIDTH, values_text
from furuta_model.parameters import ParameterError


class Result:
    """What a study found: a dataclass, of which the fields with ``repr`` are in :meth:`to_dict`.

    It prints as :meth:`report`. The names of :meth:`to_dict` are those of ``--json`` on the command
    line; a name ends in the unit of its value, or ``units`` has it. Angles are in rad.
    """

    # Properties that count as fields, and names of values that a person does not need to see.
    also: ClassVar[tuple[str, ...]] = ()
    details: ClassVar[frozenset[str]] = frozenset()

    def _by_name(self) -> dict[str, Any]:
        """Everything by name."""
        own: tuple[Any, ...] = fields(self) if is_dataclass(self) else ()
        names = (*(field.name for field in own if field.repr), *self.also)
        return {name: getattr(self, name) for name in names}

    def to_dict(self) -> dict[str, Any]:
        """Everything by name, as numbers, text, lists and dictionaries; None for no finite value.

        ``json.dumps`` takes it.
        """
        values: dict[str, Any] = plain(self._by_name())
        return values

    def sentence(self) -> str:
        """What was found, in words."""
        return ""

    def report(self) -> str:
        """What was found: a sentence, then a table of at most 80 columns."""
        shown = {name: each for name, each in self.to_dict().items() if name not in self.details}
        return "\n\n".join(filter(None, (fill(self.sentence(), WIDTH), self.table(shown))))

    def table(self, values: Mapping[str, Any]) -> str:
        """The values as lines of text."""
        return values_text(values)

    def plot(self, axes: Any = None) -> Any:
        """Draw it.

        Args:
            axes: Axes of matplotlib to draw on, as many as a figure of it has; by default those of
                a new figure.

        Returns:
            The axes, one or an array of them. ``numpy.ravel(axes)[0].figure`` is their figure.

        Raises:
            ParameterError: There is nothing to draw, or it needs another number of axes.
        """
        raise ParameterError(f"{type(self).__name__} has no figure")

    def __repr__(self) -> str:
        return self.report()

"""The parameters of a node on the page: a folder, and in it a control per parameter.

The page knows of a parameter only what the parameter services of its node tell.
"""

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

from furuta_bringup.page.page_layout import Note
from furuta_model.parameters import ParameterError, number_from_text
from furuta_ros.yaml_files import parse_yaml

CHOICES = "one of "
SLASH = "\N{DIVISION SLASH}"
# A range of at most this many times the value is a slider's range as it is.
WHOLE_RANGE = 20.0
# Otherwise the slider reaches so many times the value.
REACH = 3.0
# Steps of a slider.
STEPS = 1000
# What a control calls with the value that the user has entered.
Enter = Callable[[Any], None]


class Described(NamedTuple):
    """A parameter: name, value, meaning with unit, range and choices where there are any.

    ``title`` is shown instead of the last part of its name, with the ``node`` before the name, and
    ``words`` instead of its choices.
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
    words: Mapping[str, str] = {}

    @property
    def choices(self) -> tuple[str, ...]:
        """The allowed words, if the node lists them, with the name of an own part if it is one."""
        if not isinstance(self.value, str) or not self.constraints.startswith(CHOICES):
            return ()
        words = self.constraints.removeprefix(CHOICES).split(", ")
        listed = (word for word in words if " " not in word)
        return tuple(dict.fromkeys([*self.words, *listed, self.value]))

    @property
    def shown(self) -> Any:
        """The value as its control shows it."""
        return self.words.get(self.value, self.value) if self.words else self.value

    def meant(self, shown: Any) -> Any:
        """The value of which a control shows this."""
        return next((value for value, word in self.words.items() if word == shown), shown)

    @property
    def unit(self) -> str:
        """The unit at the end of the meaning, in brackets, or nothing."""
        before, bracket, unit = self.meaning.rpartition("[")
        return f" [{unit}" if bracket and unit.endswith("]") and before else ""

    @property
    def label(self) -> str:
        """Title or short name, and unit."""
        # Lines break after a slash, and a unit must not.
        return (self.title or self.name.rpartition(".")[2]) + self.unit.replace("/", SLASH)

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


class Control:
    """A control for one parameter, and under it the node's reason when it refuses a value."""

    def __init__(self, gui: Any, order: float, described: Described, enter: Enter) -> None:
        self._gui, self._enter = gui, enter
        self.described = described
        value = described.value
        self._is_slider = (
            isinstance(value, (int, float))
            and not isinstance(value, bool)
            and not described.read_only
        )
        self._handle = self._make(order)
        # What the handle has as far as this knows; a user's newer value comes before its callback.
        self._known = self._handle.value
        self._refusal = Note(gui, order + 0.5, "refusal")

    def update(self, value: Any) -> None:
        """Show the value that the node has."""
        self.described = self.described._replace(value=value)
        self._refusal.tell("")
        self._show()

    def refuse(self, reason: str) -> None:
        """Show why the node refuses a value, and the value that it has."""
        self._refusal.fail(reason)
        self._show()

    def _make(self, order: float) -> Any:
        gui, it = self._gui, self.described
        about: dict[str, Any] = {"hint": it.hint, "disabled": it.read_only}
        handle: Any
        if it.choices and not it.read_only:
            words = [it.words.get(choice, choice) for choice in it.choices]
            handle = gui.add_dropdown(it.label, words, initial_value=it.shown, **about, order=order)
        elif isinstance(it.value, bool):
            handle = gui.add_checkbox(it.label, it.value, **about, order=order)
        elif self._is_slider:
            low, high, step = slider_range(it.value, it.low, it.high)
            handle = gui.add_slider(it.label, low, high, step, it.value, **about, order=order)
        elif it.read_only:
            return gui.add_text(it.label, it.text, **about, order=order)
        else:
            return self._text_in_form(about, order)
        handle.on_update(self._changed)
        return handle

    def _text_in_form(self, about: dict[str, Any], order: float) -> Any:
        """A text that is passed on with the Enter key."""
        it = self.described
        with self._gui.add_form(None, order=order) as form:
            handle = self._gui.add_text(f"{it.label} (Enter)", it.text, **about)
        form.on_submit(lambda _: self._entered(handle.value))
        return handle

    def _entered(self, text: str) -> None:
        try:
            self._enter(self.described.parsed(text))
        except ParameterError as error:
            self.refuse(str(error))

    def _changed(self, event: Any) -> None:
        """Pass on what a user has chosen, not what :meth:`_show` has."""
        if event.client is not None:
            self._known = self._handle.value
            self._enter(self.described.meant(self._known))

    def _show(self) -> None:
        it = self.described
        is_text = isinstance(self._handle.value, str) and not it.choices
        if not is_text and self._handle.value != self._known:
            return  # the user has moved on, and will be heard next
        if self._is_slider:  # a value that was typed may lie beyond its ends
            self._handle.max = max(self._handle.max, it.value)
            self._handle.min = min(self._handle.min, it.value)
        self._known = it.text if is_text else it.shown
        if self._handle.value != self._known:
            self._handle.value = self._known


class NodeFolder:
    """The folder of a node, with a folder for each group of its parameters.

    ``enter`` is called with the name of a parameter and the value that the user has entered.
    """

    def __init__(
        self,
        gui: Any,
        node: str,
        parameters: list[Described],
        enter: Callable[[str, Any], None],
        order: float,
    ) -> None:
        self._gui, self._enter = gui, enter
        self.controls: dict[str, Control] = {}
        self._folder = gui.add_folder(node, expand_by_default=False, order=order)
        groups: dict[str, list[Described]] = {}
        for parameter in parameters:
            groups.setdefault(parameter.name.rpartition(".")[0], []).append(parameter)
        with self._folder:
            self._add(groups.pop("", []))
            for group, members in groups.items():
                with gui.add_folder(group, expand_by_default=False):
                    self._add(members)

    def remove(self) -> None:
        """Remove the folder: the node has ended, or has other parameters now."""
        self._folder.remove()

    def _add(self, members: list[Described]) -> None:
        """Controls in order of appearance; those that are fixed since the start at the end."""
        for order, member in enumerate(sorted(members, key=lambda member: member.read_only)):
            enter = partial(self._enter, member.name)
            self.controls[member.name] = Control(self._gui, float(order), member, enter)

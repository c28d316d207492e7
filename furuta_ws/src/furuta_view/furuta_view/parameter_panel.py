"""The parameters of a node on the page: a folder, and in it a control per parameter."""

from collections.abc import Callable
from functools import partial
from typing import Any

from furuta_model.parameters import ParameterError
from furuta_view.page_layout import Note
from furuta_view.parameter_types import Described, slider_range

# What a control calls with the value that the user has entered.
Enter = Callable[[Any], None]


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
            handle = gui.add_dropdown(
                it.label, it.choices, initial_value=it.value, **about, order=order
            )
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
            self._enter(self._known)

    def _show(self) -> None:
        it = self.described
        is_text = isinstance(self._handle.value, str) and not it.choices
        if not is_text and self._handle.value != self._known:
            return  # the user has moved on, and will be heard next
        if self._is_slider:  # a value that was typed may lie beyond its ends
            self._handle.max = max(self._handle.max, it.value)
            self._handle.min = min(self._handle.min, it.value)
        self._known = it.text if is_text else it.value
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

"""The parameters of all nodes on the page: a folder per node, a control per parameter."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from typing import Any

from furuta_model.parameters import ParameterError
from furuta_view.parameter_types import Described, slider_range

# What a control calls with the value that the user has entered.
Enter = Callable[[Any], None]


class Control:
    """A control for one parameter, and under it the node's reason when it refuses a value."""

    def __init__(self, gui: Any, order: float, described: Described, enter: Enter) -> None:
        self._gui, self._enter = gui, enter
        self.described = described
        value = described.value
        self._is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        self._handle = self._make(order)
        # What the handle has as far as this knows; a user's newer value comes before its callback.
        self._known = self._handle.value
        self._refusal = gui.add_html("", visible=False, order=order + 0.5)

    def update(self, value: Any) -> None:
        """Show the value that the node has."""
        self.described = self.described._replace(value=value)
        self._refusal.visible = False
        self._show()
        if self._is_number and not self.described.read_only:
            self._ends = self._handle.min, self._handle.max

    def refuse(self, reason: str) -> None:
        """Show why the node refuses a value, and the value that it has."""
        self._refusal.content = (
            '<div class="refusal" style="color:#b91c1c;font-size:14px;padding:0 8px 6px">'
            f"{escape(reason)}</div>"
        )
        self._refusal.visible = True
        self._show()
        if self._is_number and not self.described.read_only:
            self._handle.min, self._handle.max = self._ends

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
        elif self._is_number and not it.read_only:
            handle = self._slider(about | {"order": order})
        else:
            return self._text(about, order)
        handle.on_update(self._changed)
        return handle

    def _slider(self, about: dict[str, Any]) -> Any:
        it = self.described
        low, high, step = slider_range(it.value, it.low, it.high)
        self._ends = low, high
        return self._gui.add_slider(it.label, low, high, step, it.value, **about)

    def _text(self, about: dict[str, Any], order: float) -> Any:
        """A text that is passed on with the Enter key."""
        it = self.described
        if it.read_only:
            return self._gui.add_text(it.label, it.text, **about, order=order)
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
        if event.client is None:
            return
        value = self._known = self._handle.value
        if self._is_number:
            self._widen(value)
        self._enter(value)

    def _show(self) -> None:
        it = self.described
        if self._is_number and not it.read_only:
            self._widen(it.value)
        is_text = isinstance(self._handle.value, str) and not it.choices
        if not is_text and self._handle.value != self._known:
            return  # the user has moved on, and will be heard next
        self._known = it.text if is_text else it.value
        if self._handle.value != self._known:
            self._handle.value = self._known

    def _widen(self, value: float) -> None:
        """Let the slider reach a value that was typed; the node decides whether it is allowed."""
        self._handle.max = max(self._handle.max, value)
        self._handle.min = min(self._handle.min, value)


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
        for each in parameters:
            groups.setdefault(each.name.rpartition(".")[0], []).append(each)
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
        for order, each in enumerate(sorted(members, key=lambda each: each.read_only)):
            enter = self._enterer(each.name)
            self.controls[each.name] = Control(self._gui, float(order), each, enter)

    def _enterer(self, name: str) -> Enter:
        return lambda value: self._enter(name, value)

"""Controls of the page without a graph: what the bridge says, and what the user has chosen."""

from types import SimpleNamespace
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

from furuta_bringup.page.parameter_panel import Control, Described
from furuta_bringup.page.rig_controls import RigControls
from furuta_bringup.page.server import PageServer


def test_silent_bridge_is_not_shown_as_it_was() -> None:
    """A bridge that has ended said last that it is armed; that may be wrong now."""
    server, link = PageServer(), SimpleNamespace(bridge=SimpleNamespace(arm=None, disarm=None))
    rig = RigControls(server, link)  # type: ignore[arg-type]
    said = {"armed": "True", "state": "active", "stops": "0"}
    values = [KeyValue(key=key, value=value) for key, value in said.items()]
    status = DiagnosticStatus(message="driving", values=values)
    rig.show(None, 1.0)
    assert "no diagnostics" in rig.shown.content
    rig.show(status, 1.0)
    assert "ARMED" in rig.shown.content
    rig.show(status, 30.0)
    assert "ARMED" not in rig.shown.content
    assert "silent for 30 s" in rig.shown.content
    server.stop()


def test_an_older_value_does_not_take_back_what_the_user_has_chosen() -> None:
    """The node confirms a value while the page has a newer one, of which nobody was told yet."""
    callbacks: list[Any] = []
    slider = SimpleNamespace(value=0.2, min=0.0, max=1.0, on_update=callbacks.append)
    gui = SimpleNamespace(
        add_slider=lambda *_, **__: slider, add_html=lambda *_, **__: SimpleNamespace()
    )
    entered: list[float] = []
    control = Control(gui, 0.0, Described("alpha0", 0.2, low=0.0, high=1.0), entered.append)
    by_user = SimpleNamespace(client=object())
    slider.value = 0.3
    callbacks[0](by_user)
    slider.value = 0.4
    control.update(0.3)
    callbacks[0](by_user)
    assert entered == [0.3, 0.4]
    control.update(0.4)
    control.update(0.5)  # set by someone else
    assert slider.value == 0.5

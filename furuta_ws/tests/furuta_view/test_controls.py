"""Controls of the page without a graph: who has paused it, and what the bridge says."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

from furuta_view.page_layout import Note
from furuta_view.parameter_panel import Control
from furuta_view.parameter_types import Described
from furuta_view.rig_controls import RigControls
from furuta_view.server import PageServer
from furuta_view.simulation_controls import SimulationControls


@pytest.fixture
def server() -> Iterator[PageServer]:
    server = PageServer()
    yield server
    server.stop()


def test_plant_continues_without_the_page_that_paused_it(server: PageServer) -> None:
    """Another page that is closed changes nothing."""
    link: Any = None
    controls = SimulationControls(server, link, Note(server.gui, 1.0))
    pacer = controls.pacer
    first, second = (SimpleNamespace(client_id=number) for number in (1, 2))
    controls.set_paused(True, first)
    assert pacer.holds
    controls.client_gone(second)
    assert pacer.holds
    controls.client_gone(first)
    assert not pacer.holds
    assert pacer.run_until(1.0, 5.0) > 5.0


def test_silent_bridge_is_not_shown_as_it_was(server: PageServer) -> None:
    """A bridge that has ended said last that it is armed; that may be wrong now."""
    link: Any = None
    rig = RigControls(server, link)
    said = {"armed": "True", "state": "active", "stops": "0"}
    values = [KeyValue(key=key, value=value) for key, value in said.items()]
    status = DiagnosticStatus(message="driving", values=values)
    rig.show(None, 1.0)
    assert "no diagnostics" in rig.text
    rig.show(status, 1.0)
    assert "ARMED" in rig.text
    rig.show(status, 30.0)
    assert "ARMED" not in rig.text
    assert "silent for 30 s" in rig.text


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

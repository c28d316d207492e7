"""The description of the graph, and the plan of a graph to start."""

from pathlib import Path

import pytest

from furuta.settings.nodes import NODES
from furuta.settings.settings import load_settings, parameters_of
from furuta_bringup.graph.graph_plan import GraphOptions, plan_graph
from furuta_model.parameters import ParameterError, values

OTHERS = ["estimator", "friction_observer", "controller"]


@pytest.mark.parametrize("hardware", [False, True])
def test_the_rig_reaches_every_node(other_rig: Path, hardware: bool) -> None:
    """Model, friction, sensors, sample time and limits, whatever is controlled."""
    graph = plan_graph(GraphOptions(hardware, rig=str(other_rig), port="mock" * hardware))
    made = parameters_of(graph.settings)
    model = made["controller"].model
    assert model != NODES["controller"].parameters().model  # type: ignore[attr-defined]
    assert made["estimator"].model == made["plant"].plant.model == model
    # Viscous friction is in the model of estimator and controller, not in the friction estimate.
    friction = made["plant"].plant.friction.parameters
    assert made["friction_observer"].observer.friction == friction._replace(viscous=0.0)
    assert made["estimator"].model_viscous == made["controller"].model_viscous == friction.viscous
    assert made["estimator"].sensors == made["plant"].plant.sensors
    assert {values(made[name])["sample_time"] for name in OTHERS} == {0.002}
    assert made["plant"].plant.sample_time == 0.002
    assert made["controller"].voltage_limit == 5.0


def test_bridge_rig_in_a_parameter_file_reaches_every_node(other_rig: Path, tmp_path: Path) -> None:
    """A rig that only the bridge's parameter names is the rig of the whole graph."""
    file = tmp_path / "bridge.yaml"
    file.write_text(f"hardware_bridge: {{ros__parameters: {{rig: {other_rig}, port: mock}}}}")
    graph = plan_graph(GraphOptions(hardware=True), [file])
    assert graph.settings["estimator"]["sample_time"] == 0.002
    assert graph.settings["hardware_bridge"]["rig"] == str(other_rig)


def test_parameters_take_precedence_over_the_rig(other_rig: Path, tmp_path: Path) -> None:
    """First the base, then the rig, then files, then assignments."""
    file = tmp_path / "file.yaml"
    file.write_text("plant: {ros__parameters: {friction: {alpha0: 0.3, alpha1: 0.4}}}")
    base = load_settings([], ["plant.friction.alpha0=0.1", "plant.seed=7"])
    options = GraphOptions(rig=str(other_rig))
    plant = plan_graph(options, [file], ["plant.friction.alpha1=0.5"], base).settings["plant"]
    assert (plant["friction.alpha0"], plant["friction.alpha1"], plant["seed"]) == (0.3, 0.5, 7)
    assert plant["sample_time"] == 0.002


@pytest.mark.parametrize("assignment", ["read_only=true", "hardware_bridge.autostart=unconfigured"])
def test_what_is_chosen_for_the_bridge_holds(assignment: str) -> None:
    """A rig that must not be driven stays passive; otherwise the bridge connects by itself."""
    options = GraphOptions(hardware=True, port="mock")
    usual = plan_graph(options).settings["hardware_bridge"]
    chosen = plan_graph(options, assignments=[assignment]).settings["hardware_bridge"]
    assert (usual["autostart"], usual.get("read_only", False)) == ("active", False)
    expected = {"read_only=true": ("inactive", True)}.get(assignment, ("unconfigured", False))
    assert (chosen["autostart"], chosen.get("read_only", False)) == expected


@pytest.mark.parametrize(
    ("options", "assignments", "reason"),
    [
        (GraphOptions(), ["plant.sample_time=0.002"], "sample_time must be the same"),
        (GraphOptions(hardware=True), ["sample_time=0.002"], "the rig's sample_time is 0.001 s"),
        (GraphOptions(clock="lockstep"), ["clock=realtime"], "--lockstep sets plant.clock and so"),
        (GraphOptions(seconds=3.0), ["run_until=5.0"], "--seconds sets plant.run_until and so"),
        (GraphOptions(hardware=True, port="a"), ["port=b"], "and so does --set port=b"),
        (GraphOptions(without=("plant",)), [], f"without {', '.join(OTHERS)}; given plant"),
    ],
)
def test_graphs_that_do_not_fit_together(
    options: GraphOptions, assignments: list[str], reason: str
) -> None:
    """There is no plan for a graph whose nodes contradict each other."""
    with pytest.raises(ParameterError, match=reason):
        plan_graph(options, assignments=assignments)

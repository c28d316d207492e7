"""The scenes of joints that stick: their exact values, and the row of one simulator."""

import json
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from sources import ROOT, loaded

import furuta
from furuta.axis.joint_file import JointFile
from furuta.export.joint_models import joint_model

FOLDER = ROOT / "examples" / "sticking"
SCENES = {
    scene["name"]: scene for scene in json.loads((FOLDER / "scenes.json").read_text())["scenes"]
}
# Verdict of MuJoCo at the shortest step, by variant; the other scenes are not offered.
MUJOCO = {
    "": {"creep": "soft", "ramp": "soft", "coast": "right"},
    "noslip": {"hold": "right", "creep": "right", "ramp": "right"},
    "lugre": {"creep": "right", "coast": "right", "static": "right", "bristle": "right"},
}


@pytest.fixture(scope="module")
def truths() -> ModuleType:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(FOLDER)
        return loaded(FOLDER / "truths.py")


@pytest.fixture(scope="module")
def run() -> ModuleType:
    return loaded(FOLDER / "run.py")


@pytest.mark.parametrize("name", SCENES)
def test_both_methods_give_the_value_in_the_file(truths: ModuleType, name: str) -> None:
    scene = SCENES[name]
    values = zip(truths.by_library(scene), truths.by_events(scene), scene["measured"], strict=True)
    for one, other, measured in values:
        assert measured["error"] <= 1e-6 * measured["scale"]
        assert one == pytest.approx(measured["exact"], rel=0.0, abs=measured["error"])
        assert other == pytest.approx(measured["exact"], rel=0.0, abs=measured["error"])


def test_twelve_scenes_say_what_they_are() -> None:
    laws = json.loads((FOLDER / "scenes.json").read_text())["laws"]
    assert len(SCENES) == 12
    for scene in SCENES.values():
        assert scene["law"] in laws
        assert {"parameters", "start", "torque", "seconds", "without_law"} <= set(scene)


def naive_joint(law: str, p: dict[str, float], q: float, v: float, step: float, _: str) -> Any:
    """Coulomb friction as sgn v in each step: it never sticks."""
    state = np.array([q, v])

    def move(torque: float) -> tuple[float, float]:
        friction = p["coulomb"] * np.sign(state[1]) + p["viscous"] * state[1]
        state[1] += step * (torque - friction) / p["inertia"]
        state[0] += step * state[1]
        return state[0], state[1]

    return move


def test_friction_that_chatters_is_no_friction_that_sticks(run: ModuleType) -> None:
    scene = SCENES["creep"]
    rows = run.simulate(SimpleNamespace(joint=naive_joint), "", scene, run.STEPS[-1])
    speed = run.value(rows, scene["measured"][0])
    assert run.verdict([speed], scene) == "soft"
    assert 1e-3 < speed <= 1.3 * run.STEPS[-1] / 0.1


def test_an_unknown_engine_is_named(run: ModuleType) -> None:
    with pytest.raises(SystemExit, match="there is no engine chrono"):
        run.load("chrono")


@pytest.mark.parametrize(
    ("variant", "name"), [(variant, name) for variant, row in MUJOCO.items() for name in row]
)
def test_row_of_mujoco(run: ModuleType, variant: str, name: str) -> None:
    pytest.importorskip("mujoco", reason="mujoco is not installed")
    module, _ = run.load("mujoco")
    scene, step = SCENES[name], run.STEPS[-1]
    rows = run.simulate(module, variant, scene, step)
    found = [run.value(rows, measured) for measured in scene["measured"]]
    assert run.verdict(found, scene) == MUJOCO[variant][name]
    if (variant, name) == ("", "creep"):
        # (1 - d) / d · dmax · timeconst / 2 of MuJoCo's defaults, times torque over inertia.
        creep = 0.1 / 0.9 * 0.95 * 0.02 / 2.0 * 0.3 / 0.1
        assert found[0] == pytest.approx(creep, rel=1e-3)


@pytest.mark.parametrize("variant", ["", "hard", "lugre"])
def test_exported_models_are_those_of_the_scenes(run: ModuleType, variant: str) -> None:
    """What the row of MuJoCo shows holds for the files of ``export`` too."""
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
    p, step = SCENES["hunting"]["parameters"], run.STEPS[-1]
    others = ("axis.viscous", "axis.offset", "axis.gravity_sin", "axis.gravity_cos")
    friction = furuta.Friction(
        alpha0=p["coulomb"],
        alpha1=p["static"] - p["coulomb"],
        stribeck_velocity=p["stribeck_speed"],
        viscous=p["viscous"],
    )
    values = {**friction._asdict(), "axis.inertia": p["inertia"], **dict.fromkeys(others, 0.0)}
    form = "mjcf" if variant else "urdf"
    text = joint_model(JointFile("elbow", values, None), form, lugre=variant == "lugre", step=step)
    exported = mujoco.MjModel.from_xml_string(text)
    module, _ = run.load("mujoco")
    body = {"height": 0.0, "moment": p["inertia"]}
    made, _ = module.model("stribeck", p | body, 0.0, 0.0, step, variant)
    names = ["dof_solref", "dof_solimp", "dof_frictionloss", "dof_damping", "dof_M0"]
    if variant == "lugre":
        names += ["actuator_dynprm", "actuator_gainprm", "actuator_biasprm"]
    for name in names:
        one, other = (getattr(model, name)[-1] for model in (exported, made))
        np.testing.assert_allclose(one, other, rtol=1e-6, err_msg=name)

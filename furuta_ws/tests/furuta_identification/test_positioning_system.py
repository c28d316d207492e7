"""The study of one joint in benchmarks: its model against closed solutions, and its fit."""

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sources import ROOT


@pytest.fixture(scope="module")
def study() -> Iterator[Any]:
    """The module that fits the model, imported from where it is."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "benchmarks"))
        yield import_module("positioning_system")


def record(study: Any, force: float, seconds: float = 1.0) -> Any:
    """A joint at rest under a constant force."""
    time = np.arange(0.0, seconds, 1e-3)
    return study.Record(time, np.zeros(len(time)), np.full(len(time), force))


@pytest.mark.parametrize(("force", "viscous"), [(60.0, 170.0), (-60.0, 230.0)])
def test_sliding_joint(study: Any, force: float, viscous: float) -> None:
    """Viscous friction by direction: x = (v_end)(t - T(1 - exp(-t/T)))."""
    joint = study.Joint(direction=-30.0, delay=0.0)
    given = record(study, force)
    v_end, constant = (abs(force) - joint.coulomb) / viscous, joint.mass / viscous
    t = given.time
    expected = np.sign(force) * v_end * (t - constant * (1.0 - np.exp(-t / constant)))
    np.testing.assert_allclose(study.predict(joint, given), expected, atol=5e-5)


def test_sticking_joint(study: Any) -> None:
    """Below the level it does not move at all; with presliding it moves its bristle."""
    given = record(study, 5.0)
    np.testing.assert_array_equal(study.predict(study.Joint(), given), 0.0)
    moved = study.predict(study.Joint(stiffness=1e5), given)
    # The bristle's deflection is -(F_c/σ₀) ln(1 - F/F_c), and more after the first overshoot.
    assert 5.5e-5 < moved[-1] < 1.2e-4


def test_a_drift_does_not_bias_the_fit(study: Any) -> None:
    time = np.arange(-2.0, 2.0, 1e-3)
    force = 40.0 * np.sign(np.sin(4.0 * time)) + 15.0 * np.sin(11.0 * time)
    force[:50] = 0.0  # it starts at rest
    truth = study.Joint(95.0, 200.0, 20.0, -30.0, offset=0.3, level_slope=-4.0, drift=0.2)
    given = study.Record(time, np.zeros(len(time)), force)
    given = given._replace(position=study.predict(truth, given))
    names = (*study.CHOSEN, "drift")
    found = study.fit(given, names)
    values = {name: getattr(found, name) for name in names}
    assert values == pytest.approx({name: getattr(truth, name) for name in names}, rel=0.02)
    other = study.without_drift(found, given)
    assert other.drift == 0.0
    assert other.mass == found.mass


def test_another_table_is_refused(study: Any, tmp_path: Path) -> None:
    file = tmp_path / "table.csv"
    file.write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match="must have four columns") as caught:
        study.read_record(file)
    assert "\n" not in str(caught.value)

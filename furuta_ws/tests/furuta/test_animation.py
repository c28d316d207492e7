"""Animation of a run."""

from pathlib import Path

import numpy as np
from matplotlib import image

from furuta.figures.animation import ARM, PENDULUM, animate_run, positions
from furuta_sim.simulation.closed_loop import Record


def test_positions() -> None:
    """Hanging the tip is below the end of the arm; horizontal it is across the arm."""
    np.testing.assert_allclose(
        positions(np.array((0.0, 0.0, np.pi, 0.0)))[2], (ARM, 0, -PENDULUM), atol=1e-12
    )
    tip = positions(np.array((np.pi / 2, 0.0, np.pi / 2, 0.0)))[2]
    np.testing.assert_allclose(tip, (-PENDULUM, ARM, 0), atol=1e-12)


def test_animation_is_a_moving_gif(tmp_path: Path) -> None:
    """The file has a frame for each twentieth of a second, and its frames differ."""
    samples = 300
    state = np.zeros((samples, 4))
    state[:, 2] = np.linspace(-np.pi, np.pi, samples)
    empty, series = np.zeros(samples), np.zeros((samples, 5))
    path = tmp_path / "new" / "run.gif"
    animate_run(Record(0.001, state, series, empty, empty, empty, series), path, 0.2)
    assert path.read_bytes().startswith(b"GIF89a")
    assert image.imread(path).shape[2] in (3, 4)
    assert path.read_bytes().count(b"\x21\xf9\x04") == 4

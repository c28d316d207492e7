"""``furuta linearize``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
import numpy as np

from furuta.margins import margins
from furuta_bringup.options import json_option, model_options, print_json
from furuta_model.linear import linearize
from furuta_sim.settings.settings import load_settings, loop


@click.command()
@model_options
@json_option
def command(files: tuple[Path, ...], assignments: tuple[str, ...], as_json: bool) -> None:
    """Print the controller's linear model, eqs. (2) and (3), its poles, and its gain, eq. (7).

    The margins are those of the loop whose friction is compensated exactly: factors of the torque,
    phase, delay, and the disk margin.
    """
    parameters = loop(load_settings(files, assignments)).controller
    a, b = linearize(parameters.model, parameters.model_viscous)
    gain = np.array(parameters.feedback_gain)

    def poles(matrix: np.ndarray) -> list[list[float]]:
        return [[float(p.real), float(p.imag)] for p in np.sort_complex(np.linalg.eigvals(matrix))]

    result: dict[str, Any] = {
        **parameters.model._asdict(),
        "A": a.tolist(),
        "B": b.tolist(),
        "open_loop_poles": poles(a),
        "L": gain.tolist(),
        "closed_loop_poles": poles(a - np.outer(b, gain)),
    }
    if np.all(np.linalg.eigvals(a - np.outer(b, gain)).real < 0.0):
        found = margins(parameters.model, gain, parameters.model_viscous)
        result["margins"] = found._asdict()
    if as_json:
        print_json(result)
        return
    np.set_printoptions(precision=6, suppress=True)
    for name, value in result.items():
        if name.endswith("poles"):
            print(f"{name}: " + ", ".join(f"{re:.4g}{im:+.4g}j" for re, im in value))
        elif isinstance(value, dict):
            print(f"{name}: " + ", ".join(f"{key} {each:.4g}" for key, each in value.items()))
        elif isinstance(value, list):
            print(f"{name}:\n{np.array(value)}")
        else:
            print(f"{name}: {value:.6g}")

"""Friction over the speed of the arm of an identified rig."""

from __future__ import annotations

import numpy as np

from furuta.identification.model import Model
from furuta.identification.regression.equations import SLOW, mean_command
from furuta.identification.regression.speeds import with_speeds
from furuta.identification.regression.windows import OVERLAP, Windows
from furuta.identification.result.friction_curve import FrictionCurve, friction_curve
from furuta_model.friction.laws import friction_law, steady_friction
from furuta_model.state import PHI_DOT
from furuta_recordings.recording import UNITS, Recording

# Part of a window in which the arm must turn in one direction.
ONE_WAY = 0.95


def rig_friction(model: Model) -> FrictionCurve:
    """Friction of the arm over its speed.

    It is measured over windows of 0.2 s in which the arm turns in one direction: the voltage minus
    the change of the arm's momentum, with the torques of tilt and waves.
    """
    shown = [_shown(model, recording) for recording in model.recordings]
    speeds, friction = (np.concatenate(each) for each in zip(*shown, strict=True))

    def law(vector: np.ndarray, speed: np.ndarray) -> np.ndarray:
        fitted = friction_law("lugre", model.values.changed(model.keys, vector).friction)
        return np.array([steady_friction(each, fitted) for each in speed])

    vector = model.values.vector(model.keys)
    samples = speeds, friction
    return friction_curve(law, vector, model.covariance, samples, OVERLAP, (UNITS[PHI_DOT], "V"))


def _shown(model: Model, recording: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Speeds and friction (n,) that a recording shows."""
    values, body, tilt = model.values, model.values.body, model.values.model.tilt
    recording = recording.with_ceiling(values["ceiling"]).with_delayed_command(values["delay"])
    ready = with_speeds(recording, values["lag"])
    windows = Windows(ready.time)
    phi, v, theta, w = ready.measured.T
    theta = theta + values.zero(recording.number)
    sine, cosine = np.sin(theta), np.cos(theta)
    momentum = (body.alpha + body.beta * sine**2) * v + body.gamma * cosine * w
    load = body.delta * sine * (tilt.x * np.cos(phi) + tilt.y * np.sin(phi))
    for order, of_cosine, of_sine in values.waves:
        load = load + of_cosine * np.cos(order * phi) + of_sine * np.sin(order * phi)
    whole = windows.mean(np.ones(len(v)))
    friction = mean_command(ready, windows) - windows.slope(momentum) + windows.mean(load)
    forward, backward = windows.mean(1.0 * (v > SLOW)), windows.mean(1.0 * (v < -SLOW))
    turns = np.maximum(forward, backward) > ONE_WAY * whole
    return (windows.mean(v) / whole)[turns], (friction / whole)[turns]

"""Fits a pendulum that swings from hanging: short segments first, then free runs."""

from collections.abc import Callable

import numpy as np

from furuta.identification.errors import noise_of
from furuta.identification.fitting.waves import with_waves
from furuta.identification.model import Model
from furuta.identification.options import Options
from furuta.identification.regression.speeds import turns_one_way
from furuta.identification.shooting.optimisation import (
    COARSE,
    FINE,
    Optimum,
    optimise,
    residual_scale,
    worst_pendulum_fit,
)
from furuta.identification.shooting.unknowns import (
    BODY,
    FRICTION,
    LUGRE,
    SETUP,
    UNKNOWNS,
    ParameterValues,
    assumed_spread,
    wave,
)
from furuta.identification.uncertainty.covariance import (
    covariance_and_information,
    difference_covariance,
    is_linear,
)
from furuta.identification.uncertainty.identifiability import identifiable
from furuta.identification.unknowns import Key, field_of
from furuta_recordings.recording import Recording, by_run

# Smallest scale of the residuals [rad, rad/s] at first, while the model is still incomplete.
FIRST_SCALE = (0.003, 0.03, 0.003, 0.03)
# Fit of the pendulum's angle [%] in free runs below which segments of a fixed length [s] are
# fitted instead: a pendulum that turns over the top is chaotic.
SMALLEST_FREE_RUN_FIT, SEGMENT = 80.0, 1.0
# The same before waves of the torque are looked for, which do not make up for more.
HOPELESS_FREE_RUN_FIT = 60.0
NOT_FOLLOWED = "no free run follows the recordings to the end"
# How far an arm gives way while it sticks changes when it breaks away, and so all other values. It
# is fitted even if the recordings do not show its value.
STIFFNESS = "sigma0"
# What no fit can find of an arm that turns in one direction only; the Coulomb friction that is then
# assumed, as a part of the largest command, and its upper limit.
DRY = ("coulomb", "asymmetry")
USUAL_PART = 0.03
LARGEST_PART = 0.25
# Lengths of the segments [s], one fit after the other: the longer a segment, the better its start
# must be.
SEGMENT_LENGTHS = (0.5, 1.5)
# Relative change of the sum of squares at which a rough fit ends.
ROUGH = 1e-2


def fit_swinging(
    recordings: list[Recording],
    start: ParameterValues,
    findings: list[str],
    options: Options,
) -> Model:
    """Fit free runs of all recordings; each channel is weighted by its own residuals."""
    window = options.window or np.inf
    keys: list[Key] = [*BODY, *FRICTION, *SETUP, *wave(1)]
    start = start.changed(wave(1), (0.0, 0.0))
    level = _assumed_level(recordings)
    if level:
        keys = [key for key in keys if key not in DRY]
        start = start.changed(DRY, (level, 0.0))
    own_fits = _own_fits(recordings, [*keys, "zero"], start, window, options.report)
    options.report("fitting all together")
    numbers = [run[0].number for run in by_run(recordings)]
    zeros: list[Key] = [("zero", number) for number in numbers]
    zeros = ["zero"] if len(numbers) == 1 else zeros
    ceiling = ["ceiling"] if np.isfinite(start["ceiling"]) and options.ceiling is None else []
    optimum = _common_fit(recordings, [*keys, *zeros, *ceiling], own_fits, window)
    free = options.window is None
    why = NOT_FOLLOWED if free and worst_pendulum_fit(optimum) < HOPELESS_FREE_RUN_FIT else ""
    if not why:
        options.report("looking for waves of the torque, then the final fit")
        optimum = _final_fit(optimum)
        why = _against_free_runs(optimum) if free else ""
    if why:
        findings = [*findings, f"{why}: fitted in segments of {SEGMENT:g} s"]
        options = options._replace(window=SEGMENT)
        return fit_swinging(recordings, start, findings, options)
    options.report("computing standard errors")
    assumed = {"coulomb": level} if level else {}
    assumed |= {name: assumed_spread(name) for name in LUGRE if name not in optimum.keys}
    covariance, information = covariance_and_information(optimum, assumed, swinging=True)
    covariance = covariance + difference_covariance(optimum, own_fits, assumed)
    keys, certainty = [*optimum.keys, *assumed], (covariance, information)
    findings = [*findings, *_remarks(level, optimum.values.wave_orders)]
    return Model(optimum.values, keys, *certainty, window, optimum.scale, recordings, findings)


def _assumed_level(recordings: list[Recording]) -> float:
    """Coulomb level [V] of an arm that turns in one direction only; 0 if a fit can find it."""
    if not all(turns_one_way(recording) for recording in recordings):
        return 0.0
    largest = max(recording.largest_command for recording in recordings)
    return min(max(USUAL_PART * largest, UNKNOWNS["coulomb"].spread), LARGEST_PART * largest)


def _remarks(level: float, orders: list[int]) -> list[str]:
    """What was found beyond the values."""
    assumed = (
        "the arm turns in one direction only, where Coulomb friction has the same effect as a "
        f"smaller command: assumed {level:.3g} ± {level:.3g} V"
    )
    ripple = [f"torque ripple with {order} waves per turn" for order in orders if order > 1]
    return [assumed, *ripple] if level else ripple


def _against_free_runs(optimum: Optimum) -> str:
    """Why free runs cannot be fitted; empty if they can."""
    if worst_pendulum_fit(optimum) < SMALLEST_FREE_RUN_FIT:
        return NOT_FOLLOWED
    if not is_linear(optimum):
        return "within the standard errors the free run turns into another one"
    return ""


def _own_fits(
    recordings: list[Recording],
    keys: list[Key],
    start: ParameterValues,
    window: float,
    report: Callable[[str], None],
) -> list[Optimum]:
    """A fit of each recording alone, with all its excerpts."""
    scale = np.median([noise_of(recording) for recording in recordings], axis=0)
    scale = np.maximum(scale, FIRST_SCALE)
    fits, runs = [], by_run(recordings)
    for number, run in enumerate(runs, 1):
        report(f"fitting {run[0].name}, {number} of {len(runs)}")
        fits.append(fit_growing_segments(run, keys, start, window, scale))
    return fits


def fit_growing_segments(
    excerpts: list[Recording],
    keys: list[Key],
    start: ParameterValues,
    window: float,
    scale: np.ndarray,
) -> Optimum:
    """Fit one recording in ever longer segments of at most ``window`` [s].

    After each fit its residuals weight the channels anew. The ``excerpts`` of a recording share its
    zero; of several, every other one and a rough fit are enough on the way.
    """
    tolerance = ROUGH if len(excerpts) > 1 else COARSE
    for length in SEGMENT_LENGTHS:
        size = min(length, window)
        optimum = optimise(excerpts[::2], keys, start, size, scale, True, tolerance)
        start, scale = optimum.values, residual_scale(optimum)
    return optimise(excerpts, keys, start, window, scale, robust=True)


def _common_fit(
    recordings: list[Recording], keys: list[Key], own_fits: list[Optimum], window: float
) -> Optimum:
    """A coarse fit of all recordings together, each with its own zero, with the stiffness at last.

    Several are fitted from the fit of the one that suits all best: a common fit from a worse start
    can end in a local optimum.
    """
    optimum = own_fits[0]
    scale = np.median([residual_scale(fit) for fit in own_fits], axis=0)
    if len(own_fits) > 1:
        zeros = [fit.values["zero"] for fit in own_fits]
        of_zeros = [key for key in keys if field_of(key) == "zero"]
        starts = [fit.values.changed(of_zeros, zeros) for fit in own_fits]

        def common_misfit(start: ParameterValues) -> float:
            states = optimise(recordings, (), start, window, scale, robust=False)
            return float(np.sum(np.log1p(states.fit.state.residuals**2)))

        start = min(starts, key=common_misfit)
        optimum = optimise(recordings, keys, start, window, scale, robust=True)
    scale = residual_scale(optimum)
    return optimise(recordings, [*keys, STIFFNESS], optimum.values, window, scale, robust=True)


def _final_fit(optimum: Optimum) -> Optimum:
    """The fit with torque ripple and bristle parameters as far as the data determine them."""
    optimum = with_waves(optimum)
    bristle = [name for name in LUGRE if name not in optimum.keys]
    keys = [*optimum.keys, *identifiable(optimum, bristle)]
    return optimum.refitted(keys, optimum.values, FINE)

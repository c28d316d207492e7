"""Whether a recording shows an elastic coupling of motor and arm, or backlash.

Two masses (:mod:`furuta_model.parts.coupling`) are simulated along segments of 0.5 s, from the
states of the rigid fit. What other values of the rigid model or other states at the starts could
explain does not count. Resonance, damping ratio, the motor's share of the inertia and the side of
the sensors are searched on a grid and fitted, in turn with the rigid model. The recording shows
them if they predict each quarter of it, from the other quarters, better than a rigid arm does.

Impacts in a gap have many optima: its size is searched, but not determined. If a gap predicts
better than a resonance, the recording shows backlash.
"""

from itertools import product

import numpy as np

from furuta_identification.fitting.coupling_residuals import CouplingResiduals, ElasticFit
from furuta_identification.model import CouplingFit, Model
from furuta_identification.shooting.optimisation import noise_of, quantisation_step
from furuta_model.parts.coupling import SIDES, Coupling
from furuta_model.state import PHI
from furuta_recordings.recording import Recording

# Most samples.
MOST_SAMPLES = 12_000
# Values that are reported; the frequency and the damping ratio are fitted by their logarithms.
NAMES = ("frequency", "damping", "motor_inertia")
# Grids: resonances; and gaps, without ringing after an impact.
FREQUENCIES, SHARES, DAMPING = np.geomspace(15.0, 220.0, 25), (0.3, 0.7), 0.05
GAPS, GAP_SHARES = np.geomspace(7e-4, 0.04, 8), (0.2, 0.4, 0.6, 0.8)
GAP_FREQUENCY, GAP_DAMPING = 150.0, 0.3
# Which of the unknowns a resonance and a gap have.
RESONANCE, GAP = slice(0, 3), slice(2, 4)
# Largest standard error of the logarithms, and of the share, of values that are reported.
LARGEST_ERRORS = {"frequency": 0.1, "damping": 0.5, "motor_inertia": 0.1}
# Largest part that a resonance may leave of what a rigid arm leaves beyond noise.
LARGEST_PART_LEFT = 0.5
# Part of the command's power that counts as its spectrum.
MOST_POWER = 0.99


def find_coupling(model: Model) -> CouplingFit:
    """The coupling that the recordings of a model show, or why they show none."""
    problem = _problem(model)
    rigid = problem.of(Coupling())
    refined, fit, change = problem.refined(_resonance(problem), RESONANCE)
    gap = _gap(problem)
    beyond, left = rigid @ rigid - problem.floor, fit.size - problem.floor
    gains, gap_gains = refined.gains(fit, rigid), problem.gains(gap, rigid)
    if _shown(gap_gains, rigid) and np.sum(gap_gains) > np.sum(gains):
        return CouplingFit(remark=BACKLASH.format(gap.side))
    errors = np.sqrt(np.diag(refined.covariance(fit)) + change**2)
    # What is left beyond noise is an error of the model, which the jackknife does not show.
    errors *= np.sqrt(max(1.0, fit.size / problem.floor))
    named = dict(zip(NAMES, map(float, errors), strict=True))
    if not _shown(gains, rigid) or fit.coupling.frequency > FREQUENCIES[-1]:
        return CouplingFit(remark=_not_shown(model.recordings))
    if left > LARGEST_PART_LEFT * beyond or named["frequency"] > LARGEST_ERRORS["frequency"]:
        return CouplingFit(remark=UNEXPLAINED)
    known = {name: error for name, error in named.items() if error < LARGEST_ERRORS[name]}
    assumed = {name: getattr(Coupling(), name) for name in NAMES if name not in known}
    c = fit.coupling._replace(**assumed)
    known |= {name: known[name] * getattr(c, name) for name in NAMES[:2] if name in known}
    return CouplingFit(c, known, ELASTIC.format(c.sensors))


BACKLASH = (
    "the recording shows backlash (arm's sensors on the {}), but does not determine its size: "
    "impacts explain it in several ways"
)
UNEXPLAINED = (
    "the recording shows more than a rigid arm, but does not determine a resonance: backlash or "
    "another error of the model"
)
ELASTIC = "the arm's sensors are on the {}; all friction is assumed to act on the motor"


def _not_shown(recordings: list[Recording]) -> str:
    """The sentence that says so, with what limits the recordings."""
    first = recordings[0]
    spectrum = np.abs(np.fft.rfft(first.commanded_at(first.time))) ** 2
    share = np.cumsum(spectrum) / max(np.sum(spectrum), 1e-300)
    highest = np.searchsorted(share, MOST_POWER) / first.duration
    step = 1e3 * quantisation_step(first.measured[:, PHI])
    return (
        "the recording does not show an elastic coupling or backlash: 99 % of the command's power "
        f"lies below {highest:.2g} Hz, a step of the arm's angle is {step:.2g} mrad"
    )


def _shown(gains: np.ndarray, rigid: np.ndarray) -> bool:
    """Whether every part gains, and together more than the criterion of Schwarz asks for.

    See :mod:`.waves`; the side of the sensors counts as an unknown.
    """
    samples, left = len(rigid), float(rigid @ rigid)
    least = left * -np.expm1(-(len(NAMES) + 1) * np.log(samples) / samples)
    return bool(np.all(gains > 0.0) and np.sum(gains) > least)


def _problem(model: Model) -> CouplingResiduals:
    """The first samples of all recordings; each channel is weighted by its rigid residuals."""
    most = MOST_SAMPLES // len(model.recordings)
    recordings = [
        r._replace(time=r.time[:most], measured=r.measured[:most]) for r in model.recordings
    ]
    scale = np.median([noise_of(r) for r in recordings], axis=0)
    scale = CouplingResiduals(recordings, model.fitted, model.values, scale).root_mean_square
    return CouplingResiduals(recordings, model.fitted, model.values, scale)


def _resonance(problem: CouplingResiduals) -> ElasticFit:
    """A fit without gap, from the best of a grid."""
    grid = [
        (np.array([np.log(frequency), np.log(DAMPING), share]), side)
        for frequency, share, side in product(FREQUENCIES, SHARES, SIDES)
    ]
    return problem.fit(*min(grid, key=lambda start: problem.size(*start)), RESONANCE)


def _gap(problem: CouplingResiduals) -> ElasticFit:
    """A fit of gap and share, from the best of a grid."""
    grid = [
        (np.array([np.log(GAP_FREQUENCY), np.log(GAP_DAMPING), share, gap]), side)
        for gap, share, side in product(GAPS, GAP_SHARES, SIDES)
    ]
    return problem.fit(*min(grid, key=lambda start: problem.size(*start)), GAP)

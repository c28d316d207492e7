"""The paper's experiments, Figs 5 to 9, each with what theory says beside what the rig does.

Figs 6 to 9 are one rig in sequence: no compensation, Coulomb's, LuGre's with the parameters of
Fig. 8, LuGre's as tuned. Predicted is, without compensation, the exact limit cycle of the ideal
loop and the describing function's; with compensation the same loop with sensors and drive that
neither round nor make noise: what friction leaves, beside what the sensors do.
"""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np

from furuta_analysis.limit_cycles.ideal_loop import IdealLoop
from furuta_analysis.limit_cycles.limit_cycle import limit_cycle, released
from furuta_analysis.simulation.closed_loop import Loop, Record, simulate
from furuta_analysis.simulation.oscillation import Oscillation, measure_oscillation
from furuta_model.friction.laws import friction_law
from furuta_sim.parameters import PlantParameters
from furuta_studies.feedback_map import predicted_size
from furuta_studies.tuning.tuning import Plan, Report, SimulatedLoop, tune

# The motor's friction differs by direction (Fig. 6); by how much the paper does not say.
ASYMMETRY = 0.05
# Time [s] until the transients of a start are gone.
TRANSIENT = 10.0


class Experiment(NamedTuple):
    """One figure of the paper: its compensation, and whether it is tuned first."""

    title: str
    compensation: str = "none"
    tuned: bool = False
    asymmetric: bool = True


EXPERIMENTS = {
    "fig5": Experiment("Fig. 5: no compensation, rig and simulation", asymmetric=False),
    "fig6": Experiment("Fig. 6: no compensation, asymmetric friction"),
    "fig7": Experiment("Fig. 7: Coulomb compensation", "coulomb"),
    "fig8": Experiment("Fig. 8: LuGre compensation", "lugre"),
    "fig9": Experiment("Fig. 9: LuGre compensation, tuned", "lugre", tuned=True),
}


class ExperimentResult(NamedTuple):
    """What the rig did, what the ideal loop does, and the predictions [rad] (NaN for none)."""

    loop: Loop
    rig: Record
    ideal: Record
    measured: Oscillation
    predicted_phi_peak_to_peak_rad: float
    describing_function_phi_peak_to_peak_rad: float


def experiment(name: str, loop: Loop, seconds: float, report: Report) -> ExperimentResult:
    """Run the experiment ``name`` on ``loop`` for ``seconds`` beyond the transients."""
    made = _prepared(EXPERIMENTS[name], loop, report)
    rig, ideal = (simulate(each, TRANSIENT + seconds) for each in (made, _idealised(made)))
    measured, predicted = (
        measure_oscillation(_settled(run), run.sample_time) for run in (rig, ideal)
    )
    exact, describing = predicted.phi_peak_to_peak_rad, float("nan")
    if made.observer.compensation == "none":
        theory = _ideal_loop(made)
        exact = limit_cycle(theory, released(0.05)).phi_peak_to_peak_rad
        describing = predicted_size(theory)
    return ExperimentResult(made, rig, ideal, measured, exact, describing)


def sensor_resolution(loop: Loop) -> float:
    """One count of the arm's encoder [rad]."""
    counts = loop.plant.sensors.encoder_counts
    return 2 * pi / counts if counts else 0.0


def _prepared(which: Experiment, loop: Loop, report: Report) -> Loop:
    observer = loop.observer._replace(compensation=which.compensation)
    plant = loop.plant
    if which.asymmetric and plant.friction.parameters.asymmetry == 0.0:
        plant = _with_asymmetry(plant, ASYMMETRY)
    made = loop._replace(plant=plant, observer=observer)
    if which.tuned:
        tuned = tune(SimulatedLoop(made), observer, made.estimator, Plan(), report)
        made = made._replace(observer=tuned.after.observer)
    return made


def _with_asymmetry(plant: PlantParameters, asymmetry: float) -> PlantParameters:
    parameters = plant.friction.parameters._replace(asymmetry=asymmetry)
    return plant._replace(friction=plant.friction._replace(parameters=parameters))


def _idealised(loop: Loop) -> Loop:
    """The same loop with sensors and a drive that neither round nor make noise."""
    perfect = loop.plant.sensors._replace(
        encoder_counts=0,
        tachometer_bits=0,
        tachometer_noise=0.0,
        potentiometer_bits=0,
        potentiometer_noise=0.0,
    )
    # The filter's gains stay those of the rig; only the encoder's steps it must not expect.
    nominal = loop.estimator.sensors._replace(encoder_counts=0)
    return loop._replace(
        plant=loop.plant._replace(sensors=perfect, actuator=loop.plant.actuator._replace(bits=0)),
        estimator=loop.estimator._replace(sensors=nominal),
    )


def _ideal_loop(loop: Loop) -> IdealLoop:
    law = friction_law(loop.plant.friction.law, loop.plant.friction.parameters)
    l1, l2, l3, l4 = (-each for each in loop.controller.feedback_gain)
    return IdealLoop(loop.plant.model, law, l1, l2, l3, l4)


def _settled(run: Record) -> np.ndarray:
    return run.state[round(TRANSIENT / run.sample_time) :]

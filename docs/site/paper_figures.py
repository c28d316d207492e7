"""Draws the paper's Figs 5 to 9: ``python docs/site/paper_figures.py FOLDER``.

Each shows an experiment on the simulated rig beside its prediction.

Figs 6 to 9 show one rig: without compensation, with Coulomb compensation, with LuGre compensation
with the parameters of Fig. 8, and with tuned LuGre compensation. Without compensation, the
prediction is the exact limit cycle of the ideal loop, and the describing function's is given too.
With compensation, the prediction is a simulation of the same loop with sensors and drive without
quantisation and noise, which separates the effect of the friction from that of the sensors.
"""

import sys
from math import pi
from pathlib import Path
from typing import NamedTuple

from furuta.figures.figure import REFERENCE, saved_figure
from furuta.figures.run import SIGNALS, draw_signals, label_signals
from furuta.limit_cycles.limit_cycle import limit_cycle, state_at_rest
from furuta.loops import ideal_loop
from furuta.oscillation import Oscillation, measure_oscillation
from furuta.studies.feedback_map import predicted_peak_to_peak
from furuta.studies.tuning.plan import SIMULATED
from furuta.studies.tuning.tuning import tune_simulated
from furuta_model.state import PHI, THETA
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop, Record, simulate

# The motor's friction differs by direction (Fig. 6). The paper does not say by how much.
ASYMMETRY = 0.05
# Time until the initial transients have decayed, time after them, and the part that is shown [s].
TRANSIENT, SECONDS, SHOWN = 10.0, 30.0, 10.0


class Experiment(NamedTuple):
    """One figure of the paper: its compensation, whether that is tuned, and the rig's friction."""

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
    """Runs of the rig and of the same loop with perfect sensors, and the amplitudes [rad].

    ``measured`` is the rig's oscillation. A prediction is NaN if there is none.
    """

    loop: Loop
    rig: Record
    perfect_sensors: Record
    measured: Oscillation
    predicted_phi_peak_to_peak_rad: float
    describing_function_phi_peak_to_peak_rad: float


def run_experiment(name: str, seconds: float = SECONDS) -> ExperimentResult:
    """Run the experiment ``name`` on the paper's rig for ``seconds`` after the transients."""
    configured = _configure_loop(EXPERIMENTS[name], Loop())
    rig = simulate(configured, TRANSIENT + seconds)
    perfect = simulate(_with_perfect_sensors(configured), TRANSIENT + seconds)
    predicted, describing_function = _oscillation(perfect).phi_peak_to_peak_rad, float("nan")
    if configured.observer.compensation == "none":
        ideal = ideal_loop(configured)
        predicted = limit_cycle(ideal, state_at_rest(0.05)).phi_peak_to_peak_rad
        describing_function = predicted_peak_to_peak(ideal)
    return ExperimentResult(
        configured, rig, perfect, _oscillation(rig), predicted, describing_function
    )


def draw_experiment(name: str, path: Path) -> None:
    """Draw the signals of the rig, and arm and pendulum of the loop with perfect sensors."""
    title, result = EXPERIMENTS[name].title, run_experiment(name)
    rig, reference = result.rig, result.perfect_sensors
    samples = round(SHOWN / rig.sample_time)
    # Rig and simulation are compared from the start, in phase; otherwise the settled motion counts.
    shown = slice(None, samples) if "simulation" in title else slice(-samples, None)
    count = 2 * pi / result.loop.plant.sensors.encoder_counts
    with saved_figure(path, len(SIGNALS), sharex=True, figsize=(9, 8)) as (_, axes):
        for axis, index in zip(axes, (PHI, THETA), strict=False):
            values = reference.state[shown, index]
            axis.plot(rig.time[shown], values, color=REFERENCE, lw=2, label="perfect sensors")
        draw_signals(axes, rig, shown)
        label_signals(axes)
        axes[0].set_title(
            f"{title}\narm {result.measured.phi_peak_to_peak_rad:.4f} rad peak to peak, predicted "
            f"{result.predicted_phi_peak_to_peak_rad:.4f}, one encoder count {count:.4f}"
        )
        for axis in axes[[0, 1, 3]]:
            axis.legend(loc="upper right", ncols=2)


def _configure_loop(experiment: Experiment, loop: Loop) -> Loop:
    observer = loop.observer._replace(compensation=experiment.compensation)
    plant = loop.plant
    if experiment.asymmetric and plant.friction.parameters.asymmetry == 0.0:
        plant = _with_asymmetry(plant, ASYMMETRY)
    configured = loop._replace(plant=plant, observer=observer)
    if experiment.tuned:
        tuned = tune_simulated(configured, SIMULATED, lambda message, seconds: None)
        configured = configured._replace(observer=tuned.after.observer)
    return configured


def _with_asymmetry(plant: PlantParameters, asymmetry: float) -> PlantParameters:
    parameters = plant.friction.parameters._replace(asymmetry=asymmetry)
    return plant._replace(friction=plant.friction._replace(parameters=parameters))


def _with_perfect_sensors(loop: Loop) -> Loop:
    """The same loop with sensors and drive without quantisation and noise."""
    perfect = loop.plant.sensors._replace(
        encoder_counts=0,
        tachometer_bits=0,
        tachometer_noise=0.0,
        potentiometer_bits=0,
        potentiometer_noise=0.0,
    )
    # The filter keeps the rig's gains, but must not expect encoder steps.
    nominal = loop.estimator.sensors._replace(encoder_counts=0)
    return loop._replace(
        plant=loop.plant._replace(sensors=perfect, actuator=loop.plant.actuator._replace(bits=0)),
        estimator=loop.estimator._replace(sensors=nominal),
    )


def _oscillation(run: Record) -> Oscillation:
    """Amplitude and period of a run after its transients."""
    settled = run.state[round(TRANSIENT / run.sample_time) :]
    return measure_oscillation(settled, run.sample_time)


if __name__ == "__main__":
    for figure in EXPERIMENTS:
        draw_experiment(figure, Path(sys.argv[1], f"{figure}.png"))

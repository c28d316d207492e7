"""The paper's experiments, Figs 5 to 9: simulated rig and prediction side by side.

Figs 6 to 9 show one rig: without compensation, with Coulomb compensation, with LuGre compensation
with the parameters of Fig. 8, and with tuned LuGre compensation. Without compensation, the
prediction is the exact limit cycle of the ideal loop, and the describing function's is given too.
With compensation, the prediction is a simulation of the same loop with sensors and drive without
quantisation and noise, which separates the effect of the friction from that of the sensors.
"""

from math import pi
from typing import Any, NamedTuple

from furuta.limit_cycles.limit_cycle import limit_cycle, state_at_rest
from furuta.loops import ideal_loop
from furuta.studies.feedback_map import predicted_peak_to_peak
from furuta.studies.tuning.plan import SIMULATED, observer_parameters
from furuta.studies.tuning.tuning import ProgressCallback, tune_simulated
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop, Record, simulate
from furuta_sim.simulation.oscillation import Oscillation, measure_oscillation

# The motor's friction differs by direction (Fig. 6). The paper does not say by how much.
ASYMMETRY = 0.05
# Time until the initial transients have decayed [s].
TRANSIENT = 10.0


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

    def report(self) -> dict[str, Any]:
        """Compensation, motion of the rig, predictions, and parameters of the compensation."""
        return {
            "compensation": self.loop.observer.compensation,
            **self.measured._asdict(),
            "predicted_phi_peak_to_peak_rad": self.predicted_phi_peak_to_peak_rad,
            "describing_function_phi_peak_to_peak_rad": (
                self.describing_function_phi_peak_to_peak_rad
            ),
            "parameters": observer_parameters(self.loop.observer),
        }


def run_experiment(
    name: str, loop: Loop, seconds: float, report: ProgressCallback
) -> ExperimentResult:
    """Run the experiment ``name`` on ``loop`` for ``seconds`` after the transients."""
    configured = _configure_loop(EXPERIMENTS[name], loop, report)
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


def encoder_resolution(loop: Loop) -> float:
    """One count of the arm's encoder [rad], 0 without quantisation."""
    counts = loop.plant.sensors.encoder_counts
    return 2 * pi / counts if counts else 0.0


def _configure_loop(experiment: Experiment, loop: Loop, report: ProgressCallback) -> Loop:
    observer = loop.observer._replace(compensation=experiment.compensation)
    plant = loop.plant
    if experiment.asymmetric and plant.friction.parameters.asymmetry == 0.0:
        plant = _with_asymmetry(plant, ASYMMETRY)
    configured = loop._replace(plant=plant, observer=observer)
    if experiment.tuned:
        tuned = tune_simulated(configured, SIMULATED, report)
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

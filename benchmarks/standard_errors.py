"""Do standard errors hold? Random rigs with the faults of real ones, each fitted to one recording.

    tools/in_environment python benchmarks/standard_errors.py --rigs 200
    tools/in_environment python benchmarks/standard_errors.py --rigs 50 --coupling belt

The rigs are those of furuta_ws/tests/random_rigs.py: waves, tilt, ceilings, unequal friction, 6 s
under 1 to 6 V, five kinds of command in turn. For each value: how often the truth lies within two
standard errors, the median deviation in standard errors, which shows a bias, and the median
standard error; for all fits, for those that the verdict calls usable, and for those of them whose
commands have more than one level: no step shows that the drive gives less than commanded.

With `--coupling` the rigs are those of the paper with random values, rigid or with a belt or
backlash, in turn balanced and hanging, 10 s under a multisine of 1 V: counted are the values of the
coupling, and the sentences of the others.
"""

import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
from rigs_from_recordings import parsed

from furuta_control.control import ControllerParameters
from furuta_control.estimation import EstimatorParameters
from furuta_control.excitation import ExcitationParameters
from furuta_identification.fitting.balanced import LARGEST_ANGLE
from furuta_identification.fitting.coupling import find_coupling
from furuta_identification.identify import identify
from furuta_identification.options import Options
from furuta_identification.regression.equations import has_one_level
from furuta_identification.result.report import summary, verdict
from furuta_model.converter import drive
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_model.parts.coupling import SIDES, Coupling
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors
from furuta_model.state import RIGID_STATES, THETA
from furuta_recordings.recording import Recording
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.simulation.closed_loop import Loop, simulate

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "furuta_ws" / "tests"))

from random_rigs import Rig, sampled  # type: ignore[import-not-found]

ERRORS = 2.0
# Couplings of the rigs, and length of their recordings [s].
COUPLINGS, COUPLED_SECONDS = ("rigid", "belt", "backlash"), 10.0
# Of each value, by name, its deviation and its error for each rig.
Found = dict[str, list[tuple[float, float]]]


def truth(rig: Rig) -> dict[str, float]:
    """True values of what `identify` reports."""
    level = 0.5 * (rig.forward + rig.backward)
    return {
        "alpha": rig.alpha,
        "beta": rig.beta,
        "gamma": rig.gamma,
        "delta": rig.delta,
        "natural_frequency_rad_s": float(np.sqrt(rig.delta / rig.beta)),
        "viscous": rig.viscous,
        "coulomb": level,
        "asymmetry": 0.5 * (rig.forward - rig.backward) / level,
        "pendulum_viscous": rig.pendulum_viscous,
    }


def study(seed: int) -> tuple[str, bool, dict[str, tuple[float, float]]]:
    """The verdict; whether the command has one level; how far values are from the truth.

    Of each value the deviation in standard errors, and the relative standard error [%].
    """
    rig, _, recording = sampled(seed)
    model = identify([recording], Options())
    values = summary(model)
    errors = values["standard_errors"]
    usable = verdict([model.predict(recording) for recording in model.recordings])["usable"]
    return (
        usable,
        has_one_level(model.recordings),
        {
            name: ((values[name] - value) / errors[name], 100.0 * errors[name] / abs(value))
            for name, value in truth(rig).items()
            if values[name] is not None and errors[name] is not None
        },
    )


def coupled_plant(kind: str, seed: int) -> PlantParameters:
    """A random plant, rigid or with a belt or backlash; it hangs if the seed is odd."""
    r = np.random.default_rng(seed)
    nominal, friction = FurutaPendulum(), Friction()
    model = nominal._replace(**{n: v * r.uniform(0.9, 1.1) for n, v in nominal._asdict().items()})
    dry = {name: getattr(friction, name) for name in ("sigma0", "sigma1", "alpha0", "alpha1")}
    friction = friction._replace(
        **{name: value * r.uniform(0.7, 1.3) for name, value in dry.items()},
        asymmetry=r.uniform(-0.1, 0.1),
        viscous=r.uniform(0.0, 0.05),
    )
    belt = kind == "belt"
    coupling = Coupling(
        20.0 * 7.5 ** r.uniform() if belt else r.uniform(80.0, 200.0),
        r.uniform(0.02, 0.1),
        r.uniform(0.2, 0.8),
        0.0 if belt else 0.001 * 30.0 ** r.uniform(),
        sensors=SIDES[int(r.integers(2))],
    )
    return PlantParameters(
        model=model,
        friction=PlantFriction(parameters=friction),
        sensors=Sensors(encoder_counts=int(r.choice([250, 2000, 8192]))),
        coupling=Coupling() if kind == "rigid" else coupling,
        seed=seed,
    )


def driven(plant: PlantParameters, hanging: bool) -> Recording:
    """A recording as in docs/identification.md; ParameterError if the pendulum falls."""
    signal = ExcitationParameters("multisine", amplitude=1.0)
    control = ControllerParameters(excitation=signal)
    if hanging:
        sensors = plant.sensors._replace(potentiometer_range=3.2, tachometer_range=40.0)
        plant = plant._replace(sensors=sensors, initial=plant.initial._replace(theta=np.pi))
        signal = signal._replace(speed_limit=40.0, excursion_limit=100.0)
        control = ControllerParameters(mode="open_loop", excitation=signal)
    estimator = EstimatorParameters(sensors=plant.sensors)
    run = simulate(Loop(plant, estimator, controller=control), COUPLED_SECONDS)
    if not hanging and np.max(np.abs(run.state[:, THETA])) > LARGEST_ANGLE:
        raise ParameterError("the pendulum falls")
    command = np.array([drive(float(u), plant.actuator) for u in run.command])
    measured = run.measurement[:, :RIGID_STATES].copy()
    return Recording("driven", run.time, measured, run.time, command)


def coupled_study(kind: str, seeds: range) -> None:
    """Print what is found of each rig's coupling, then a line for each value."""
    found: Found = defaultdict(list)
    verdicts: dict[str, int] = defaultdict(int)
    for seed in seeds:
        plant, hanging = coupled_plant(kind, seed), seed % 2 == 1
        try:
            options = Options(zero="upright", window=1.0 if hanging else None)
            coupling, errors, remark = find_coupling(identify([driven(plant, hanging)], options))
        except ParameterError as error:
            print(f"{seed}: asked: {error}", flush=True)
            continue
        verdicts[remark.partition(":")[0].partition(" (")[0]] += 1
        for name, size in errors.items():
            true = getattr(plant.coupling, name)
            found[name].append(((getattr(coupling, name) - true) / size, 100.0 * size / true))
        deviations = {name: round(found[name][-1][0], 1) for name in errors}
        print(f"{seed}: {plant.coupling} {deviations} {remark}", flush=True)
    _print(kind, found)
    print(*(f"{count:4d} {text}" for text, count in verdicts.items()), sep="\n")


def main() -> None:
    """Fit the rigs and print a line for each, then one for each value."""
    options = parsed(__doc__, 200, COUPLINGS)
    seeds = range(options.first, options.first + options.rigs)
    if options.coupling:
        coupled_study(options.coupling, seeds)
        return
    groups: dict[str, Found] = {
        "all fits": defaultdict(list),
        "usable": defaultdict(list),
        "usable, several levels": defaultdict(list),
    }
    for seed in seeds:
        try:
            judged, one_level, values = study(seed)
        except ParameterError as error:
            print(f"{seed}: asked: {error}", flush=True)
            continue
        rounded = {name: round(float(pair[0]), 1) for name, pair in values.items()}
        levels = "one level" if one_level else "several levels"
        print(f"{seed}: usable: {judged}, {levels};", rounded, flush=True)
        usable = judged == "yes"
        for group, counts in zip(
            groups.values(), (True, usable, usable and not one_level), strict=True
        ):
            for name, pair in values.items():
                if counts:
                    group[name].append(pair)
    for title, group in groups.items():
        _print(title, group)


def _print(title: str, group: Found) -> None:
    print(f"{title:26}{'number':>8}{'within':>9}{'median':>9}{'error':>9}")
    together = [pair for rows in group.values() for pair in rows]
    for name, rows in [*group.items(), ("together", together)]:
        if rows:
            deviations, errors = np.array(rows).T
            within = 100.0 * np.mean(np.abs(deviations) <= ERRORS)
            middle = f"{np.median(deviations):9.2f}{np.median(errors):8.2f}%"
            print(f"{name:26}{len(rows):8d}{within:8.1f}%{middle}")


if __name__ == "__main__":
    main()

"""The recommended compensation, ``compensation=recommended``: settings of three nodes for a rig.

It is the LuGre observer with super-twisting of limited bandwidth on top. Where the model of the
observer is right no fast correction is needed, and where it is wrong super-twisting corrects it.
Its bounds follow from the highest friction level and the sample time.

What a late drive leaves is chatter, which is proportional to the strength. So this setting is
simulated on the rig as the settings describe it, with friction that truly sticks, and in cases in
which its level and the delay of the drive are wrong by half, or there is no friction. If the arm
swings by more than a count in any of them, another strength is chosen: one with which the rig as
described swings hardly more than necessary, the pendulum falls in the fewest cases, and the swing
in the others is least. Three times the friction is a case too if the swing is dangerous then. Other
poles, process noise and bandwidth are taken if they reduce the swing much. What a user has set is
left as it is.
"""

from collections.abc import Iterable, Iterator
from functools import lru_cache
from math import inf, pi
from typing import Any, NamedTuple

import numpy as np

from furuta.pole_choice import quadratic_poles
from furuta_control.control import POLE_PLACEMENT, ControllerParameters
from furuta_control.excitation import ExcitationParameters
from furuta_friction.compensation import ObserverParameters
from furuta_friction.super_twisting import FRICTION_RATE
from furuta_model.friction.lugre import highest_level
from furuta_model.parameters import values
from furuta_model.state import PHI, THETA
from furuta_sim.parameters import InitialState, PlantFriction
from furuta_sim.simulation.closed_loop import Loop, simulate

RECOMMENDED = "recommended"
# What it sets beside the compensation: always, and if it helps much.
OWN_NAMES = (
    "controller.strength",
    "controller.super_twisting",
    "controller.super_twisting_bandwidth",
    "controller.vibration_limit",
)
RECOMMENDED_NAMES = (
    *OWN_NAMES,
    "controller.omega1",
    "controller.zeta1",
    "controller.omega2",
    "controller.zeta2",
    "estimator.friction_process_noise",
    "estimator.pendulum_process_noise",
)
# Vibration that is accepted, relative to the highest level of friction. On the paper's rig C is
# 10 V/s and this limit 0.4 V.
VIBRATION = 1.7
# Bandwidth [1/s]: between those at which a belt of 50 Hz vibrates and friction moves the arm by a
# count of the encoder; at most this per sample.
BANDWIDTH, LARGEST_STEP = 80.0, 0.1
# Strengths, and factors on each process noise and on the bandwidth, that are tried.
STRENGTHS = (1.0, 1.4, 0.7, 0.5, 0.4, 0.3, 0.2, 0.1)
NOISES = (0.33, 3.0)
BANDWIDTHS = (0.5, 2.0)
KALMAN_NOISES = "friction_process_noise", "pendulum_process_noise"
# The cases: level of friction and delay of the drive, relative to what is described.
DESCRIBED = (1.0, 1.0)
CASES = (DESCRIBED, (1.5, 1.5), (0.5, 1.5), (1.0, 1.5), (1.5, 0.5), (0.0, 1.0))
# The hard case, whose swing [rad] counts beyond a limit, where it is dangerous.
HARD_CASE = (3.0, 1.0)
LIMIT = 0.2
SECONDS = 16.0
HORIZONTAL = pi / 2  # [rad]; beyond it the pendulum has fallen
# Angle [rad] by which the rig as described may swing more than necessary, half a count of the
# paper's encoder.
NEAR = 0.0125
# Runs that are remembered: all of a search, which compares some loops several times.
MOST_RUNS = 512
# Part of the least swing so far that another of the rest must not exceed. A belt that is not
# described may need the rest as it is.
MUCH_BETTER = 0.6


class Score(NamedTuple):
    """In how many cases the pendulum falls, and the largest swing of the arm [rad] in the others.

    A lower one is better.
    """

    falls: int
    swing: float


def is_compensation(name: str) -> bool:
    """Whether this is a name of the compensation."""
    return name in ("compensation", "friction_observer.compensation")


def is_recommended(name: str, value: Any) -> bool:
    """Whether a setting asks for the recommended compensation."""
    return value == RECOMMENDED and is_compensation(name)


def recommended_values(loop: Loop, held: frozenset[str] = frozenset()) -> dict[str, Any]:
    """Values by full name for the rig that the ``loop`` describes.

    Those of ``held``, by full name, are left out. Poles and noises among them are not varied.
    """
    fixed = held.intersection(RECOMMENDED_NAMES)
    chosen = _chosen(_as_described(loop), fixed.difference(OWN_NAMES))
    found = {**values(chosen.controller, "controller."), **values(chosen.estimator, "estimator.")}
    return {
        "friction_observer.compensation": "lugre",
        **{name: found[name] for name in RECOMMENDED_NAMES if name not in fixed},
    }


def with_super_twisting(
    controller: ControllerParameters, observer: ObserverParameters
) -> ControllerParameters:
    """The controller with super-twisting for the friction model and sample time of the observer."""
    level = float(highest_level(observer.friction))
    balance = controller.balance._replace(
        strength=1.0,
        super_twisting=FRICTION_RATE * level,
        super_twisting_bandwidth=min(BANDWIDTH, LARGEST_STEP / observer.sample_time),
        vibration_limit=max(VIBRATION * level, 1e-3),  # without friction, the least that is allowed
    )
    return controller._replace(balance=balance)


def _as_described(loop: Loop) -> Loop:
    """The standard setting on the upright rig, whose true friction is that of the model."""
    plant, observer = loop.plant, loop.observer._replace(compensation="lugre")
    known = observer.friction._replace(viscous=plant.friction.parameters.viscous)
    return loop._replace(
        plant=plant._replace(friction=PlantFriction("stiction", known), initial=InitialState()),
        observer=observer,
        controller=with_super_twisting(loop.controller, observer)._replace(
            mode="balance", enabled=True, excitation=ExcitationParameters()
        ),
    )


@lru_cache
def _chosen(standard: Loop, fixed: frozenset[str]) -> Loop:
    """The standard setting, or one that is better in the worst case."""
    enough = Score(0, standard.plant.sensors.encoder_count)
    if _score(standard) <= enough:
        return standard
    best = _best(_strengths(standard))
    for other_poles in _poles(standard, fixed):
        best = _much_better(best, _best(_strengths(other_poles)))
    for variants in (_noises, _bandwidths):
        for other in variants(best, fixed):
            best = _much_better(best, other) if _score(best) > enough else best
    return _best([best, *_strengths(best)])


def _best(loops: Iterable[Loop]) -> Loop:
    """Of those with which the described rig swings little, the one of least score."""
    candidates = list(loops)
    swings = [_swing(each, *DESCRIBED) for each in candidates]
    most = min(swings) + NEAR
    little = [each for each, swing in zip(candidates, swings, strict=True) if swing <= most]
    return min(little, key=_score)


def _much_better(best: Loop, other: Loop) -> Loop:
    """The other one if its score is much better and the described rig swings little with it."""
    least = _score(best)
    if _best([best, other]) is best or _score(other) > (least.falls, MUCH_BETTER * least.swing):
        return best
    return other


def _strengths(loop: Loop) -> Iterator[Loop]:
    for strength in STRENGTHS:
        balance = loop.controller.balance._replace(strength=strength)
        yield loop._replace(controller=loop.controller._replace(balance=balance))


def _poles(loop: Loop, fixed: frozenset[str]) -> Iterator[Loop]:
    controller = loop.controller
    names = values(controller.poles, "controller.")
    if controller.gain == POLE_PLACEMENT and fixed.isdisjoint(names):
        poles = quadratic_poles(
            controller.model, controller.model_viscous, controller.voltage_limit
        )
        yield loop._replace(controller=controller._replace(poles=poles))


def _noises(loop: Loop, fixed: frozenset[str]) -> Iterator[Loop]:
    estimator = loop.estimator
    for name in KALMAN_NOISES:
        for factor in () if f"estimator.{name}" in fixed else NOISES:
            kalman = estimator.kalman
            kalman = kalman._replace(**{name: factor * getattr(kalman, name)})
            yield loop._replace(estimator=estimator._replace(kalman=kalman))


def _bandwidths(loop: Loop, fixed: frozenset[str]) -> Iterator[Loop]:
    for factor in BANDWIDTHS:
        balance = loop.controller.balance
        bandwidth = factor * balance.super_twisting_bandwidth
        balance = balance._replace(super_twisting_bandwidth=bandwidth)
        yield loop._replace(controller=loop.controller._replace(balance=balance))


def _score(loop: Loop) -> Score:
    """What the cases give; the hard one counts only if it is dangerous."""
    hard = _swing(loop, *HARD_CASE)
    swings = [hard] * (hard > LIMIT) + [_swing(loop, *case) for case in CASES]
    falls = swings.count(inf)
    return Score(falls, max((swing for swing in swings if swing < inf), default=inf))


@lru_cache(MOST_RUNS)
def _swing(loop: Loop, level: float, delay: float) -> float:
    """The swing [rad] with another level of friction and another delay than described."""
    plant = loop.plant
    known, drive = plant.friction.parameters, plant.drive
    true = known._replace(alpha0=level * known.alpha0, alpha1=level * known.alpha1)
    late = drive._replace(delay=round(delay * drive.delay), lag=delay * drive.lag)
    friction = plant.friction._replace(parameters=true)
    run = simulate(loop._replace(plant=plant._replace(friction=friction, drive=late)), SECONDS)
    settled = run.state[len(run.state) // 2 :]
    if np.max(np.abs(settled[:, THETA])) > HORIZONTAL:
        return inf
    return float(np.ptp(settled[:, PHI]))

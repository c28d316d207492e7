"""An identified joint as a model for simulators: URDF, SDF or MJCF.

The joint turns about the horizontal axis y, or slides along x. Its centre of mass lies where its
weight gives the gravity torque. The formats have Coulomb and viscous friction. Only MuJoCo, from
3.7 on, also has LuGre friction: that of a motor, here of one without current.
"""

from typing import Any
from xml.sax.saxutils import escape, quoteattr

from furuta.axis.joint_file import JointFile
from furuta.export.text import filled
from furuta_friction.joint_observer import ObserverNodeParameters
from furuta_model.parameters import ParameterError, build, shortened, values

# Types of a joint that turns and of one that slides, by format.
FORMATS = {
    "urdf": ("continuous", "prismatic"),
    "sdf": ("revolute", "prismatic"),
    "mjcf": ("hinge", "slide"),
}
GRAVITY = 9.81  # [m/s²]
# Natural frequency of a bristle on the inertia, times the time step, at a damping of 0.5. MuJoCo's
# bristle is stable up to twice this step. That of a joint file is softer, as it suits a
# compensator: with it a joint that hunts could rest.
BRISTLE = 0.5
# The hardest dry friction that MuJoCo allows. With its defaults a joint that sticks creeps 10000
# times as fast.
HARD = 'solreffriction="{!r} 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"'
# URDF wants limits of a joint that slides.
UNLIMITED = """
    <limit lower="-1e6" upper="1e6" velocity="1e6" effort="1e6"/>"""


def joint_model(
    file: JointFile, form: str, prismatic: bool = False, lugre: bool = False, step: float = 1e-3
) -> str:
    """The joint of a joint file in one of the :data:`FORMATS`.

    Args:
        file: The joint.
        form: The format.
        prismatic: The joint slides, and its units are N, m, kg and s.
        lugre: With LuGre friction, which only MJCF has.
        step: Time step of MuJoCo [s]. The shorter it is, the harder is the bristle.

    Raises:
        ParameterError: A value is missing or not allowed.
    """
    name = file.joint
    if not name.isprintable():
        raise ParameterError(f"XML has no such name: {shortened(name)}")
    p = values(build(ObserverNodeParameters, file.parameters))
    if not p["axis.inertia"]:
        raise ParameterError(f"{shortened(name)}: a model needs axis.inertia above 0, given 0")
    mass, centre, moment = _weight(name, p, prismatic)
    dry = f' frictionloss="{p["alpha0"]!r}" {HARD.format(2.0 * step)}'
    return filled(
        f"joint.{form}",
        joint=quoteattr(name),
        type=FORMATS[form][prismatic],
        link=quoteattr(f"{name}_link"),
        child=escape(f"{name}_link"),
        drive=quoteattr(f"{name}_drive"),
        about=_about(p, lugre),
        mass=mass,
        centre=centre,
        moment=moment,
        axis="1 0 0" if prismatic else "0 1 0",
        limit=UNLIMITED * prismatic,
        damping=p["viscous"] + p["axis.viscous"],
        coulomb=p["alpha0"],
        friction="" if lugre else dry,
        bristle=_bristle(name, p, BRISTLE / step) if lugre else "",
        step=step,
    )


def _weight(name: str, p: dict[str, Any], prismatic: bool) -> tuple[float, str, float]:
    """Mass, its centre and the moment of inertia about it, for g_s sin q + g_c cos q."""
    inertia, torques = p["axis.inertia"], (p["axis.gravity_cos"], p["axis.gravity_sin"])
    if prismatic:
        if any(torques):
            raise ParameterError(f"{name} is not prismatic: its gravity depends on an angle")
        return inertia, "0 0 0", inertia
    square = sum(torque**2 for torque in torques) / GRAVITY**2
    mass = max(1.0, 2.0 * square / inertia)  # the centre has at most half of the inertia
    x, z = (0.0 - torque / (mass * GRAVITY) for torque in torques)
    return mass, f"{x!r} 0 {z!r}", inertia - square / mass


def _bristle(name: str, p: dict[str, Any], frequency: float) -> str:
    """LuGre friction in MJCF."""
    stiffness = p["axis.inertia"] * frequency**2
    values = [stiffness, stiffness / frequency, p["alpha0"], p["alpha0"] + p["alpha1"]]
    if not p["alpha0"]:
        raise ParameterError(f"{name}: LuGre friction needs alpha0 above 0")
    lugre = " ".join(f"{value:.6g}" for value in (*values, p["stribeck_velocity"]))
    return f"""
    <dcmotor name={quoteattr(f"{name}_friction")} joint={quoteattr(name)}
             motorconst="1e-9" resistance="1e9" lugre="{lugre}"/>"""


def _about(p: dict[str, Any], lugre: bool) -> str:
    """What the model lacks."""
    names = ("asymmetry", "axis.offset") if lugre else ("alpha1", "asymmetry", "axis.offset")
    lacking = ", ".join(f"{name} {p[name]:g}" for name in names if p[name])
    hunting = " Without alpha1, which is stiction, the joint does not hunt." * ("alpha1" in lacking)
    return f"From a joint file of furuta axis. Not in this model: {lacking or 'nothing'}.{hunting}"

"""MuJoCo: dry friction as it comes, as hard as it allows (hard), and LuGre friction (lugre)."""

import mujoco

VERSION = mujoco.__version__
WITH_BRISTLE = ("coulomb", "stribeck", "static", "lugre")
LAWS = {"": ("coulomb",), "hard": ("coulomb",), "lugre": WITH_BRISTLE}
GRAVITY = 9.81
# A mass of 1 kg whose centre lies above the axis.
TEXT = """<mujoco><option timestep="{step}" gravity="0 0 -9.81"/><worldbody><body>
<inertial pos="0 0 {height}" mass="1" diaginertia="{moment} {moment} {moment}"/>
<joint name="joint" axis="0 1 0" damping="{damping}" {friction}/></body></worldbody>{motor}</mujoco>"""


def model(law: str, p: dict[str, float], step: float, variant: str) -> mujoco.MjModel:
    """The joint as a model."""
    friction, motor, height = f'frictionloss="{p["coulomb"]}"', "", p.get("gravity", 0.0) / GRAVITY
    if variant == "hard":
        friction += f' solreffriction="{2.0 * step} 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"'
    if variant == "lugre":
        friction, fast = "", 0.5 / step  # the hardest bristle that is stable with a margin
        stiffness = p.get("stiffness", p["inertia"] * fast**2)
        damping, static = p.get("damping", p["inertia"] * fast), p.get("static", p["coulomb"])
        values = (stiffness, damping, p["coulomb"], static, p.get("stribeck_speed", 0.01))
        motor = '<dcmotor joint="joint" motorconst="1e-9" resistance="1e9" lugre="{}"/>'
        motor = "<actuator>" + motor.format(" ".join(map(str, values))) + "</actuator>"
    moment, damping = p["inertia"] - height**2, p.get("viscous", 0.0)
    return mujoco.MjModel.from_xml_string(TEXT.format(**locals()))


class Joint:
    """The joint of a scene."""

    def __init__(self, law, parameters, angle, speed, step, variant):
        self._model = model(law, parameters, step, variant)
        self._data = mujoco.MjData(self._model)
        self._data.qpos[0], self._data.qvel[0] = angle, speed
        if variant == "lugre" and speed:  # the bristle of a joint that slides is stretched
            stretch = parameters["coulomb"] / self._model.actuator_dynprm[0, 5]
            self._data.act[0] = stretch if speed > 0.0 else -stretch

    def step(self, torque):
        """Angle and speed after a time step under a torque."""
        self._data.qfrc_applied[0] = torque
        mujoco.mj_step(self._model, self._data)
        return self._data.qpos[0], self._data.qvel[0]

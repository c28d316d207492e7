"""MuJoCo: dry friction as it comes, hard, without slip (noslip), and LuGre friction (lugre)."""

import mujoco

VERSION = mujoco.__version__
BRISTLE = ("coulomb", "stribeck", "static", "lugre")
COULOMB = ("coulomb",)
LAWS = {"": COULOMB, "hard": COULOMB, "noslip": COULOMB, "lugre": BRISTLE}
TEXT = """<mujoco><option timestep="{step}" gravity="0 0 -9.81" {more}/><worldbody><body>
<inertial pos="0 0 {height}" mass="1" diaginertia="{moment} {moment} {moment}"/>
<joint name="joint" axis="0 1 0" damping="{viscous}" {dry}/></body></worldbody>{motor}</mujoco>"""


def model(law, p, angle, speed, step, variant):
    """The joint of a scene, as model and data."""
    dry, motor, fast = f'frictionloss="{p["coulomb"]}"', "", 0.5 / step
    more = 'noslip_iterations="10"' if variant == "noslip" else ""
    if variant == "hard":
        dry += f' solreffriction="{2.0 * step} 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"'
    # The hardest bristle that is stable up to twice the step.
    stiffness = p.get("stiffness", p["inertia"] * fast**2)
    if variant == "lugre":
        values = (stiffness, p.get("damping", p["inertia"] * fast), p["coulomb"])
        values += (p.get("static", p["coulomb"]), p.get("stribeck_speed", 0.01))
        motor = '<dcmotor joint="joint" motorconst="1e-9" resistance="1e9" lugre="{}"/>'
        dry, motor = "", f"<actuator>{motor.format(' '.join(map(str, values)))}</actuator>"
    text = TEXT.format(**p, step=step, more=more, dry=dry, motor=motor)
    made = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(made)
    data.qpos[0], data.qvel[0] = angle, speed
    if variant == "lugre" and speed:  # the bristle of a joint that slides is stretched
        data.act[0] = p["coulomb"] / stiffness * (1.0 if speed > 0.0 else -1.0)
    return made, data


def joint(law, p, angle, speed, step, variant):
    """The joint of a scene."""
    made, data = model(law, p, angle, speed, step, variant)

    def move(torque):
        data.qfrc_applied[0] = torque
        mujoco.mj_step(made, data)
        return data.qpos[0], data.qvel[0]

    return move

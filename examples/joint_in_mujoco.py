"""A joint that hunts: its exact final motion, and that in MuJoCo with Coulomb and LuGre friction.

tools/in_environment python examples/joint_in_mujoco.py    # needs mujoco 3.7

Under a PID at rest, and at 0.1 rad/s; then the creep under half of the Coulomb level.
"""

import sys

import numpy as np

import furuta
from furuta.axis.joint_file import JointFile
from furuta.export.joint_models import joint_model

try:
    import mujoco
except ImportError:
    sys.exit("error: this example needs mujoco: pip install -r examples/requirements.lock")

SECONDS, SPEEDS = 120.0, (0.0, 0.1)
GAINS = furuta.Pid(kp=1.0, ki=2.0, kd=0.08)
FRICTION = furuta.Friction(alpha0=0.1, alpha1=0.1, stribeck_velocity=0.1, viscous=0.005)
OTHERS = ("axis.viscous", "axis.offset", "axis.gravity_sin", "axis.gravity_cos")
VALUES = FRICTION._asdict() | {"axis.inertia": 0.01} | dict.fromkeys(OTHERS, 0.0)
JOINT = JointFile("elbow", VALUES, None)  # usually from furuta.read_joint_file("joints.yaml")


def exact(law: str, speed: float) -> str:
    """The final motion without a simulator."""
    cycle = furuta.servo_cycle(furuta.Axis(VALUES["axis.inertia"], FRICTION, law), GAINS, speed)
    hunts = cycle.kind == "limit_cycle"
    return f"{cycle.peak_to_peak:.3f} rad in {cycle.period_s:.2f} s" if hunts else cycle.kind


def simulated(text: str, speed: float) -> str:
    """The motion in the last quarter."""
    model = mujoco.MjModel.from_xml_string(text)
    data, step, integral = mujoco.MjData(model), model.opt.timestep, 0.0
    errors = np.empty(round(SECONDS / step))
    data.qpos[0] = 0.0 if speed else -4.0
    for k in range(len(errors)):
        errors[k] = error = speed * k * step - data.qpos[0]
        integral += step * error
        damping = GAINS.kd * (speed - data.qvel[0])
        data.qfrc_applied[0] = GAINS.kp * error + GAINS.ki * integral + damping
        mujoco.mj_step(model, data)
    late = errors[3 * len(errors) // 4 :]
    size, high = np.ptp(late), late > late.min() + 0.5 * np.ptp(late)
    period = step * np.diff(np.flatnonzero(high[1:] & ~high[:-1])).mean() if size > 0.01 else 0.0
    return f"{size:.3f} rad in {period:.2f} s" if period else "steady" if speed else "rest"


def creep(text: str) -> str:
    """The speed after 2 s."""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 0.5 * FRICTION.alpha0
    mujoco.mj_step(model, data, nstep=round(2.0 / model.opt.timestep))
    return f"{data.qvel[0]:.0e} rad/s" if data.qvel[0] > 1e-9 else "0"


for law in ("stribeck", "coulomb"):
    print(f"{f'exact, {law}':22}", *(f"{exact(law, speed):21}" for speed in SPEEDS), "0")
hard = {"lugre": True, "step": 2.5e-4}
for form, options in (("urdf", {}), ("mjcf", {}), ("mjcf", {"lugre": True}), ("mjcf", hard)):
    text = joint_model(JOINT, form, **options)
    name = f"{form}, lugre, {1e3 * options.get('step', 1e-3):g} ms" if options else form
    motions = (f"{simulated(text, speed):21}" for speed in SPEEDS)
    print(f"{name:22}", *motions, creep(text))

# prints
# exact, stribeck        0.144 rad in 4.43 s   0.141 rad in 1.76 s   0
# exact, coulomb         rest                  steady                0
# urdf                   rest                  steady                5e-03 rad/s
# mjcf                   rest                  steady                5e-07 rad/s
# mjcf, lugre, 1 ms      0.142 rad in 4.49 s   0.138 rad in 1.72 s   0
# mjcf, lugre, 0.25 ms   0.143 rad in 4.47 s   0.139 rad in 1.73 s   0

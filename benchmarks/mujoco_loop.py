"""The same pendulum in MuJoCo, with MuJoCo's own LuGre joint."""

from time import thread_time

import mujoco
import numpy as np
from experiment import BODY, FEEDBACK, FRICTION, RELEASE, SECONDS, STEP, measure_cycle

from furuta.oscillation import Oscillation

GRAVITY = 9.81
# Any value that leaves arm and pendulum a positive inertia [V s²/rad per m²].
MASS = 0.2
STEPS = round(SECONDS / STEP)


def _model(integrator: str) -> mujoco.MjModel:
    """Masses and lengths whose equations of motion have the coefficients of (1).

    Friction is part of a motor without current: a tiny motor constant and a huge resistance.
    """
    length = BODY.delta / (GRAVITY * MASS)
    radius = BODY.gamma / (MASS * length)
    pendulum = BODY.beta - MASS * length**2
    arm = BODY.alpha - MASS * radius**2
    f = FRICTION
    lugre = f"{f.sigma0} {f.sigma1} {f.alpha0} {f.alpha0 + f.alpha1!r} {f.stribeck_velocity}"
    return mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <compiler angle="radian" inertiafromgeom="false"/>
  <option timestep="{STEP}" integrator="{integrator}" gravity="0 0 -{GRAVITY}">
    <flag contact="disable" constraint="disable"/>
  </option>
  <worldbody>
    <body>
      <joint name="arm" type="hinge" axis="0 0 1" armature="{arm!r}"/>
      <inertial pos="0 0 0" mass="1e-12" diaginertia="1e-15 1e-15 1e-15"/>
      <body pos="{radius!r} 0 0">
        <joint name="pendulum" type="hinge" axis="-1 0 0"/>
        <inertial pos="0 0 {length!r}" mass="{MASS}"
                  diaginertia="{pendulum!r} {pendulum!r} 1e-12"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor joint="arm"/>
    <dcmotor joint="arm" motorconst="1e-9" resistance="1e9" lugre="{lugre}"/>
  </actuator>
</mujoco>""")


class MujocoLoop:
    """The experiment with one of MuJoCo's integrators."""

    def __init__(self, integrator: str = "Euler") -> None:
        self.model = _model(integrator)

    def rate(self) -> float:
        """Steps per second of CPU time of the usual Python loop with numpy feedback."""
        model, data, gain = self.model, self._released(), np.array(FEEDBACK)[[0, 2, 1, 3]]
        start = thread_time()
        for _ in range(STEPS):
            data.ctrl[0] = gain @ np.concatenate((data.qpos, data.qvel))
            mujoco.mj_step(model, data)
        return STEPS / (thread_time() - start)

    def tuned_rate(self) -> float:
        """The same for the fastest Python loop found: no attribute look-ups, plain arithmetic."""
        model, data = self.model, self._released()
        q, v, ctrl, step = data.qpos, data.qvel, data.ctrl, mujoco.mj_step
        l1, l2, l3, l4 = FEEDBACK
        start = thread_time()
        for _ in range(STEPS):
            ctrl[0] = l1 * q[0] + l2 * v[0] + l3 * q[1] + l4 * v[1]
            step(model, data)
        return STEPS / (thread_time() - start)

    def c_rate(self) -> float:
        """Steps per second of CPU time of MuJoCo's C code alone, without feedback."""
        data = self._released()
        start = thread_time()
        mujoco.mj_step(self.model, data, nstep=STEPS)
        return STEPS / (thread_time() - start)

    def limit_cycle(self) -> Oscillation:
        """The limit cycle."""
        data, path = self._released(), np.empty((STEPS, 2))
        l1, l2, l3, l4 = FEEDBACK
        for k in range(STEPS):
            path[k] = data.qpos
            (phi, theta), (v, w) = data.qpos, data.qvel
            data.ctrl[0] = l1 * phi + l2 * v + l3 * theta + l4 * w
            mujoco.mj_step(self.model, data)
        settled = path[STEPS // 2 :]
        return measure_cycle(settled[:, 0], settled[:, 1])

    def _released(self) -> mujoco.MjData:
        data = mujoco.MjData(self.model)
        data.qpos[1] = RELEASE
        return data

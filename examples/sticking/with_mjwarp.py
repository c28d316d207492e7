"""MuJoCo Warp on the CPU, in single precision: the models of with_mujoco.py."""

import mujoco
import mujoco_warp
import warp
from with_mujoco import LAWS, model  # noqa: F401

warp.config.quiet = True
VERSION = mujoco_warp.__version__ if hasattr(mujoco_warp, "__version__") else "?"


class Joint:
    """The joint of a scene."""

    def __init__(self, law, parameters, angle, speed, step, variant):
        text = model(law, parameters, step, variant)
        data = mujoco.MjData(text)
        data.qpos[0], data.qvel[0] = angle, speed
        with warp.ScopedDevice("cpu"):
            self._model, self._data = mujoco_warp.put_model(text), mujoco_warp.put_data(text, data)
        self._torque = self._data.qfrc_applied.numpy()  # on the CPU these are views
        self._q, self._v = self._data.qpos.numpy(), self._data.qvel.numpy()

    def step(self, torque):
        """Angle and speed after a time step under a torque."""
        self._torque[0, 0] = torque
        mujoco_warp.step(self._model, self._data)
        return float(self._q[0, 0]), float(self._v[0, 0])

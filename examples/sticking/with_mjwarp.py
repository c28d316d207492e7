"""MuJoCo Warp on the CPU, in single precision: the models of with_mujoco.py."""

import mujoco_warp
import warp
from with_mujoco import LAWS, model  # noqa: F401

VERSION = mujoco_warp.__version__
warp.config.quiet = True


def joint(law, p, angle, speed, step, variant):
    """The joint of a scene."""
    made, data = model(law, p, angle, speed, step, variant)
    with warp.ScopedDevice("cpu"):
        there, state = mujoco_warp.put_model(made), mujoco_warp.put_data(made, data)
        with warp.ScopedCapture("cpu") as capture:
            mujoco_warp.step(there, state)
    # On the CPU these are views.
    applied, q, v = (a.numpy()[0] for a in (state.qfrc_applied, state.qpos, state.qvel))

    def move(torque):
        applied[0] = torque
        warp.capture_launch(capture.graph)  # 200 times as fast as a step
        return float(q[0]), float(v[0])

    return move

"""Newton on the CPU, in single precision: its solver MuJoCo."""

import newton
import numpy as np
import warp

VERSION = newton.__version__
LAWS = {"": ("coulomb",)}
warp.config.quiet = True


def joint(law, p, angle, speed, step, variant):
    """The joint of a scene."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -9.81))
    com, moment = (0.0, 0.0, p["height"]), np.eye(3) * p["moment"]
    link = builder.add_link(mass=1.0, com=com, inertia=moment)
    dry = {"friction": p["coulomb"], "damping": p["viscous"], "armature": 0.0}
    builder.add_articulation([builder.add_joint_revolute(-1, link, axis=(0.0, 1.0, 0.0), **dry)])
    with warp.ScopedDevice("cpu"):
        model = builder.finalize()
        model.joint_q.fill_(angle)
        model.joint_qd.fill_(speed)
        solver, control = newton.solvers.SolverMuJoCo(model), model.control()
        now, then = model.state(), model.state()
        newton.eval_fk(model, model.joint_q, model.joint_qd, now)
        with warp.ScopedCapture("cpu") as capture:
            solver.step(now, then, control, None, step)
            now.assign(then)
    applied, q, v = (a.numpy() for a in (control.joint_f, now.joint_q, now.joint_qd))

    def move(torque):
        applied[0] = torque
        warp.capture_launch(capture.graph)  # much faster than a step
        return float(q[0]), float(v[0])

    return move

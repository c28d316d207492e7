"""MuJoCo, MJWarp, Newton: a joint under 0.3 of its frictionloss creeps. It should stand still.

Expected 0; found torque / inertia * (1 - d) / d * dmax * timeconst / 2, that is 0.003167 rad/s at
0.1 kg m² and 0.03167 rad/s at 0.01 kg m², at every time step up to 10 ms. With
noslip_iterations="1" it is 0.
"""

import mujoco

for inertia in (0.1, 0.01):
    for step in (0.005, 0.002, 0.001):
        model = mujoco.MjModel.from_xml_string(f"""
        <mujoco><option timestep="{step}"/><worldbody><body>
        <inertial pos="0 0 0" mass="1" diaginertia="{inertia} {inertia} {inertia}"/>
        <joint axis="0 0 1" frictionloss="1"/></body></worldbody></mujoco>""")
        data = mujoco.MjData(model)
        data.qfrc_applied[0] = 0.3
        mujoco.mj_step(model, data, nstep=round(2.0 / step))
        print(f"{inertia} kg m², {step} s: {data.qvel[0]:.6f} rad/s")

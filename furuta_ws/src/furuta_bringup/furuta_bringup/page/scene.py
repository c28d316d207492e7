"""The pendulum in 3D, drawn from its robot description."""

from math import cos, sin
from typing import Any

import numpy as np
import viser
from urdf_parser_py.urdf import URDF, Cylinder, Sphere
from viser.transforms import SO3

from furuta_bringup.page.samples import PHI, THETA
from furuta_ros.topics import JOINTS

ROOT = "/robot"
GROUND = (226, 232, 240)
DAYLIGHT = 1.5  # brightness of the sides away from the light
# Position of the camera and the point that it looks at, in heights of the joint above the ground.
CAMERA, TARGET = (1.6, -2.0, 1.65), (0.0, 0.0, 1.05)
# On a narrow page the panel covers the lower part; the pendulum is above it then.
NARROW = 0.55  # width over height
NARROW_CAMERA, NARROW_TARGET = (2.2, -2.7, 2.2), (0.0, 0.0, -0.6)


class Scene:
    """The links of a robot description as nested frames, a joint each."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._axes: dict[str, np.ndarray] = {}
        self._frames: dict[str, Any] = {}
        self._root: Any = None
        self._height = 0.0
        server.on_client_connect(self._place_camera)
        server.scene.set_up_direction("+z")

    def show(self, description: str) -> None:
        """Draw the robot of this description instead of an earlier one."""
        if self._root is not None:
            self._root.remove()
        robot = URDF.from_xml_string(description)
        self._root = self._server.scene.add_frame(ROOT, show_axes=False)
        self._add_link(robot, robot.get_root(), ROOT)
        self._surroundings(float(robot.joint_map[JOINTS[0]].origin.xyz[2]))

    def move(self, sample: np.ndarray) -> None:
        """Turn the joints to their angles [rad] in a sample (page/samples.py)."""
        angles = dict(zip(JOINTS, (float(sample[PHI]), float(sample[THETA])), strict=True))
        with self._server.atomic():
            for name, frame in self._frames.items():
                x, y, z = sin(angles[name] / 2) * self._axes[name]
                frame.wxyz = (cos(angles[name] / 2), x, y, z)

    def _add_link(self, robot: Any, name: str, path: str) -> None:
        colours = {material.name: material.color.rgba[:3] for material in robot.materials}
        for number, visual in enumerate(robot.link_map[name].visuals):
            self._add_visual(f"{path}/visual_{number}", visual, colours[visual.material.name])
        for joint in robot.joints:
            if joint.parent == name:
                below = f"{path}/{joint.name}"
                self._axes[joint.name] = np.array(joint.axis)
                self._frames[joint.name] = self._server.scene.add_frame(
                    below, show_axes=False, position=tuple(joint.origin.xyz)
                )
                self._add_link(robot, joint.child, below)

    def _add_visual(self, path: str, visual: Any, colour: list[float]) -> None:
        scene, shape, origin = self._server.scene, visual.geometry, visual.origin
        place: dict[str, Any] = {
            "color": tuple(round(255 * part) for part in colour),
            "position": tuple(origin.xyz),
            "wxyz": SO3.from_rpy_radians(*map(float, origin.rpy or (0, 0, 0))).wxyz,
        }
        if isinstance(shape, Cylinder):
            scene.add_cylinder(path, shape.radius, shape.length, **place)
        elif isinstance(shape, Sphere):
            scene.add_icosphere(path, shape.radius, **place)

    def _surroundings(self, height: float) -> None:
        server = self._server
        # Shadows and a picture of the surroundings take a browser without graphics hardware longer
        # than everything else on the page.
        server.scene.configure_default_lights(cast_shadow=False)
        server.scene.configure_environment_map(None)
        server.scene.add_light_ambient("/daylight", intensity=DAYLIGHT)
        server.scene.add_grid(
            "/ground",
            width=8 * height,
            height=8 * height,
            cell_size=height / 4,
            section_size=height,
            cell_color=GROUND,
            section_color=GROUND,
        )
        self._height = height
        for client in server.get_clients().values():
            self._place_camera(client)

    def _place_camera(self, client: viser.ClientHandle) -> None:
        """Look at the pendulum, once its size is known."""
        if self._height:
            narrow = client.camera.aspect < NARROW
            camera, target = (NARROW_CAMERA, NARROW_TARGET) if narrow else (CAMERA, TARGET)
            with client.atomic():
                client.camera.position = self._height * np.array(camera)
                client.camera.look_at = self._height * np.array(target)

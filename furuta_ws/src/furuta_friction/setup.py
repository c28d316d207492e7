import shlex
import sys

from setuptools import find_packages, setup

# Executables start with SIGINT blocked until they have a handler for it (process_start.py).
INTERPRETER = f"/usr/bin/env -S --block-signal=INT {shlex.quote(sys.executable)}"
NAME = "furuta_friction"

setup(
    name=NAME,
    version="0.1.0",
    description="Friction observer of the Furuta pendulum, with its compensators.",
    license="Apache-2.0",
    url="https://github.com/furuta_ws/furuta_ws",
    author="The furuta_ws developers",
    author_email="furuta_ws@users.noreply.github.com",
    maintainer="The furuta_ws developers",
    maintainer_email="furuta_ws@users.noreply.github.com",
    packages=find_packages(),
    package_data={NAME: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    entry_points={
        "console_scripts": [
            "friction_observer = furuta_friction.executables:friction_observer",
        ]
    },
    extras_require={"test": ["pytest"]},
    options={"build_scripts": {"executable": INTERPRETER}},
    zip_safe=False,
)

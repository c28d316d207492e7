import shlex
import sys
from glob import glob

from setuptools import find_packages, setup

# Executables start with SIGINT blocked until they have a handler for it (process_start.py).
INTERPRETER = f"/usr/bin/env -S --block-signal=INT {shlex.quote(sys.executable)}"
NAME = "furuta_bringup"

setup(
    name=NAME,
    version="0.1.0",
    description="Launch file, configuration and executables of the Furuta pendulum graph.",
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
        (f"share/{NAME}/launch", glob("launch/*")),
        (f"share/{NAME}/config", glob("config/*.yaml")),
        (f"share/{NAME}/config/rigs", glob("config/rigs/*.yaml")),
        (f"share/{NAME}/config/security", glob("config/security/*")),
    ],
    entry_points={
        "console_scripts": [
            "furuta = furuta_cli.main:main",
            "graph = furuta_bringup.graph:main",
        ]
    },
    extras_require={"test": ["pytest", "distributed", "playwright"]},
    options={"build_scripts": {"executable": INTERPRETER}},
    zip_safe=False,
)

from setuptools import find_packages, setup

NAME = "furuta_hw"

setup(
    name=NAME,
    version="0.1.0",
    description="Hardware bridge of the Furuta pendulum",
    license="Apache-2.0",
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
            "hardware_bridge = furuta_hw.bridge.bridge_node:main",
            "rig_emulator = furuta_rig.emulator.rig_emulator:main",
        ]
    },
    zip_safe=False,
)

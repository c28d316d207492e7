from setuptools import find_packages, setup

NAME = "furuta_hw"

setup(
    name=NAME,
    version="0.1.0",
    description="Hardware bridge of the Furuta pendulum: drivers, safety, commissioning.",
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
            "hardware_bridge = furuta_hw.bridge.bridge_node:main",
            "rig_emulator = furuta_rig.emulator.rig_emulator:main",
        ]
    },
    extras_require={"test": ["pytest"]},
    zip_safe=False,
)

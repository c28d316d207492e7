from glob import glob

from setuptools import find_packages, setup

NAME = "furuta_rig"

setup(
    name=NAME,
    version="0.1.0",
    description="Rig files, calibration, serial protocol and emulated rig.",
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
        (f"share/{NAME}/firmware/core", glob("firmware/core/*")),
        *(
            (f"share/{NAME}/firmware/boards/{board}", glob(f"firmware/boards/{board}/*"))
            for board in ("avr", "emulated", "rp2040", "teensy4")
        ),
    ],
    extras_require={"firmware": ["ziglang"], "test": ["pytest", "unicorn"]},
    zip_safe=False,
)

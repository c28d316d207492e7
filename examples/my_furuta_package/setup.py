from setuptools import setup

NAME = "my_furuta_package"

setup(
    name=NAME,
    version="0.1.0",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", ["launch/my_furuta.launch.py"]),
        (f"share/{NAME}/config", ["config/my_furuta.yaml"]),
    ],
    extras_require={"test": ["pytest"]},
    entry_points={"console_scripts": [f"my_observer = {NAME}.my_observer:main"]},
)

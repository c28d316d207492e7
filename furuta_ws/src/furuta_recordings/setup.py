from setuptools import find_packages, setup

NAME = "furuta_recordings"

setup(
    name=NAME,
    version="0.1.0",
    description="Recorder, replay, bag files, and readers of other recordings.",
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
        "console_scripts": ["recorder = furuta_recordings.recorder_process:main"],
    },
    extras_require={"parquet": ["pyarrow"], "test": ["pytest"]},
    zip_safe=False,
)

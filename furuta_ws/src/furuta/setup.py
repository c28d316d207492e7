from setuptools import find_packages, setup

NAME = "furuta"

setup(
    name=NAME,
    version="0.1.0",
    description="Library of models, simulations, analyses and recordings, without ROS.",
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
    extras_require={"test": ["pytest"]},
    zip_safe=False,
)

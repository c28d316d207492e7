import shlex
import sys

from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

# Executables start with SIGINT blocked until they have a handler for it (furuta_ros/process.py).
EXECUTABLE = f"/usr/bin/env -S --block-signal=INT {shlex.quote(sys.executable)}"
setup(options={"build_scripts": {"executable": EXECUTABLE}}, **generate_distutils_setup())

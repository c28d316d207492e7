import shlex
import sys

from setuptools import setup

# Executables start with SIGINT blocked until they have a handler for it (process_start.py).
setup(
    options={
        "build_scripts": {
            "executable": f"/usr/bin/env -S --block-signal=INT {shlex.quote(sys.executable)}"
        }
    }
)

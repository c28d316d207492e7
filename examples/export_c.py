"""The control system as C: export it, compile it, and call it from Python sample by sample.

    tools/in_environment python examples/export_c.py    # needs a C compiler, cc

On the readings of a simulation it gives the commands of the simulation to the last bit.
"""

import ctypes
import subprocess
from pathlib import Path

import numpy as np

import furuta

FOLDER = Path("output/examples/loop")
STEP = """
#include "loop.h"
static loop_memory memory; /* its size is known here, and not in Python */
void start(void) { loop_init(&memory); }
double step(const loop_reading *reading) {
    loop_command command;
    loop_step(&memory, reading, &command);
    return command.voltage;
}
"""
loop = furuta.make_loop({"compensation": "lugre", "omega1": 8.0})
run = furuta.simulate(loop, 5.0)
furuta.export_c(loop, FOLDER)
(FOLDER / "step.c").write_text(STEP)
flags = ["-std=c99", "-O2", "-ffp-contract=off", "-shared", "-fPIC"]
subprocess.run(["cc", *flags, "-o", "loop.so", "step.c", "loop.c", "-lm"], cwd=FOLDER, check=True)

library = ctypes.CDLL(str((FOLDER / "loop.so").resolve()))
library.step.restype = ctypes.c_double
library.start()
commands = [library.step(reading.ctypes.data_as(ctypes.c_void_p)) for reading in run.measurement]
print(f"{len(commands)} commands, largest difference {np.abs(commands - run.command).max()} V")

# prints
# 5000 commands, largest difference 0.0 V

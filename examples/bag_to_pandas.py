"""A recording as a table of pandas: a row per sample, and the unit in the name of each column.

    tools/in_environment python examples/bag_to_pandas.py [BAG]

Without BAG the script first records two seconds of the graph in lock-step.
"""

import shutil
import subprocess
import sys

import furuta

bag = "output/examples/bag"
if sys.argv[1:]:
    bag = sys.argv[1]
else:
    shutil.rmtree(bag, ignore_errors=True)  # of an earlier run
    options = ["--lockstep", "--seconds", "2", "--set", "compensation=lugre", "--record", bag]
    subprocess.run(["furuta", "run", *options], check=True, stdout=subprocess.DEVNULL)
table = furuta.load_series(bag).to_pandas().set_index("time_s")
print(table[["measured_phi_rad", "command_v", "friction_estimate_v"]].iloc[::400].round(3))

# prints
#         measured_phi_rad  command_v  friction_estimate_v
# time_s
# 0.0                0.000      0.371               -0.012
# 0.4                0.151     -0.290               -0.215
# 0.8                0.000     -0.174               -0.210
# 1.2               -0.025      0.188                0.198
# 1.6                0.000      0.228                0.227

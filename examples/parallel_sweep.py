"""Many loops at once: on all cores of this computer, and on a Dask cluster.

    tools/in_environment python examples/parallel_sweep.py

The cluster here consists of two threads. ``Client("tcp://HOST:8786")`` is a real one, whose workers
have the library installed.
"""

import numpy as np
from distributed import Client, LocalCluster

import furuta

values = {"omega1": [5.0, 7.0, 9.0], "plant.friction.alpha0": [0.1, 0.2, 0.3]}
table = furuta.sweep(values, seconds=20.0)

loops = [
    furuta.make_loop({"omega1": omega1, "plant.friction.alpha0": level})
    for omega1 in values["omega1"]
    for level in values["plant.friction.alpha0"]
]
cluster = LocalCluster(2, 1, processes=False, dashboard_address=None)
with cluster, Client(cluster) as client:
    outcomes = client.gather(client.map(furuta.measure, loops, seconds=20.0))

print(table["phi_peak_to_peak_rad"].reshape(3, 3).round(3))
there = [outcome.phi_peak_to_peak_rad for outcome in outcomes]
print("the same on the cluster:", np.array_equal(there, table["phi_peak_to_peak_rad"]))

# prints
# [[0.468 0.927 1.375]
#  [0.243 0.487 0.726]
#  [0.146 0.293 0.439]]
# the same on the cluster: True

"""Export of compiled functions as C: a translator of the Python in which the cores are written."""

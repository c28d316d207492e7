"""A friction law of your own is a Python function: here Dahl's with a bump at 0.3 rad/s.

tools/in_environment python examples/own_law.py
./furuta limit-cycle --own-parts examples/own_law.py:BUMP --law examples/own_law.py:BUMP
"""

from math import exp
from typing import Any

import furuta


def level(v: float, p: Any) -> float:
    """g(v) [V] at the arm's speed v [rad/s]; p has the parameters of friction."""
    return p.alpha0 * (1.0 + 0.5 * exp(-(((abs(v) - 0.3) / 0.1) ** 2)))


BUMP = furuta.Law("bump", level, bristle=True, damped=False)

if __name__ == "__main__":
    for name, law in (("dahl", "dahl"), ("bump", BUMP)):
        loop = furuta.make_loop({"friction.law": law})
        size = furuta.measure(loop, 60.0).phi_peak_to_peak_rad
        cycle = furuta.limit_cycle(loop)
        print(f"{name}: simulated {size:.3f} rad, exact {cycle.phi_peak_to_peak_rad:.3f} rad")

# prints
# dahl: simulated 0.511 rad, exact 0.509 rad
# bump: simulated 0.521 rad, exact 0.520 rad

"""Names of the friction laws; help shows them without compiled code."""

# Laws for which describing functions and exact limit cycles are defined.
ANALYSED_LAWS = (
    "coulomb",
    "stiction",
    "stribeck",
    "lugre",
    "dahl",
)
LAWS = (*ANALYSED_LAWS, "maxwell_slip")

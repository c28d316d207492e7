"""Symbols of the parameters, as the axes of figures and the documentation show them."""

from furuta.studies.analysis_options import GAINS
from furuta_graph.settings.parameter_names import parameters_named

# By the last part of a parameter's name; a parameter without a symbol keeps its name.
SYMBOLS = {
    "alpha": "α",
    "beta": "β",
    "gamma": "γ",
    "delta": "δ",
    "alpha0": "α₀",
    "alpha1": "α₁",
    "stribeck_velocity": "vₛ",
    "sigma0": "σ₀",
    "sigma1": "σ₁",
    "viscous": "σ₂",
    "asymmetry": "a",
    "omega1": "ω₁",
    "zeta1": "ζ₁",
    "omega2": "ω₂",
    "zeta2": "ζ₂",
    "observer_gain": "K",
    "sample_time": "h",
    "a23": "a₂₃",
    "a43": "a₄₃",
    "b21": "b₂₁",
    "b41": "b₄₁",
}
# Gains of u = l·x, which are no parameters of a node.
GAIN_LABELS = dict(
    zip(GAINS, ("l₁ [V/rad]", "l₂ [V s/rad]", "l₃ [V/rad]", "l₄ [V s/rad]"), strict=True)
)


def axis_label(name: str) -> str:
    """Label of the axis of a parameter that is named as for ``--set``: symbol and unit.

    A name that restricts the parameter to a node or a group stays beside the symbol, so that the
    plant's α₀ is not taken for the observer's.
    """
    if name in GAIN_LABELS:
        return GAIN_LABELS[name]
    where, _, last = name.rpartition(".")
    symbol = SYMBOLS.get(last, last)
    (_, declared), *_ = parameters_named(name)
    unit = f" [{declared.about.unit}]" if declared.about.unit else ""
    if symbol == last:
        return f"{name}{unit}"
    return f"{symbol} of {where}{unit}" if where else f"{symbol}{unit}"

"""Names, units and meaning of the columns in which series are exported, one row per sample."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

# Series (n,) by column name.
Series = dict[str, np.ndarray]


class Column(NamedTuple):
    """A column: its unit, and what it holds."""

    unit: str
    meaning: str


def _of_state(prefix: str, adjective: str) -> dict[str, Column]:
    return {
        f"{prefix}_phi_rad": Column("rad", f"{adjective} arm angle φ"),
        f"{prefix}_phi_dot_rad_s": Column("rad/s", f"{adjective} arm speed φ̇"),
        f"{prefix}_theta_rad": Column("rad", f"{adjective} pendulum angle θ"),
        f"{prefix}_theta_dot_rad_s": Column("rad/s", f"{adjective} pendulum speed θ̇"),
    }


TIME = "time_s"
# Columns in the order of arrays: measurement (n, 5), estimated state (n, 4), true state and
# friction.
MEASURED = {
    **_of_state("measured", "measured"),
    "applied_torque_v": Column("V", "torque applied since the previous sample, as measured"),
}
ESTIMATED = _of_state("estimated", "estimated")
TRUE = {
    **_of_state("true", "true"),
    "true_friction_v": Column("V", "true friction F of the simulated arm"),
}
FRICTION_ESTIMATE, COMMAND = "friction_estimate_v", "command_v"
COLUMNS = {
    TIME: Column("s", "time since the first sample"),
    **MEASURED,
    **ESTIMATED,
    FRICTION_ESTIMATE: Column("V", "friction estimate F̂ of the friction observer"),
    COMMAND: Column("V", "command u of the controller"),
    **TRUE,
}
# One of these tells a table of series from another one, which may share a name or two.
ANGLES = {name for name in COLUMNS if name.endswith(("phi_rad", "theta_rad"))}


def by_name(names: Iterable[str], values: np.ndarray) -> Series:
    """The columns of an array (n, m) with these names."""
    return dict(zip(names, np.asarray(values).T, strict=True))


def known(series: Series) -> Series:
    """The columns that hold a number."""
    return {name: values for name, values in series.items() if np.any(np.isfinite(values))}


def series_of(
    time: np.ndarray,
    measurement: np.ndarray,
    estimate: np.ndarray,
    friction_estimate: np.ndarray,
    command: np.ndarray,
    truth: np.ndarray,
) -> Series:
    """The columns of the signals of a loop, as a bag of the graph or a simulation has them.

    ``measurement`` (n, 5), ``estimate`` (n, 4), ``truth`` (n, 5), all others (n,).
    """
    return {
        TIME: time,
        **by_name(MEASURED, measurement),
        **by_name(ESTIMATED, estimate),
        FRICTION_ESTIMATE: friction_estimate,
        COMMAND: command,
        **by_name(TRUE, truth),
    }

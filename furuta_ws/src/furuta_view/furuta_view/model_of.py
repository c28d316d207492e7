"""The pendulum's model among the parameters of the nodes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from furuta_model.pendulum import FurutaPendulum
from furuta_sim.settings.nodes import PLANT


def model_of(values: Mapping[str, Mapping[str, Any]]) -> FurutaPendulum:
    """The model of the plant, or that which the estimator assumes, or the paper's."""
    for node in (PLANT, "estimator"):
        given = values.get(node, {})
        if "model.alpha" in given:
            return FurutaPendulum(*(given[f"model.{each}"] for each in FurutaPendulum._fields))
    return FurutaPendulum()

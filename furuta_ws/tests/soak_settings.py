"""How long the random state machines in ``soak`` run: ``make soak`` sets FURUTA_SOAK."""

import os
from collections.abc import Callable

from hypothesis import HealthCheck, Phase, settings
from hypothesis.stateful import RuleBasedStateMachine, run_state_machine_as_test

EXAMPLES = int(os.environ.get("FURUTA_SOAK", "0"))
LONG = {"max_examples": EXAMPLES}
# Without search for a shorter list of steps, which takes minutes.
SHORT = {"max_examples": 10, "derandomize": True, "phases": [Phase.generate]}


def run(machine: Callable[[], RuleBasedStateMachine]) -> None:
    """Run examples of a machine; a failure shows the steps that lead to it."""
    how = settings(
        deadline=None,
        database=None,
        stateful_step_count=200 if EXAMPLES else 40,
        suppress_health_check=list(HealthCheck),
        **(LONG if EXAMPLES else SHORT),
    )
    run_state_machine_as_test(machine, settings=how)

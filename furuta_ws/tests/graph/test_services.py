"""How many changes of parameters a node accepts."""

from furuta_ros.parameters import BURST, RATE, Allowance


def test_changes_of_parameters_are_limited() -> None:
    """A burst at once, and then as many as the rate permits, so that samples go on."""
    now = [0.0]
    allowance = Allowance(lambda: now[0])
    assert sum(allowance.take() for _ in range(1000)) == BURST
    now[0] += 5.0 / RATE
    assert [allowance.take() for _ in range(6)] == [True] * 5 + [False]

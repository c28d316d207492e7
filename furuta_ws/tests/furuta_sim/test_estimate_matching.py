"""Matching of friction estimates to states in real time; lock-step is explored as a whole."""

from furuta_control.estimate_matching import (
    SUSPICIOUS,
    Answer,
    EstimateMatching,
)
from furuta_ros.topics import QOS


def test_estimates_that_stay_older_than_their_states_are_told() -> None:
    """As with clocks of two computers that differ."""
    matching = EstimateMatching(QOS.depth)
    matching.state(sent=100)
    for k in range(SUSPICIOUS):
        assert not matching.suspicious
        assert matching.estimate(0.1, sent=50 + k) is Answer.NONE
        matching.repetition(sent=60 + k)
    assert matching.suspicious
    assert matching.estimate(0.1, sent=101) is Answer.STEP
    assert not matching.suspicious


def test_in_real_time_clocks_are_not_compared() -> None:
    """Nothing is repeated there: counting is enough, and clocks may differ a little."""
    matching = EstimateMatching(QOS.depth)
    matching.state(sent=100)
    assert matching.estimate(0.1, sent=101) is Answer.STEP
    matching.state(sent=200)
    assert matching.estimate(0.2, sent=201) is Answer.STEP
    matching.state(sent=300)
    assert matching.estimate(0.3, sent=290) is Answer.STEP
    assert matching.estimate(0.4, sent=390) is Answer.NONE
    assert matching.state(sent=400) is Answer.STEP
    assert matching.friction == 0.4


def test_late_estimates_are_lost_after_a_while() -> None:
    """A state waits again for its estimate once ten in a row were late and one has come.

    The first two wait in any case: they do not count on an estimate of an earlier one.
    """
    matching = EstimateMatching(QOS.depth)
    assert matching.state(sent=0) is Answer.NONE
    assert matching.state(sent=1) is Answer.NONE
    for k in range(QOS.depth):
        assert matching.state(sent=2 + k) is Answer.STEP_WITHOUT
    assert matching.estimate(0.1, sent=50) is Answer.CORRECT
    assert matching.state(sent=51) is Answer.NONE
    assert matching.estimate(0.2, sent=52) is Answer.STEP

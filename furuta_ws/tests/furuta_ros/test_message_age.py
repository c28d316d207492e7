"""How old a message may be when it is answered."""

import pytest

from furuta_ros.message_age import MAX_AGE, MessageAge

SENT = 1_700_000_000_000_000_000
LIMIT = round(MAX_AGE * 1e9)


@pytest.mark.parametrize(
    ("waited", "simulated", "answered"),
    [(0, False, True), (LIMIT, False, True), (LIMIT + 1, False, False), (10**12, True, True)],
)
def test_old_messages_are_not_answered_in_real_time(
    waited: int, simulated: bool, answered: bool
) -> None:
    """Neither when they arrive nor when the answer is ready; simulated time waits for answers."""
    times = iter([SENT + waited, SENT, SENT + waited, SENT + waited])
    age = MessageAge(lambda: simulated, lambda: next(times))
    assert age.received(SENT) == answered
    assert age.received(SENT)
    assert age.answerable() == answered
    assert age.expired == (0 if answered else 2)
    assert age.age == pytest.approx(waited / 1e9)


def test_messages_without_a_time_of_sending_are_answered() -> None:
    """Some middlewares do not know it."""
    age = MessageAge(lambda: False)
    assert age.received(0)
    assert age.age == 0.0

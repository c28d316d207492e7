"""Which messages of a topic are accepted, given their sequence numbers and its publishers."""

from collections.abc import Iterable

import pytest

from furuta_ros.one_publisher import (
    LOOKUP_PERIOD,
    REPORT_PERIOD,
    SETTLING_TIME,
    OnePublisher,
    TopicPublisher,
)

CONTROLLER = TopicPublisher(b"1", "/controller")
RESTARTED = TopicPublisher(b"2", "/controller")
OTHER = TopicPublisher(b"3", "/other")
MS = 0.001


class Subscriber:
    """A subscriber of ``command`` with chosen publishers and time."""

    def __init__(self, *publishers: TopicPublisher) -> None:
        self.publishers = list(publishers)
        self.time = 0.0
        self.reports: list[str] = []
        self.one = OnePublisher(
            "command", lambda: tuple(self.publishers), self.reports.append, lambda: self.time
        )

    def accepted(self, numbers: Iterable[int | None], interval: float = MS) -> list[int | None]:
        """Those of the numbers that are accepted; they come with an interval [s]."""
        accepted = []
        for number in numbers:
            self.time += interval
            if self.one.accepts(number):
                accepted.append(number)
        return accepted


def test_a_sole_publisher_is_accepted_with_gaps() -> None:
    """Wherever its sequence starts, and if messages were lost; nothing is reported."""
    subscriber = Subscriber(CONTROLLER)
    assert subscriber.accepted([7, 8, 9, 20, 21, 500]) == [7, 8, 9, 20, 21, 500]
    assert subscriber.reports == []


def test_a_stray_message_is_rejected_and_its_node_named() -> None:
    """The accepted sequence goes on, for a lower and for a higher number of the stray message."""
    for stray in (1, 900):
        subscriber = Subscriber(CONTROLLER)
        subscriber.accepted(range(5, 300))
        subscriber.publishers.append(OTHER)
        assert subscriber.accepted([300, stray, 301, 302]) == [300, 301, 302]
        (report,) = subscriber.reports
        assert "2 nodes publish command: /controller and /other" in report
        assert "only messages from /controller are accepted" in report


def test_a_stray_message_that_outlives_its_publisher_is_rejected() -> None:
    """A message may be taken after its publisher has ended."""
    subscriber = Subscriber(CONTROLLER)
    subscriber.accepted(range(5, 300))
    assert subscriber.accepted([1, 300, 2, 301]) == [300, 301]
    assert "not from /controller" in subscriber.reports[0]


def test_a_second_node_is_rejected_for_as_long_as_it_publishes() -> None:
    """It is reported again from time to time, with the number of rejected messages."""
    subscriber = Subscriber(CONTROLLER)
    subscriber.accepted(range(5000, 6000))
    subscriber.publishers.append(OTHER)
    numbers = [number for k in range(20_000) for number in (6000 + k, 1 + k)]
    assert subscriber.accepted(numbers, MS / 2) == numbers[::2]
    assert len(subscriber.reports) == 20 / REPORT_PERIOD
    assert subscriber.one.rejected == 20_000


def test_a_silent_second_publisher_is_reported() -> None:
    """The check finds it without any message from it."""
    subscriber = Subscriber(CONTROLLER)
    subscriber.accepted([1])
    subscriber.one.check()
    assert subscriber.reports == []
    subscriber.publishers.append(OTHER)
    subscriber.one.check()
    assert "/other" in subscriber.reports[0]


def test_a_restarted_node_waits_until_the_killed_one_is_unlisted() -> None:
    """Its name does not matter."""
    subscriber = Subscriber(CONTROLLER)
    subscriber.accepted(range(1000, 1050))
    subscriber.publishers.append(RESTARTED)
    assert subscriber.accepted(range(1, 800)) == []
    assert "a killed node stays listed" in subscriber.reports[0]
    subscriber.publishers.remove(CONTROLLER)
    accepted = subscriber.accepted(range(800, 2000))
    assert accepted == list(range(accepted[0], 2000))
    assert accepted[0] - 800 <= (LOOKUP_PERIOD + SETTLING_TIME) / MS + 1


def test_a_loss_beside_a_second_publisher_stops_the_loop() -> None:
    """The message could come from either; it goes on when one of them is left."""
    subscriber = Subscriber(CONTROLLER)
    subscriber.accepted(range(1, 50))
    subscriber.publishers.append(OTHER)
    assert subscriber.accepted(range(53, 2000)) == []
    assert "no message is accepted" in subscriber.reports[0]
    subscriber.publishers.remove(OTHER)
    accepted = subscriber.accepted(range(2000, 3000))
    assert accepted == list(range(accepted[0], 3000))


@pytest.mark.parametrize("per_burst", [4, 25])
@pytest.mark.parametrize("lost", [0, 1, 7, 45])
def test_a_flood_never_takes_the_place(per_burst: int, lost: int) -> None:
    """However fast it numbers its messages, in bursts of 50 of which some are lost.

    Its numbers pass those of the accepted publisher; nothing is accepted from then on.
    """
    subscriber = Subscriber(CONTROLLER)
    subscriber.accepted(range(4000, 5000))
    subscriber.publishers.append(OTHER)
    expected = iter(range(5000, 20_000))
    for burst in range(400):
        flood = range(50 * burst + 1 + lost, 50 * burst + 51)
        taken = subscriber.accepted(flood, MS / 50)
        own = [next(expected) for _ in range(per_burst)]
        assert taken == []
        accepted = subscriber.accepted(own)
        assert accepted in (own, [])
    assert accepted == []


def test_a_number_far_ahead_was_no_loss() -> None:
    """A last message of an ended publisher does not stop the accepted one for long."""
    subscriber = Subscriber(CONTROLLER)
    subscriber.accepted(range(1, 1000))
    assert subscriber.accepted([900_000]) == [900_000]
    accepted = subscriber.accepted(range(1000, 2000))
    assert accepted == list(range(accepted[0], 2000))
    assert accepted[0] <= 1000 + SETTLING_TIME / MS + 3


def test_two_nodes_from_the_start_are_both_rejected() -> None:
    """Which one is right cannot be told; when one is left, it is accepted."""
    subscriber = Subscriber(CONTROLLER, OTHER)
    numbers = [number for k in range(1, 2000) for number in (k, k + 5)]
    assert subscriber.accepted(numbers) == []
    assert "no message is accepted until there is only one" in subscriber.reports[0]
    subscriber.publishers.remove(OTHER)
    subscriber.time += LOOKUP_PERIOD
    assert subscriber.accepted([2000]) == []
    subscriber.time += SETTLING_TIME
    assert subscriber.accepted([2001, 2002]) == [2001, 2002]


def test_a_middleware_without_sequence_numbers() -> None:
    """A sole publisher is accepted; with a second one no message is."""
    subscriber = Subscriber(CONTROLLER)
    assert subscriber.accepted([None, None]) == [None, None]
    subscriber.publishers.append(OTHER)
    assert subscriber.accepted([None, None]) == []

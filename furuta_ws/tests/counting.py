"""Counts what the callbacks of a node have handled, and what it has published."""

from collections import Counter
from collections.abc import Callable
from functools import wraps
from typing import Any

from furuta_ros.node import LoopPublisher


def count_handled(node: Any) -> Counter[str]:
    """Counts the messages that the callbacks of a node have handled, by topic name."""
    handled: Counter[str] = Counter()

    def counted(name: str, callback: Callable[..., None]) -> Callable[..., None]:
        @wraps(callback)
        def call(*arguments: Any) -> None:
            callback(*arguments)
            handled[name] += 1

        return call

    for each in node.subscriptions:
        each.callback = counted(each.topic_name.strip("/"), each.callback)
    return handled


def count_published(publisher: LoopPublisher) -> Counter[str]:
    """Counts what is published in the loop, as ``messages``."""
    published: Counter[str] = Counter()
    publish = publisher.publish

    def counted(data: bytes, stamp: int) -> None:
        published["messages"] += 1
        publish(data, stamp)

    publisher.publish = counted  # type: ignore[method-assign]
    return published

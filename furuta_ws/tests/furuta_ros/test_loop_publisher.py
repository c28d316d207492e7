"""The throttled copy of a topic: a hundred messages per second of the loop's time."""

from rclpy.serialization import serialize_message
from std_msgs.msg import Float64
from testbench import Bench

from furuta_ros.loop_publisher import LoopPublisher
from furuta_ros.time_stamps import NANOSECONDS
from furuta_ros.topics import COMMAND, deep

MS = NANOSECONDS // 1000


def test_some_messages_are_published_again(bench: Bench) -> None:
    """Every tenth at 1 kHz; every one at 50 Hz; none is held back after time has gone back."""
    received: list[Float64] = []
    copy = COMMAND.throttled
    assert copy.name == "command_throttle"
    bench.probe.create_subscription(copy.type, copy.name, received.append, deep(1000))
    publisher = LoopPublisher(bench.probe, COMMAND)
    bench.wait_for_publisher(copy)
    bench.spin(lambda: bench.probe.count_subscribers(copy.name) > 0)
    stamps = [*range(0, 50 * MS, MS), *range(100 * MS, 200 * MS, 20 * MS), 0]
    for stamp in stamps:
        publisher.publish(serialize_message(Float64(data=float(stamp // MS))), stamp)
    expected = [0.0, 10.0, 20.0, 30.0, 40.0, 100.0, 120.0, 140.0, 160.0, 180.0, 0.0]
    bench.spin(lambda: len(received) >= len(expected))
    assert [message.data for message in received] == expected

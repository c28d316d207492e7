"""``python -m flood``: a publisher that floods the topic ``command``, and never sleeps for long."""

import sys
from time import sleep

import rclpy
from std_msgs.msg import Float64

# The voltage that it sends, and how: 14 000 messages per second in bursts.
VOLTS = 9.87
BURST, RATE = 50, 14_000
COMMAND = (sys.executable, __file__)


def main() -> None:
    """Print a line once the publisher is found, and publish until the process is ended."""
    rclpy.init()
    publisher = rclpy.create_node("flood").create_publisher(Float64, "command", 10)
    while publisher.get_subscription_count() == 0:
        sleep(0.01)
    print("found", flush=True)
    while True:
        for _ in range(BURST):
            publisher.publish(Float64(data=VOLTS))
        sleep(BURST / RATE)


if __name__ == "__main__":
    main()

"""``python -m parameter_storm NODE NAME LOW HIGH RATE SECONDS``: changes a parameter all the time.

It waits for no answer. The last line says how many changes were sent, and how many of the answers
that came were refusals.
"""

import sys
from time import monotonic, sleep

import rclpy
from rcl_interfaces.srv import SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter

COMMAND = (sys.executable, __file__)
# Time between two bursts [s].
PERIOD = 0.01


def main() -> None:
    """Print a line once the service is found, and one at the end."""
    node_name, name, low, high, rate, seconds = sys.argv[1:]
    ends = float(low), float(high)
    rclpy.init()
    node = rclpy.create_node("parameter_storm", start_parameter_services=False)
    client = node.create_client(SetParameters, f"{node_name}/set_parameters")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    client.wait_for_service()
    print("found", flush=True)
    began, sent, answers = monotonic(), 0, []
    while (now := monotonic() - began) < float(seconds):
        while sent < now * float(rate):
            value = Parameter(name, value=ends[sent % 2]).to_parameter_msg()
            asked = client.call_async(SetParameters.Request(parameters=[value]))
            asked.add_done_callback(lambda future: answers.append(future.result().results[0]))
            sent += 1
        executor.spin_once(timeout_sec=0.0)
        sleep(min(PERIOD, 1.0 / float(rate)))
    refused = sum(not answer.successful for answer in answers)
    print(f"{sent} sent, {len(answers)} answered, {refused} refused", flush=True)


if __name__ == "__main__":
    main()

"""Records ``/joint_states`` into a bag, as ``ros2 bag record -s mcap /joint_states`` does.

tools/in_environment python examples/robot_joint/record.py output/joint_bag 60

The arguments are the bag and the time [s].
"""

import sys
from pathlib import Path
from time import monotonic, sleep

import rclpy

from furuta_recordings.recorder_node import COLLECT_EVERY, RecorderNode
from furuta_ros.topics import Topic

bag, seconds = Path(sys.argv[1]), float(sys.argv[2])
rclpy.init()
recorder = RecorderNode(bag, topics=[Topic("/joint_states", "sensor_msgs/msg/JointState")])
end = monotonic() + seconds
while monotonic() < end:
    recorder.collect()
    sleep(COLLECT_EVERY)
recorder.close()
rclpy.shutdown()

"""A user's own controller as a plain rclpy node: damps the load's heave by the winch, or says nonsense from a time on.

Arguments: name of the node, gain, time [s] from which its messages are wrong (or ``never``).
"""

import sys

import rclpy
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState


class Controller(Node):
    """Answers every odometry of the load with a pay-out speed of the same stamp."""

    def __init__(self, name, gain, wrong_from_s):
        super().__init__(name)
        self.gain, self.wrong_from_s = gain, wrong_from_s
        qos = QoSProfile(depth=400)
        self.publisher = self.create_publisher(JointState, f"/{name}/joint_command", qos)
        self.subscription = self.create_subscription(Odometry, "/payload/odom", self.answer, qos)

    def answer(self, odom):
        command = JointState()
        command.header.stamp = odom.header.stamp
        command.header.frame_id = "any frame"
        command.name = ["winch"]
        command.velocity = [self.gain * odom.twist.twist.linear.z]
        if odom.header.stamp.sec + 1e-9 * odom.header.stamp.nanosec >= self.wrong_from_s:
            command.velocity = [float("nan")]
        self.publisher.publish(command)


def main():
    name, gain, wrong_from = sys.argv[1:]
    rclpy.init()
    node = Controller(name, float(gain), float("inf") if wrong_from == "never" else float(wrong_from))
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

"""A free listener and operator in a process of its own: JSON requests on stdin, JSON answers on stdout."""

import json
import os
import queue
import sys
import threading
import time
from importlib import import_module

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, TwistStamped
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger

from shipcrane_twin.ros.shared_memory import remove_own

PATIENCE_S = 8.0
COMMAND = "/crane/joint_command"


class Operator:
    def __init__(self):
        self.node = Node("test_operator")
        self.command = self.node.create_publisher(JointState, COMMAND, 10)
        self.tip = self.node.create_publisher(TwistStamped, "/crane/tip_command", 10)
        self.setpoint = self.node.create_publisher(PoseStamped, "/dp/setpoint", 10)
        self.enable_client = self.node.create_client(SetBool, "/dp/enable")
        self.pause_client = self.node.create_client(SetBool, "/clock/pause")
        self.step_client = self.node.create_client(Trigger, "/clock/step")
        self.heard = {}

    def wait(self, done):
        end = time.monotonic() + PATIENCE_S
        while not done():
            if time.monotonic() > end:
                raise TimeoutError(f"nothing within {PATIENCE_S:g} s")
            rclpy.spin_once(self.node, timeout_sec=0.01)

    def answer(self, future):
        self.wait(future.done)
        return future.result()

    def pause(self, data):
        self.wait(self.pause_client.service_is_ready)
        reply = self.answer(self.pause_client.call_async(SetBool.Request(data=data)))
        return [reply.success, reply.message]

    def enable(self, data):
        self.wait(self.enable_client.service_is_ready)
        reply = self.answer(self.enable_client.call_async(SetBool.Request(data=data)))
        return [reply.success, reply.message]

    def move_to(self, place, quat, frame="map"):
        self.wait(lambda: self.setpoint.get_subscription_count() >= 1)
        message = PoseStamped()
        message.header.frame_id = frame
        at, turn = message.pose.position, message.pose.orientation
        at.x, at.y = place
        turn.x, turn.y, turn.z, turn.w = quat
        self.setpoint.publish(message)

    def move_to_bytes(self, text):
        self.wait(lambda: self.setpoint.get_subscription_count() >= 1)
        self.setpoint.publish(bytes.fromhex(text))

    def step(self):
        self.wait(self.step_client.service_is_ready)
        reply = self.answer(self.step_client.call_async(Trigger.Request()))
        return [reply.success, reply.message]

    def set(self, node, name, value):
        client = AsyncParameterClient(self.node, node)
        self.wait(client.services_are_ready)
        result = self.answer(client.set_parameters([Parameter(name, value=value)])).results[0]
        return [result.successful, result.reason]

    def parameters(self, node):
        client = AsyncParameterClient(self.node, node)
        self.wait(client.services_are_ready)
        names = self.answer(client.list_parameters()).result.names
        descriptors = self.answer(client.describe_parameters(names)).descriptors
        return {found.name: [found.description, found.read_only] for found in descriptors}

    def say(self, names, velocities, stamp=(0, 0)):
        self.wait(lambda: self.command.get_subscription_count() >= 2)
        message = JointState(name=names, velocity=velocities)
        message.header.stamp.sec, message.header.stamp.nanosec = stamp
        self.command.publish(message)

    def place(self, names, positions):
        self.wait(lambda: self.command.get_subscription_count() >= 2)
        self.command.publish(JointState(name=names, position=positions))

    def move_tip(self, velocity, frame):
        self.wait(lambda: self.tip.get_subscription_count() >= 1)
        message = TwistStamped()
        message.header.frame_id = frame
        linear = message.twist.linear
        linear.x, linear.y, linear.z = velocity
        self.tip.publish(message)

    def say_bytes(self, text):
        self.wait(lambda: self.command.get_subscription_count() >= 2)
        self.command.publish(bytes.fromhex(text))

    def listen(self, topic, kind, depth=5000):
        package, _, name = kind.split("/")
        log = self.heard[topic] = []

        def hear(message):
            stamp = message.clock if hasattr(message, "clock") else message.header.stamp
            log.append(stamp.sec * 10**9 + stamp.nanosec)

        message_class = getattr(import_module(f"{package}.msg"), name)
        self.node.create_subscription(message_class, topic, hear, QoSProfile(depth=depth))

    def listen_for_status(self, topic):
        """Keep [stamp in ns, level, name, message, values] of every status in diagnostics."""
        log = self.heard[topic] = []

        def hear(message):
            stamp = message.header.stamp
            for status in message.status:
                values = {pair.key: pair.value for pair in status.values}
                time_ns = stamp.sec * 10**9 + stamp.nanosec
                log.append([time_ns, ord(status.level), status.name, status.message, values])

        self.node.create_subscription(DiagnosticArray, topic, hear, QoSProfile(depth=5000))

    def statuses(self, topic):
        return self.heard[topic]

    def stamps(self, topic):
        return self.heard[topic]

    def topics(self):
        """What is known of the graph once nothing new comes and every end has the name of its node."""
        last, since = {}, time.monotonic()

        def settled():
            nonlocal last, since
            now = self.seen()
            if now != last:
                last, since = now, time.monotonic()
            return "_NODE_NAME_UNKNOWN_" not in json.dumps(now) and time.monotonic() - since > 0.5

        self.wait(settled)
        return last

    def seen(self):
        return {
            name: {
                "types": types,
                "publishers": [
                    [end.node_name, end.qos_profile.reliability.name, end.qos_profile.durability.name]
                    for end in self.node.get_publishers_info_by_topic(name)
                ],
                "listeners": sorted(end.node_name for end in self.node.get_subscriptions_info_by_topic(name)),
            }
            for name, types in self.node.get_topic_names_and_types()
        }

    def services(self):
        return dict(self.node.get_service_names_and_types())


def main():
    rclpy.init()
    operator = Operator()
    requests = queue.Queue()

    def read():
        for line in sys.stdin:
            requests.put(json.loads(line))
        requests.put(None)

    threading.Thread(target=read, daemon=True).start()
    while True:
        rclpy.spin_once(operator.node, timeout_sec=0.005)
        try:
            request = requests.get_nowait()
        except queue.Empty:
            continue
        if request is None:
            break
        try:
            answer = {"result": getattr(operator, request.pop("do"))(**request)}
        except TimeoutError as err:
            answer = {"error": str(err)}
        sys.stdout.write(json.dumps(answer) + "\n")
        sys.stdout.flush()
    remove_own()
    os._exit(0)  # as the twin's nodes: taking rclpy apart can hang


if __name__ == "__main__":
    main()

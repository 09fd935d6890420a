"""The recorder: takes serialized messages as they come and writes them in order."""

import time
from pathlib import Path

import numpy as np
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.cosim.topics import BY_NAME
from shipcrane_twin.record.bag import RECORDED, BagWriter, bag_options
from shipcrane_twin.record.collector import StepCollector
from shipcrane_twin.ros.cdr import CdrError, Template, check_layout, read_stamp
from shipcrane_twin.ros.links import LOOP_QOS, Inbox, LoopOwned, Mailroom, message_class
from shipcrane_twin.ros.parameters import declare_run_parameters
from shipcrane_twin.ros.process import leave_graph, write_result
from shipcrane_twin.ros.stop import StopFlag
from shipcrane_twin.ros.subsystem_node import SERVICE_PERIOD_S

PAUSE_S = 0.004
"""Rest between two rounds: taking many messages at once costs far less than waking for each."""

PROGRESS = "/recorder/progress"
_NO_VALUES = np.empty(0)


class RecorderNode:
    """Records the twin's topics into ``bag/`` of the run's folder.

    Parameters
    ----------
    stop : StopFlag
    """

    def __init__(self, stop: StopFlag) -> None:
        self._stop = stop
        self.node = Node("recorder")
        run = declare_run_parameters(self.node)
        scenario = load_scenario(run.scenario)
        self._run_dir = run.run_dir
        self._step_ns, self._last = scenario.step_ns, scenario.step_count
        stop.arm()
        try:
            self._bag = BagWriter(Path(run.run_dir or ".") / "bag", **bag_options(scenario))
        except OSError as err:
            raise ConfigError(f"recorder: the bag cannot be written: {err}; give another folder") from None
        self._collector = StepCollector(RECORDED, scenario.step_ns, scenario.telemetry_every, self._bag.write)
        group = LoopOwned()
        self._mail = Mailroom(self.node, [Inbox(self.node, topic, group) for topic in RECORDED])
        self._template = Template(BY_NAME[PROGRESS])
        self._publisher = self.node.create_publisher(message_class(BY_NAME[PROGRESS].type), PROGRESS, LOOP_QOS)
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._busy_ns = 0
        self._cpu_s = 0.0

    def run(self) -> None:
        """Record until told to stop."""
        service_at = 0.0
        cpu_from = time.process_time()
        told = -1
        while not self._stop:
            self._mail.wait(SERVICE_PERIOD_S)
            began = time.perf_counter_ns()
            self._drain()
            if self._collector.complete > told:
                told = self._collector.complete
                self._publisher.publish(self._template.encode(told * self._step_ns, _NO_VALUES))
            self._busy_ns += time.perf_counter_ns() - began
            if time.monotonic() > service_at:
                self._executor.spin_once(timeout_sec=0.0)
                service_at = time.monotonic() + SERVICE_PERIOD_S
            time.sleep(PAUSE_S)
        self._drain()
        self._cpu_s = time.process_time() - cpu_from

    def close(self) -> None:
        """Finish the bag and leave the graph."""
        self._collector.flush()
        self._bag.close()
        steps = max(self._collector.complete, 1)
        write_result(
            self._run_dir,
            "recorder",
            {
                "steps": self._collector.complete,
                "messages": sum(self._bag.counts.values()),
                "cpu_s": self._cpu_s,
                "us_per_step": {"record": self._busy_ns / 1000 / steps},
            },
        )
        leave_graph(self.node)

    def _drain(self) -> None:
        """Take all that has arrived; what comes from outside gets the recorder's time, whatever its stamp says."""
        for inbox in self._mail.inboxes:
            topic = inbox.topic
            while (message := inbox.take()) is not None:
                try:
                    if topic.publisher == "operator":
                        check_layout(topic, message)  # anything else would spoil the bag
                        stamp = max(self._collector.complete, 0) * self._step_ns
                    else:
                        stamp = read_stamp(message)
                except CdrError as err:
                    self.node.get_logger().warn(f"{topic.name} not recorded: {err}", throttle_duration_sec=1.0)
                    continue
                self._collector.add(topic.name, stamp, message)

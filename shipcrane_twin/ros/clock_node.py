"""The clock: announces simulated time when everyone is ready for it, paces it, and names who is silent."""

import time
from pathlib import Path

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool, Trigger

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.controllers import chain_of, inputs_of, topics_of
from shipcrane_twin.cosim.coupling import SCHEMES
from shipcrane_twin.cosim.pacing import Lockstep, Pace, progress_of
from shipcrane_twin.cosim.time import stamp_parts
from shipcrane_twin.cosim.topics import BY_NAME
from shipcrane_twin.ros.cdr import Template
from shipcrane_twin.ros.links import (
    LOOP_QOS,
    Inbox,
    LoopOwned,
    Mailroom,
    listeners_matched,
    message_class,
    refuse_rivals,
)
from shipcrane_twin.ros.parameters import declare, declare_run_parameters
from shipcrane_twin.ros.process import leave_graph, write_json, write_result
from shipcrane_twin.ros.stop import StopFlag
from shipcrane_twin.ros.subsystem_node import SERVICE_PERIOD_S, done_topics, step_listeners

STATUS_PERIOD_S = 0.25
DIAGNOSTICS_PERIOD_S = 1.0

CATCH_UP_S = 1.5
"""Wall time that a clock which was told to stop gives the recorder."""

_NO_VALUES = np.empty(0)


class ClockNode:
    """The lockstep's clock.

    Parameters
    ----------
    stop : StopFlag
    """

    def __init__(self, stop: StopFlag) -> None:
        self._stop = stop
        self.node = Node("clock")
        run = declare_run_parameters(self.node)
        scenario = load_scenario(run.scenario)
        speed = declare(
            self.node, "speed", scenario.lockstep.speed, "Times real time; 0 is as fast as it goes", live=True
        )
        self._run_dir = run.run_dir
        self._silence_s = scenario.lockstep.silence_timeout_s
        self._step_ns = scenario.step_ns
        self._lockstep = Lockstep(
            SCHEMES[scenario.coupling],
            scenario.step_count,
            scenario.lockstep.run_ahead_steps,
            run.recorded,
            chain_of(scenario),
            inputs_of(scenario),
            {topic.name: topic for topic in topics_of(scenario)},
        )
        self._pace = Pace(scenario.step_ns / 1e9, speed)

        group = LoopOwned()
        self._inboxes = {name: Inbox(self.node, topic, group) for name, topic in done_topics(scenario).items()}
        self._recorder = Inbox(self.node, BY_NAME["/recorder/progress"], group)
        self._mail = Mailroom(self.node, [*self._inboxes.values(), self._recorder])
        clock = BY_NAME["/clock"]
        self._template = Template(clock)
        self._publisher = self.node.create_publisher(message_class(clock.type), clock.name, LOOP_QOS)
        self._diagnostics = self.node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._expected = step_listeners(scenario, run.recorded)
        self.node.create_service(SetBool, "/clock/pause", self._serve_pause)
        self.node.create_service(Trigger, "/clock/step", self._serve_step)
        self.node.add_on_set_parameters_callback(self._serve_speed)
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)

        self._state = "waiting for nodes"
        self._silent: list[str] = []
        self._began = self._service_at = self._status_at = self._diagnostics_at = 0.0
        self._rate_from = (0.0, 0)
        self._rate = 0.0
        self._worst_s = 0.0
        self._progress_at = 0.0

    def run(self) -> None:
        """Announce time until the end of the scenario."""
        self._stop.arm()
        self._connect()
        if self._stop:
            return
        lockstep = self._lockstep
        now = time.monotonic()
        self._began = self._progress_at = now
        self._rate_from = (now, 0)
        self._pace.restart(0, now)
        cpu_from = time.process_time()
        self._state = "running"
        self._announce(0)
        while not self._stop and not lockstep.finished:
            before, recorded_before = lockstep.slowest, lockstep.recorded_to
            # the load has finished a step only when all before it have; controllers only the load
            self._mail.wait(
                self._pace.wait_s(lockstep.announced, now, SERVICE_PERIOD_S), only=self._inboxes[lockstep.last_behind]
            )
            self._hear()
            now = time.monotonic()
            if lockstep.waits_for_recorder:
                idle = lockstep.recorded_to > recorded_before
            else:
                idle = lockstep.slowest >= lockstep.announced
            if lockstep.slowest > before or idle:
                self._worst_s = max(self._worst_s, now - self._progress_at) if lockstep.slowest > 0 else 0.0
                self._progress_at = now
                self._silent = []
            self._announce(self._pace.due(lockstep.announced, lockstep.may_announce(), now))
            if now > self._service_at:
                self._attend(now)
        if self._stop:
            self._let_recorder_catch_up()
        now = time.monotonic()
        self._state = "done" if lockstep.finished else "stopped"
        self._tell(now)
        write_result(
            self._run_dir,
            "clock",
            {
                "steps": lockstep.slowest,
                "wall_time_s": now - self._began,
                "worst_step_s": self._worst_s,
                "cpu_s": time.process_time() - cpu_from,
            },
        )

    def close(self) -> None:
        """Leave the graph."""
        leave_graph(self.node)

    def _let_recorder_catch_up(self) -> None:
        """Wait until all that was done is recorded: what a node published cannot be sent again without it."""
        limit = time.monotonic() + CATCH_UP_S
        while self._lockstep.recorded and self._lockstep.recorded_to < self._lockstep.slowest:
            left_s = limit - time.monotonic()
            if left_s <= 0.0:
                return
            self._mail.wait(left_s, only=self._recorder)
            self._hear()

    def _connect(self) -> None:
        while not self._stop:
            missing = listeners_matched(self.node, {"/clock": self._publisher}, self._expected)
            missing += [
                f"{name} ({inbox.topic.name})"
                for name, inbox in self._inboxes.items()
                if not inbox.subscription.get_publisher_count()
            ]
            if self._lockstep.recorded and not self._recorder.subscription.get_publisher_count():
                missing.append("recorder (/recorder/progress)")
            if not missing:
                done = [inbox.topic.name for inbox in self._inboxes.values()]
                refuse_rivals(self.node, ["/clock", *done, "/recorder/progress"])
                self._silent = []
                return
            self._silent = sorted({text.split()[0] for text in missing})
            self._executor.spin_once(timeout_sec=0.02)
            now = time.monotonic()
            if now > self._status_at:
                self._tell(now)

    def _hear(self) -> None:
        """Take in how far everyone has come."""
        lockstep = self._lockstep
        for name, inbox in self._inboxes.items():
            lockstep.done[name] = max(lockstep.done[name], self._progress(inbox))
        lockstep.recorded_to = max(lockstep.recorded_to, self._progress(self._recorder))

    def _progress(self, inbox: Inbox) -> int:
        while inbox.keep():
            pass
        progress = progress_of(inbox.waiting, self._step_ns)
        inbox.waiting.clear()
        return progress

    def _announce(self, upto: int) -> None:
        for step in range(self._lockstep.announced + 1, upto + 1):
            self._publisher.publish(self._template.encode(step * self._step_ns, _NO_VALUES))
            self._lockstep.announced = step

    def _attend(self, now: float) -> None:
        """Do what is due by the wall clock: services, silence, status, diagnostics."""
        self._executor.spin_once(timeout_sec=0.0)
        self._service_at = now + SERVICE_PERIOD_S
        if now - self._progress_at > self._silence_s and not self._silent:
            self._silent = self._lockstep.silent()
            if self._silent:
                self.node.get_logger().error(
                    f"no answer from {', '.join(self._silent)} for {self._silence_s:g} s at simulated time "
                    f"{(self._lockstep.slowest + 1) * self._step_ns / 1e9:.3f} s; the run waits"
                )
        if now > self._status_at:
            self._tell(now)

    def _tell(self, now: float) -> None:
        """Write the status file for the supervisor and publish diagnostics."""
        self._status_at = now + STATUS_PERIOD_S
        steps = self._lockstep.slowest
        since, from_step = self._rate_from
        if now - since > 1.0 and self._state == "running":
            self._rate = (steps - from_step) * self._step_ns / 1e9 / (now - since)
            self._rate_from = (now, steps)
        state = "silent" if self._silent and self._state == "running" else self._state
        if self._pace.paused and state == "running":
            state = "paused"
        status = {
            "state": state,
            "time_s": max(steps, 0) * self._step_ns / 1e9,
            "real_time_factor": self._rate,
            "silent": self._silent,
        }
        if self._run_dir:
            write_json(Path(self._run_dir) / "status.json", status)
        if now > self._diagnostics_at or state == "done":
            self._diagnostics_at = now + DIAGNOSTICS_PERIOD_S
            self._publish_diagnostics(status)

    def _publish_diagnostics(self, status: dict[str, object]) -> None:
        message = DiagnosticArray()
        sec, nanosec = stamp_parts(max(self._lockstep.slowest, 0) * self._step_ns)
        message.header.stamp.sec, message.header.stamp.nanosec = sec, nanosec
        level = DiagnosticStatus.ERROR if self._silent else DiagnosticStatus.OK
        values = {**status, "worst_step_s": f"{self._worst_s:.4f}"}
        message.status = [
            DiagnosticStatus(
                level=level,
                name="clock: lockstep",
                message=str(status["state"]),
                values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
            )
        ]
        self._diagnostics.publish(message)

    def _serve_pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self._pace.paused = request.data
        self._pace.single_steps = 0
        self._pace.restart(self._lockstep.announced, time.monotonic())
        response.success = True
        response.message = f"{'paused' if request.data else 'running'} at step {self._lockstep.announced}"
        return response

    def _serve_step(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success = self._pace.paused
        if self._pace.paused:
            self._pace.single_steps += 1
            response.message = f"step {self._lockstep.announced + 1}"
        else:
            response.message = "the clock is running; pause it first with /clock/pause"
        return response

    def _serve_speed(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            if parameter.name == "speed":
                if not 0.0 <= parameter.value < float("inf"):
                    return SetParametersResult(
                        successful=False, reason=f"speed is {parameter.value}, expected 0 (as fast as it goes) or more"
                    )
                self._pace.speed = parameter.value
                self._pace.restart(self._lockstep.announced, time.monotonic())
        return SetParametersResult(successful=True)

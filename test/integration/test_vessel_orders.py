"""The vessel in the hands of an operator: DP's switch, set-points, faults; what it refuses, tells and records."""

import json
import struct
import time

import pytest
from graph_runs import (
    cli_run,
    free_domain,
    needs_ros,
    operator_in,
    run_graph,
    start_node_alone,
    wait_until,
    write_lively,
)
from rosbags.highlevel import AnyReader

from shipcrane_twin.cosim.time import seconds

pytestmark = needs_ros

ORDERS, DIAGNOSTICS = "/vessel/orders", "/diagnostics"
OK, WARN = 0, 1
NAN = float("nan")
EAST = [0.0, 0.0, 0.0, 1.0]
PATIENCE_S = 8.0


class Desk:
    """A run without end, an operator, and what the vessel has answered."""

    def __init__(self, run, operator):
        self.run, self.operator = run, operator

    def orders(self):
        """Return what has been ordered so far: what and with which values."""
        return [[what, values] for _, _, _, what, values in self.operator.statuses(topic=ORDERS)]

    def dp(self):
        """Return level, message and values of the vessel's last report."""
        found = [rest for _, *rest in self.operator.statuses(topic=DIAGNOSTICS) if rest[1] == "vessel: condition"]
        return (found[-1][0], *found[-1][2:]) if found else (None, "", {})

    def log(self):
        return (self.run.folder / "log" / "vessel.log").read_text()

    def runs_on(self):
        before = self.run.status()["time_s"]
        wait_until(lambda: self.run.status()["time_s"] > before, PATIENCE_S)
        return self.run.process.poll() is None

    def wait_for(self, condition):
        return wait_until(condition, PATIENCE_S)


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("orders")
    scenario = write_lively(folder, duration_s=10000.0, events=[], operations=[])
    with cli_run(folder / "run", scenario, "--speed", "1", "--no-record") as run, operator_in(run.domain) as operator:
        for topic in (ORDERS, DIAGNOSTICS):
            operator.listen_for_status(topic=topic)
        run.wait_for_time(2.5)
        found = Desk(run, operator)
        found.wait_for(lambda: found.dp()[0] == OK and found.dp()[2]["dp"] == "on")
        yield found


def test_dp_is_switched_off_and_on_and_the_report_says_so(desk):
    for data, word in ((False, "off"), (True, "on")):
        done, message = desk.operator.enable(data=data)
        assert done
        assert message.startswith(f"DP is {word} from ")
        desk.wait_for(lambda word=word: desk.orders()[-1:] == [[f"dp_{word}", {}]])
        desk.wait_for(lambda word=word: desk.dp()[2]["dp"] == word)


def test_a_set_point_is_taken_and_the_report_tells_the_distance(desk):
    desk.operator.move_to(place=[500.0, 0.0], quat=EAST)
    desk.wait_for(lambda: [what for what, _ in desk.orders()[-1:]] == ["setpoint"])
    assert desk.orders()[-1][1] == {"north_m": "0.0", "east_m": "500.0", "heading_deg": "90.0"}
    desk.wait_for(lambda: float(desk.dp()[2]["position_error_m"]) > 400.0)
    assert float(desk.dp()[2]["heading_error_deg"]) > 45.0
    desk.operator.move_to(place=[0.0, 0.0], quat=[0.0, 0.0, 0.5**0.5, 0.5**0.5], frame="")
    desk.wait_for(lambda: float(desk.dp()[2]["position_error_m"]) < 50.0)
    assert float(desk.orders()[-1][1]["heading_deg"]) == pytest.approx(0.0, abs=1e-9)


HEADER = b"\x00\x01\x00\x00" + bytes(8)
WRONG = {
    "no number": ({"place": [NAN, 0.0], "quat": EAST}, "expected finite numbers"),
    "infinite": ({"place": [0.0, float("inf")], "quat": EAST}, "expected finite numbers"),
    "no rotation": ({"place": [7.0, 7.0], "quat": [0.0] * 4}, "a quaternion of length 1"),
    "too long a quaternion": ({"place": [7.0, 7.0], "quat": [0.0, 0.0, 0.0, 2.0]}, "a quaternion of length 1"),
    "rotation no number": ({"place": [7.0, 7.0], "quat": [0.0, 0.0, NAN, 1.0]}, "expected finite numbers"),
    "another frame": ({"place": [7.0, 7.0], "quat": EAST, "frame": "base_link"}, "'base_link', expected 'map'"),
    "nothing": ("00010000", "not a PoseStamped"),
    "noise": ((b"\x00\x01\x00\x00" + b"\xff" * 80).hex(), "not a PoseStamped"),
    "cut short": ((HEADER + struct.pack("<I", 4) + b"map\0" + bytes(30)).hex(), "not a PoseStamped"),
    "frame not text": ((HEADER + struct.pack("<I", 4) + b"\xfe\xfe\xfe\0" + bytes(56)).hex(), "not a PoseStamped"),
}


@pytest.mark.parametrize("kind", WRONG)
def test_a_wrong_set_point_is_refused_with_a_warning_and_changes_nothing(kind, desk):
    message, reason = WRONG[kind]
    time.sleep(1.1)  # a node warns once a second
    orders, length = desk.orders(), len(desk.log())
    if isinstance(message, str):
        desk.operator.move_to_bytes(text=message)
    else:
        desk.operator.move_to(**message)
    said = desk.wait_for(lambda: desk.log()[length:])
    assert "/dp/setpoint refused: " in said
    assert reason in said
    assert desk.runs_on()
    assert desk.orders() == orders


BROKEN = {
    "fault.bow_tunnel": ("failed", "none", "thruster bow_tunnel: failed"),
    "fault.azimuth_port": ("limited 0.4", "none", "thruster azimuth_port: limited to 40 %"),
    "fault.gyro": ("drop_out", "none", "sensor gyro: drop out"),
    "power_share": (0.25, 1.0, "power limited to 25 %"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_fault_is_taken_told_and_repaired(name, desk):
    value, repaired, told = BROKEN[name]
    assert desk.operator.set(node="vessel", name=name, value=value) == [True, ""]
    level = desk.wait_for(lambda: told in desk.dp()[1] and desk.dp())[0]
    assert level == WARN
    what, values = desk.orders()[-1]
    assert what == {"fault.gyro": "sensor_fault", "power_share": "power_limit"}.get(name, "thruster_fault")
    assert values.get("which", "power_share") == name.removeprefix("fault.")
    assert desk.operator.set(node="vessel", name=name, value=repaired) == [True, ""]
    desk.wait_for(lambda: told not in desk.dp()[1])
    assert desk.runs_on()


REFUSED = {
    "no such fault": ("fault.bow_tunnel", "burnt", "fault is 'burnt', expected "),
    "fault of a sensor": ("fault.bow_tunnel", "drop_out", "expected one of none, failed, frozen, limited, runaway"),
    "fault of a thruster": ("fault.gyro", "runaway", "expected one of none, drop_out, frozen"),
    "limit without a share": ("fault.azimuth_port", "limited", "expected a share"),
    "share without a limit": ("fault.azimuth_port", "failed 0.5", "share: expected none"),
    "too great a share": ("fault.azimuth_port", "limited 1.5", "share is 1.5, expected less than or equal to 1"),
    "share no number": ("fault.azimuth_port", "limited half", "could not convert"),
    "share not finite": ("fault.azimuth_port", "limited nan", "share is nan, expected a finite number"),
    "nothing": ("fault.mru", "", "fault is '', expected "),
    "power below zero": ("power_share", -0.1, "share is -0.1, expected greater than or equal to 0"),
    "power no number": ("power_share", NAN, "expected a finite number"),
    "wrong type": ("fault.bow_tunnel", 3, ""),
    "whole number": ("power_share", 1, ""),
    "unset": ("fault.bow_tunnel", None, ""),
    "unknown": ("fault.rudder", "failed", ""),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_a_wrong_fault_is_refused_with_a_reason_and_changes_nothing(kind, desk):
    name, value, said = REFUSED[kind]
    orders = desk.orders()
    done, reason = desk.operator.set(node="vessel", name=name, value=value)
    assert not done
    assert said in reason
    assert reason
    assert "\n" not in reason
    assert desk.runs_on()
    assert desk.orders() == orders


def test_a_fault_given_at_the_start_is_refused_with_the_remedy(tmp_path):

    alone = start_node_alone("vessel", tmp_path, free_domain(), **{"fault.bow_tunnel": "failed"})
    assert alone.wait(90) == 2
    said = (tmp_path / "vessel.log").read_text()
    assert "fault.bow_tunnel is 'failed' at the start, expected 'none'" in said
    assert "an event of the scenario" in said


def test_recorded_orders_put_into_the_scenario_repeat_the_run(tmp_path):
    scenario = write_lively(tmp_path, duration_s=12.0)

    domain = free_domain()
    said = []
    with operator_in(domain) as operator:
        acts = [
            lambda: operator.move_to(place=[3.0, 4.0], quat=[0.0, 0.0, 0.6, 0.8]),
            lambda: operator.set(node="vessel", name="fault.bow_tunnel", value="limited 0.5"),
            lambda: operator.enable(data=False),
        ]

        def act(status):
            if len(said) < len(acts) and status["time_s"] > 3.0 + 2.0 * len(said):
                acts[len(said)]()
                said.append(status["time_s"])

        operator.topics()  # it is up before the run begins
        slowed = ["lockstep.speed=2.0"]
        digest = run_graph(
            tmp_path / "run", scenario, overrides=slowed, domain=domain, record=True, progress=act
        )
    with AnyReader([tmp_path / "run" / "bag"]) as reader:
        connections = [found for found in reader.connections if found.topic == ORDERS]
        orders = [reader.deserialize(raw, one.msgtype) for one, _, raw in reader.messages(connections)]
        asked = [found for found in reader.connections if found.topic == "/dp/setpoint"]
        assert len(list(reader.messages(asked))) == 1
    assert len(orders) == 3
    points, events = [], [{"label": "off", "at_s": 17.0, "event": "release_payload"}]
    for order in orders:
        stamp, status = order.header.stamp, order.status[0]
        at_s = seconds(stamp.sec * 10**9 + stamp.nanosec)
        values = {pair.key: number_or_text(pair.value) for pair in status.values}
        if status.message == "setpoint":
            points.append({"at_s": at_s, **values})
        else:
            events.append({"label": "ordered", "at_s": at_s, "event": status.message, **values})
    assert [event["event"] for event in events[1:]] == ["thruster_fault", "dp_off"]
    again = [f"dp.setpoints={json.dumps(points)}", f"events={json.dumps(events)}"]
    assert run_graph(tmp_path / "again", scenario, overrides=again) == digest
    assert run_graph(tmp_path / "other", scenario) != digest


def number_or_text(text):
    try:
        return float(text)
    except ValueError:
        return text

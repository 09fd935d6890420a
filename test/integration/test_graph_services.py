"""A running graph in the hands of an operator: pause, single steps, speed, joint commands, garbage."""

import struct
import time

import numpy as np
import pytest
from graph_runs import NODES, cli_run, free_domain, needs_ros, operator_in, run_graph, wait_until, write_lively
from rosbags.highlevel import AnyReader

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.record.read import read_signals

pytestmark = needs_ros

STEP_NS = 20_000_000
HEARD = {"/clock": "rosgraph_msgs/msg/Clock", "/payload/odom": "nav_msgs/msg/Odometry"}
WARNING_PAUSE_S = 1.1  # a node warns once a second


class Live:
    """A run without end, and who operates it."""

    def __init__(self, run, operator):
        self.run, self.operator = run, operator

    def steps(self):
        """Return the last step that the clock has announced and the load has finished, as a listener hears it."""
        return [self.operator.stamps(topic=topic)[-1] // STEP_NS for topic in HEARD]

    def time_s(self):
        return self.steps()[-1] * STEP_NS / 1e9

    def log(self, name):
        return (self.run.folder / "log" / f"{name}.log").read_text()

    def runs_on(self):
        before = self.steps()[-1]
        wait_until(lambda: self.steps()[-1] > before, patience_s=5.0)
        return self.run.process.poll() is None


@pytest.fixture(scope="module")
def shared_live(tmp_path_factory):
    folder = tmp_path_factory.mktemp("live")
    scenario = write_lively(folder, duration_s=10000.0)
    with cli_run(folder / "run", scenario, "--speed", "1", "--no-record") as run, operator_in(run.domain) as operator:
        for topic, kind in HEARD.items():
            operator.listen(topic=topic, kind=kind)
        run.wait_for_time(0.1)
        wait_until(lambda: all(operator.stamps(topic=topic) for topic in HEARD))
        yield Live(run, operator)


@pytest.fixture
def live(shared_live):
    """Return the run, going at real-time speed."""
    assert shared_live.operator.set(node="clock", name="speed", value=1.0) == [True, ""]
    shared_live.operator.pause(data=False)
    return shared_live


def test_pause_stops_at_a_whole_step_and_step_gives_exactly_one_more(live):
    done, message = live.operator.pause(data=True)
    assert done
    step = int(message.removeprefix("paused at step "))
    wait_until(lambda: live.steps() == [step, step], patience_s=5.0)
    for more in (1, 2, 3):
        assert live.operator.step() == [True, f"step {step + more}"]
        wait_until(lambda more=more: live.steps() == [step + more, step + more], patience_s=5.0)
        time.sleep(0.3)
        assert live.steps() == [step + more, step + more]
    assert wait_until(lambda: live.run.status()["state"] == "paused", patience_s=1.0)
    live.operator.pause(data=False)
    assert live.runs_on()


def test_a_running_clock_does_no_single_steps(live):
    done, message = live.operator.step()
    assert not done
    assert "pause it first" in message


def keeps_pace(live, speed):
    """Whether the run keeps its speed over a second and a half, some time when the machine lets it."""

    def kept():
        before, began = live.time_s(), time.monotonic()
        time.sleep(1.5)
        return (live.time_s() - before) / (time.monotonic() - began) == pytest.approx(speed, rel=0.15)

    return wait_until(kept, patience_s=20.0)


def test_speed_one_is_real_time(live):
    assert keeps_pace(live, 1.0)


def test_speed_can_be_changed_while_it_runs(live):
    assert live.operator.set(node="clock", name="speed", value=4.0) == [True, ""]
    assert keeps_pace(live, 4.0)


@pytest.mark.parametrize("value", [-1.0, float("inf"), float("nan"), "fast", 2])
def test_a_wrong_speed_is_refused_with_a_reason(value, live):
    done, reason = live.operator.set(node="clock", name="speed", value=value)
    assert not done
    assert "expected" in reason


@pytest.mark.parametrize("node", NODES[:-2])
@pytest.mark.parametrize("name", ["scenario", "run_dir", "recorded"])
def test_what_a_node_was_told_at_its_start_cannot_be_changed(node, name, live):
    done, reason = live.operator.set(node=node, name=name, value="other")
    assert not done
    assert "read-only" in reason or "type" in reason


def joint_state(names, velocities):
    """Return a serialized JointState without positions and efforts."""
    out = bytearray(b"\x00\x01\x00\x00" + bytes(8) + struct.pack("<I", 1) + b"\0")
    out += bytes(-len(out) % 4) + struct.pack("<I", len(names))
    for name in names:
        raw = name.encode() + b"\0"
        out += bytes(-len(out) % 4) + struct.pack("<I", len(raw)) + raw
    out += bytes(-len(out) % 4) + struct.pack("<II", 0, len(velocities))
    if velocities:
        out += bytes(-(len(out) - 4) % 8) + struct.pack(f"<{len(velocities)}d", *velocities)
    return bytes(out + struct.pack("<I", 0))


WRONG = {
    "not a number": (joint_state(["boom"], [float("nan")]), "velocities [nan]; expected finite numbers"),
    "infinite": (joint_state(["winch", "boom"], [0.0, float("inf")]), "velocities [0.0, inf]; expected finite numbers"),
    "too few velocities": (joint_state(["boom", "slew"], [0.1]), "2 names but 1 velocities"),
    "positions only": (joint_state(["boom"], []), "1 names but 0 velocities"),
    "unknown joint": (joint_state(["boom", "elbow"], [0.1, 0.1]), "joint 'elbow' is unknown, expected some of slew"),
    "nothing": (b"\x00\x01\x00\x00", "not a JointState"),
    "noise": (b"\x00\x01\x00\x00" + b"\xff" * 64, "not a JointState"),
    "cut short": (joint_state(["boom"], [0.1])[:-10], "not a JointState"),
    "without its end": (joint_state(["boom"], [0.1])[:-4], "not a JointState"),
    "name not text": (joint_state(["boom"], [0.1]).replace(b"boom", b"\xfe\xfe\xfe\xfe"), "not a JointState"),
}


@pytest.mark.parametrize("kind", WRONG)
def test_a_wrong_command_is_refused_with_a_warning_and_harms_nobody(kind, live):
    raw, reason = WRONG[kind]
    time.sleep(WARNING_PAUSE_S)
    before = {name: len(live.log(name)) for name in ("crane", "payload")}
    live.operator.say_bytes(text=raw.hex())
    for name, length in before.items():
        text = wait_until(lambda name=name, length=length: live.log(name)[length:], patience_s=5.0)
        assert f"/crane/joint_command refused: {reason}" in text
    assert live.runs_on()


DECODABLE = sum("not a JointState" not in reason for _, reason in WRONG.values())


def commands(bag):
    """Return names, velocities and log time [s] of every command in a bag."""
    with AnyReader([bag]) as reader:
        connections = [found for found in reader.connections if found.topic == "/crane/joint_command"]
        read = [(reader.deserialize(raw, one.msgtype), log_ns) for one, log_ns, raw in reader.messages(connections)]
    return [(message.name, list(message.velocity), log_ns / 1e9) for message, log_ns in read]


def test_an_operators_command_moves_boom_and_winch_and_is_in_the_bag(tmp_path):
    scenario = write_lively(tmp_path, operations=[], events=[])
    domain = free_domain()
    said = []
    with operator_in(domain) as operator:

        def command(status):
            if status["time_s"] > 4.0 and len(said) == 0:
                for raw, _ in WRONG.values():
                    operator.say_bytes(text=raw.hex())
                operator.say(names=["boom", "winch"], velocities=[0.02, 0.1], stamp=[1795000000, 7])
                said.append(status["time_s"])
            if status["time_s"] > 10.0 and len(said) == 1:
                operator.say(names=["winch", "boom"], velocities=[0.0, 0.0], stamp=[-5, 0])
                said.append(status["time_s"])

        operator.topics()  # it is up before the run begins
        run_graph(
            tmp_path / "run",
            scenario,
            overrides=["lockstep.speed=5.0"],
            domain=domain,
            record=True,
            progress=command,
        )
    heard = commands(tmp_path / "run" / "bag")
    assert len(heard) == DECODABLE + 2
    assert [names for names, _, _ in heard[-2:]] == [["boom", "winch"], ["winch", "boom"]]
    # the operator's own stamps are anything; the log has simulated time
    for (_, _, log_s), about_s in zip(heard[-2:], said, strict=True):
        assert about_s - 0.5 < log_s < about_s + 3.0

    signals = read_signals(tmp_path / "run" / "bag")
    assert signals.series["/clock"].log_ns[-1] == load_scenario(str(scenario)).step_count * 20_000_000

    applied = signals.joints["/crane/joint_command_applied"]
    boom = applied.velocity[:, applied.names.index("boom")]
    moving_s = applied.stamp_ns[boom != 0.0] / 1e9
    assert set(boom) == {0.0, 0.02}
    assert said[0] < moving_s[0] < said[0] + 3.0
    paid = signals.joints["/winch/joint_command_applied"].velocity[:, 0]
    # crane and payload take a free operator's word each at its own next step, so nearly at the same time
    assert set(paid) == {0.0, 0.1}
    assert np.count_nonzero(paid != 5.0 * boom) <= 2 * len(said)

    joints, winch = signals.joints["/crane/joint_states"], signals.joints["/winch/joint_states"]
    span_s = moving_s[-1] - moving_s[0]
    lifted = np.ptp(joints.position[:, joints.names.index("boom")])
    assert lifted == pytest.approx(0.02 * span_s, rel=0.25)
    assert np.ptp(winch.position[:, 0]) == pytest.approx(0.1 * span_s, rel=0.25)


def test_an_operator_sends_the_winch_to_a_length_and_moves_the_tip(tmp_path):
    scenario = write_lively(tmp_path, operations=[], events=[])
    domain = free_domain()
    said = {}
    with operator_in(domain) as operator:

        def command(status):
            now = status["time_s"]
            if now > 3.0 and "winch" not in said:
                said["winch"] = now
                operator.place(names=["winch"], positions=[1.6])
                operator.move_tip(velocity=[0.0, 0.0, 0.1], frame="base_link")
            if now > 5.0 and "tip" not in said:
                said["tip"] = now
                operator.move_tip(velocity=[0.0, 0.0, 0.1], frame="crane_base")

        operator.topics()  # it is up before the run begins
        run_graph(
            tmp_path / "run",
            scenario,
            overrides=["lockstep.speed=5.0", "crane.servo.tip_command_timeout_s=4.0"],
            domain=domain,
            record=True,
            progress=command,
        )
    log = (tmp_path / "run" / "log" / "crane.log").read_text()
    assert log.count("/crane/tip_command refused: its frame is 'base_link', expected crane_base or map") == 1

    signals = read_signals(tmp_path / "run" / "bag")
    length = signals.joints["/winch/joint_states"].position[:, 0]
    assert length[0] == 1.0
    assert length[-1] == pytest.approx(1.6, abs=1e-3)
    applied = signals.joints["/crane/joint_command_applied"]
    moving_s = applied.stamp_ns[np.abs(applied.velocity).max(axis=1) > 0.0] / 1e9
    assert said["tip"] < moving_s[0] < said["tip"] + 3.0
    assert np.ptp(moving_s) == pytest.approx(4.0, abs=0.15)

"""Bags made by rosbags' own writer from closed-form signals, for tests of reading and reporting."""

import json
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
import yaml
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.spatial.transform import Rotation

from shipcrane_twin.cosim.topics import ACCEL, CLOCK, CLOUD, IMU, INERTIA, JOINTS, ODOMETRY, POSE, TOPICS, TWIST, WRENCH

STORE = get_typestore(Stores.ROS2_JAZZY)
HOT_MS, TELEMETRY_MS = 20, 100
COG_M, DRAUGHT_M = (15.516, 0.0, 3.624), 2.6


def make(msgtype, **fields):
    return STORE.types[msgtype](**fields)


def stamp(time_ns):
    return make("builtin_interfaces/msg/Time", sec=time_ns // 10**9, nanosec=time_ns % 10**9)


def header(time_ns, frame="map"):
    return make("std_msgs/msg/Header", stamp=stamp(time_ns), frame_id=frame)


def vector(xyz):
    return make("geometry_msgs/msg/Vector3", **dict(zip("xyz", map(float, xyz), strict=True)))


def pose(numbers):
    point = make("geometry_msgs/msg/Point", **dict(zip("xyz", map(float, numbers[:3]), strict=True)))
    turn = make("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", map(float, numbers[3:]), strict=True)))
    return make("geometry_msgs/msg/Pose", position=point, orientation=turn)


def odometry(time_ns, numbers, child="base_link"):
    zeros = np.zeros(36)
    twist = make("geometry_msgs/msg/Twist", linear=vector(numbers[7:10]), angular=vector(numbers[10:13]))
    return make(
        "nav_msgs/msg/Odometry",
        header=header(time_ns),
        child_frame_id=child,
        pose=make("geometry_msgs/msg/PoseWithCovariance", pose=pose(numbers[:7]), covariance=zeros),
        twist=make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=zeros),
    )


def clock(time_ns, _numbers=()):
    return make("rosgraph_msgs/msg/Clock", clock=stamp(time_ns))


def stamped(msgtype, attribute, frame):
    """Return a builder for TwistStamped, AccelStamped, WrenchStamped: two vectors under one attribute."""

    def build(time_ns, numbers):
        first, second = ("force", "torque") if attribute == "wrench" else ("linear", "angular")
        parts = {first: vector(numbers[:3]), second: vector(numbers[3:])}
        inner = make(f"geometry_msgs/msg/{attribute.capitalize()}", **parts)
        return make(msgtype, header=header(time_ns, frame), **{attribute: inner})

    return build


def pose_stamped(time_ns, numbers):
    return make("geometry_msgs/msg/PoseStamped", header=header(time_ns), pose=pose(numbers))


def inertia_stamped(time_ns, numbers):
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    tensor = dict(zip(names, map(float, numbers[4:]), strict=True))
    inner = make("geometry_msgs/msg/Inertia", m=float(numbers[0]), com=vector(numbers[1:4]), **tensor)
    return make("geometry_msgs/msg/InertiaStamped", header=header(time_ns, "crane_base"), inertia=inner)


def joint_state(time_ns, names, position=(), velocity=(), effort=()):
    return make(
        "sensor_msgs/msg/JointState",
        header=header(time_ns, ""),
        name=list(names),
        position=np.array(position, dtype=float),
        velocity=np.array(velocity, dtype=float),
        effort=np.array(effort, dtype=float),
    )


def imu(time_ns, numbers):
    zeros = np.zeros(9)
    return make(
        "sensor_msgs/msg/Imu",
        header=header(time_ns, "mru"),
        orientation=make("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", map(float, numbers[:4]), strict=True))),
        orientation_covariance=zeros,
        angular_velocity=vector(numbers[4:7]),
        angular_velocity_covariance=zeros,
        linear_acceleration=vector(numbers[7:10]),
        linear_acceleration_covariance=zeros,
    )


def cloud(time_ns, numbers, names):
    """Return one point per row of columns (n, len(names)), or one point."""
    rows = np.reshape(numbers, (-1, len(names))).astype("<f8")
    columns = [
        make("sensor_msgs/msg/PointField", name=name, offset=8 * i, datatype=8, count=1) for i, name in enumerate(names)
    ]
    return make(
        "sensor_msgs/msg/PointCloud2",
        header=header(time_ns),
        height=1,
        width=len(rows),
        fields=columns,
        is_bigendian=False,
        point_step=8 * len(names),
        row_step=rows.nbytes,
        data=np.frombuffer(rows.tobytes(), dtype=np.uint8),
        is_dense=True,
    )


def builder(topic):
    """Return the function (time_ns, numbers) -> message for a row of the topic table."""
    if topic.type == JOINTS:

        def build(time_ns, numbers):
            parts = dict(zip(topic.fields, np.reshape(numbers, (len(topic.fields), -1)), strict=True))
            return joint_state(time_ns, topic.joints, **parts)

        return build
    return {
        CLOCK: clock,
        IMU: imu,
        CLOUD: partial(cloud, names=topic.fields),
        ODOMETRY: partial(odometry, child=topic.child_frame),
        POSE: pose_stamped,
        INERTIA: inertia_stamped,
        TWIST: stamped(TWIST, "twist", topic.frame),
        ACCEL: stamped(ACCEL, "accel", topic.frame),
        WRENCH: stamped(WRENCH, "wrench", topic.frame),
    }[topic.type]


def write_bag(bag_dir, topics, chunk_s=2.0, as_given=False):
    """Write ``topics``: name -> list of (log_ns, message); zstd chunks, topics interleaved in time."""
    rows = [(log_ns, name, message) for name, messages in topics.items() for log_ns, message in messages]
    if not as_given:
        rows.sort(key=lambda row: row[0])
    writer = Writer(bag_dir, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        connections = {
            name: writer.add_connection(name, messages[0][1].__msgtype__, typestore=STORE)
            for name, messages in topics.items()
            if messages
        }
        chunk_end = chunk_s * 1e9
        for log_ns, name, message in rows:
            if log_ns >= chunk_end:
                writer.storage.close_chunk()
                chunk_end += chunk_s * 1e9
            writer.write(connections[name], log_ns, STORE.serialize_cdr(message, message.__msgtype__))
    return Path(bag_dir)


@dataclass
class Lift:
    """A made-up lift whose every signal has a closed form; angles in deg as the report shows them."""

    duration_s: float = 20.0
    roll_deg: tuple[float, float, float] = (2.0, 0.5, 8.0)  # mean, amplitude, period
    pitch_deg: tuple[float, float, float] = (-0.3, 0.2, 5.0)
    heave_m: tuple[float, float, float] = (0.02, 0.1, 10.0)
    heading_deg: float = 30.0
    position_error_m: tuple[float, float] = (0.3, -0.4)  # north, east, held throughout
    tension_n: tuple[float, float, float] = (6865.0, 500.0, 4.0)
    sway_deg: float = 3.0
    setpoint: dict = field(default_factory=lambda: {"north_m": 10.0, "east_m": 5.0, "heading_deg": 30.0})
    wind_speed: float = 0.0

    def times_ns(self, period_ms):
        return np.arange(0, round(self.duration_s * 1000) + 1, period_ms, dtype=np.int64) * 1_000_000

    def wave(self, part, time_s):
        mean, amplitude, period = part
        return mean + amplitude * np.sin(2 * np.pi * time_s / period)

    def base_link(self, time_s):
        """Return position of the base_link origin, shape (n, 3), and attitude; the CoG keeps its distance."""
        yaw = np.full_like(time_s, 90.0 - self.heading_deg)
        angles = np.column_stack([yaw, -self.wave(self.pitch_deg, time_s), self.wave(self.roll_deg, time_s)])
        turn = Rotation.from_euler("ZYX", angles, degrees=True)
        goal = self.setpoint["east_m"], self.setpoint["north_m"], COG_M[2] - DRAUGHT_M
        away = np.tile((self.position_error_m[1], self.position_error_m[0], 0.0), (len(time_s), 1))
        away[:, 2] = self.wave(self.heave_m, time_s)
        return goal + away - turn.apply(COG_M), turn

    def tip_and_load(self, time_s):
        origin_w, turn = self.base_link(time_s)
        tip_w = origin_w + turn.apply((5.5, -7.0, 11.0))
        angle = np.deg2rad(self.sway_deg) * np.sin(2 * np.pi * time_s / 2.5)
        return tip_w, tip_w + np.column_stack([np.sin(angle), np.zeros_like(angle), -np.cos(angle)])

    def topics(self):
        hot, slow = self.times_ns(HOT_MS), self.times_ns(TELEMETRY_MS)
        time_s = hot * 1e-9
        origin_w, turn = self.base_link(time_s)
        tip_w, load_w = self.tip_and_load(time_s)
        still = np.tile([0, 0, 0, 1.0] + 6 * [0], (len(hot), 1))
        pull = np.zeros((len(hot), 6))
        pull[:, 2] = -self.wave(self.tension_n, time_s)
        base = pull * [0, 0, 1, 0, 0, 0]
        base[:, 2] -= 59077.0
        base[:, 3] = -5.0 * pull[:, 2]
        ramp = np.clip((slow * 1e-9 / self.duration_s - 0.4) / 0.3, 0, 1)
        arm = np.column_stack([-1.2 + 2.4 * ramp, 0.6 + 0.3 * ramp, 1.0 - 0.2 * ramp, 2.0 + 0 * ramp])
        signals = {
            "/environment/wind": np.tile([self.wind_speed, 0, 0, 0, 0, 0], (len(hot), 1)),
            "/vessel/odom": np.hstack([origin_w, turn.as_quat(), np.zeros((len(hot), 6))]),
            "/crane/tip": np.hstack([tip_w, still]),
            "/crane/base_wrench": base,
            "/crane/base_inertia": np.tile([6024, 0.5, -1, 2, 8e3, 1, 2, 9e3, 3, 7e3], (len(hot), 1)),
            "/payload/wire_wrench": pull,
            "/payload/odom": np.hstack([load_w, still]),
            "/crane/joint_states": np.hstack([arm, arm[:, :2], np.zeros((len(slow), 12))]),
            "/winch/joint_states": np.tile([1.0, 0.0, 6865.0], (len(slow), 1)),
        }
        result = {}
        for topic in TOPICS:
            if topic.rate == "irregular":
                continue
            times = {"step": hot, "telemetry": slow, "once": hot[:1]}[topic.rate]
            width = 0 if topic.type == CLOCK else len(topic.fields) if topic.type == CLOUD else topic.width
            rows = signals.get(topic.name, np.zeros((len(times), width)))
            build = builder(topic)
            result[topic.name] = [(int(t), build(int(t), row)) for t, row in zip(times, rows, strict=True)]
        return result

    def scenario(self):
        a, b = 0.4 * self.duration_s, 0.7 * self.duration_s
        return {
            "name": "made_up",
            "title": "A made-up lift <calm>",
            "seed": 7,
            "duration_s": self.duration_s,
            "macro_step_ms": HOT_MS,
            "telemetry_period_ms": TELEMETRY_MS,
            "vessel": {"cog_m": list(COG_M), "draught_m": DRAUGHT_M},
            "dp": {
                "enabled_at_s": 0.1 * self.duration_s,
                "settled_after_s": 0.2 * self.duration_s,
                "setpoint": dict(self.setpoint),
            },
            "operations": [
                {"from_s": a, "to_s": b, "joint": "slew", "label": "swing to port & land"},
                {"from_s": a, "to_s": 0.5 * (a + b), "joint": "boom", "label": "lift"},
            ],
            "events": [{"at_s": 0.9 * self.duration_s, "event": "release_payload", "label": "off-load"}],
        }


def write_run(run_dir, lift=None, drop=None):
    """Write a whole run directory; `drop` maps a topic to the indices of messages to leave out."""
    lift = lift or Lift()
    topics = lift.topics()
    for name, missing in (drop or {}).items():
        topics[name] = [row for k, row in enumerate(topics[name]) if k not in missing]
    run_dir = Path(run_dir)
    run_dir.mkdir(parents=True, exist_ok=True)
    write_bag(run_dir / "bag", topics)
    (run_dir / "scenario.yaml").write_text(yaml.safe_dump(lift.scenario(), sort_keys=False))
    summary = {"scenario": "made_up", "seed": 7, "mode": "inline", "real_time_factor": 321.5}
    (run_dir / "summary.json").write_text(json.dumps(summary))
    return run_dir

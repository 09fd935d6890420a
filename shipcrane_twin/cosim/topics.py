"""The topic table: the one place that says what is published, by whom, for whom, and in which layout.

A signal is a flat float64 array. Its columns by message type:

- Odometry: position (3), quaternion x y z w (4), linear (3) and angular velocity (3);
- PoseStamped: position (3), quaternion (4);
- TwistStamped, AccelStamped: linear (3), angular (3);
- WrenchStamped: force (3), torque (3);
- InertiaStamped: mass, CoM (3), xx xy xz yy yz zz;
- JointState: position, velocity and effort of all joints, those that the topic carries;
- Imu: quaternion x y z w (4), angular velocity (3), linear acceleration (3);
- PointCloud2: one row of named columns per point, any number of points.
"""

from dataclasses import dataclass
from typing import Literal

IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
POSE = "geometry_msgs/msg/PoseStamped"
TWIST = "geometry_msgs/msg/TwistStamped"
ACCEL = "geometry_msgs/msg/AccelStamped"
WRENCH = "geometry_msgs/msg/WrenchStamped"
INERTIA = "geometry_msgs/msg/InertiaStamped"
JOINTS = "sensor_msgs/msg/JointState"
CLOUD = "sensor_msgs/msg/PointCloud2"
CLOCK = "rosgraph_msgs/msg/Clock"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"

WIDTHS = {IMU: 10, ODOMETRY: 13, POSE: 7, TWIST: 6, ACCEL: 6, WRENCH: 6, INERTIA: 10}
JOINT_FIELDS = ("position", "velocity", "effort")

Rate = Literal["step", "telemetry", "once", "irregular"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Topic:
    """One topic.

    Attributes
    ----------
    name, type : str
        ROS name and message type.
    publisher : str
        The subsystem (or ``clock``, ``operator``) that publishes it.
    others : tuple of str
        Who publishes there besides.
    rate : str
        ``step``: every macro step; ``telemetry``: every telemetry period; ``once``: at t = 0, latched;
        ``irregular``.
    frame, child_frame : str
        Header frame and, for odometry, child frame.
    joints, fields : tuple of str
        For JointState: names, and which of position, velocity, effort are filled. For PointCloud2: the columns.
    about : str
        What it means, with units and reference point.
    """

    name: str
    type: str
    publisher: str
    about: str
    others: tuple[str, ...] = ()
    rate: Rate = "step"
    frame: str = ""
    child_frame: str = ""
    joints: tuple[str, ...] = ()
    fields: tuple[str, ...] = JOINT_FIELDS

    @property
    def width(self) -> int:
        """How many values a signal of this topic has."""
        return len(self.joints) * len(self.fields) if self.type == JOINTS else WIDTHS[self.type]


CRANE_JOINTS = ("slew", "boom", "knuckle", "telescope")
COMMAND_JOINTS = (*CRANE_JOINTS, "winch")
BOOM_CYLINDERS = ("boom_cylinder", "knuckle_cylinder")
THRUSTERS = ("azimuth_port", "azimuth_starboard", "bow_tunnel")

TOPICS: tuple[Topic, ...] = (
    Topic(
        name="/clock",
        type=CLOCK,
        publisher="clock",
        about="Simulated time up to which every participant may compute.",
    ),
    Topic(
        name="/environment/current",
        type=TWIST,
        publisher="environment",
        frame="map",
        about="Velocity of the water, ENU [m/s]; angular part zero.",
    ),
    Topic(
        name="/environment/wind",
        type=TWIST,
        publisher="environment",
        frame="map",
        about="Velocity of the air, ENU [m/s]; angular part zero.",
    ),
    Topic(
        name="/environment/sea_state",
        type=CLOUD,
        publisher="environment",
        rate="once",
        frame="map",
        fields=("amplitude", "omega", "number_x", "number_y", "phase"),
        about="Components of the sea; elevation: sum of amplitude cos(omega t - number x + phase); SI units.",
    ),
    Topic(
        name="/environment/wave_wrench",
        type=WRENCH,
        publisher="environment",
        frame="vessel_level",
        about="Wave load on the ship about its CoG, first-order and slow drift, level axes [N, N m].",
    ),
    Topic(
        name="/environment/wind_wrench",
        type=WRENCH,
        publisher="environment",
        frame="vessel_level",
        about="Wind load on the ship about its CoG, level axes [N, N m].",
    ),
    Topic(
        name="/vessel/odom",
        type=ODOMETRY,
        publisher="vessel",
        frame="map",
        child_frame="base_link",
        about="Pose of base_link; velocity of its origin and angular velocity, base_link axes [m, m/s, rad/s].",
    ),
    Topic(
        name="/vessel/accel",
        type=ACCEL,
        publisher="vessel",
        frame="base_link",
        about="Acceleration of base_link's origin (no gravity) and angular; base_link axes [m/s2, rad/s2].",
    ),
    Topic(
        name="/crane/tip",
        type=ODOMETRY,
        publisher="crane",
        frame="map",
        child_frame="crane_tip",
        about="Pose of the crane tip; velocities in crane_tip axes [m, m/s, rad/s].",
    ),
    Topic(
        name="/crane/base_wrench",
        type=WRENCH,
        publisher="crane",
        frame="crane_base",
        about="Crane and load on the ship at crane_base's origin, weight included, mean over the step [N, N m].",
    ),
    Topic(
        name="/crane/load_state",
        type=JOINTS,
        publisher="crane",
        frame="crane_base",
        joints=("radius", "safe_working_load", "hook_load", "utilisation", "cut_out"),
        fields=("position",),
        about="Load limiter: radius [m], safe working load there and hook load [kg], their ratio, 1 while cut out.",
    ),
    Topic(
        name="/crane/base_inertia",
        type=INERTIA,
        publisher="crane",
        frame="crane_base",
        about="The crane as one rigid body, joints frozen: mass, CoM, inertia about the CoM [kg, m, kg m2].",
    ),
    Topic(
        name="/payload/wire_wrench",
        type=WRENCH,
        publisher="payload",
        frame="map",
        about="Force of the wire on the crane tip, ENU axes, mean over the step [N]; torque zero.",
    ),
    Topic(
        name="/payload/felt_inertia",
        type=INERTIA,
        publisher="payload",
        frame="map",
        about="Mass of the load that the crane carries along the wire [kg]; zero while slack; the rest is zero.",
    ),
    Topic(
        name="/payload/odom",
        type=ODOMETRY,
        publisher="payload",
        frame="map",
        child_frame="payload",
        about="Position and velocity of the load; a point mass, so its axes stay those of map [m, m/s].",
    ),
    Topic(
        name="/vessel/pose",
        type=POSE,
        publisher="vessel",
        rate="telemetry",
        frame="map",
        about="Pose of base_link, as in /vessel/odom.",
    ),
    Topic(
        name="/vessel/imu",
        type=IMU,
        publisher="vessel",
        rate="telemetry",
        frame="mru",
        about="Motion reference unit as measured: attitude, rates, specific force in base_link axes [rad/s, m/s2].",
    ),
    Topic(
        name="/vessel/position_fix",
        type=POSE,
        publisher="vessel",
        rate="telemetry",
        frame="map",
        about="Last fix of the position reference's antenna (height zero) and last gyro heading.",
    ),
    Topic(
        name="/vessel/wind_sensor",
        type=TWIST,
        publisher="vessel",
        rate="telemetry",
        frame="base_link",
        about="Relative wind as measured, base_link axes [m/s]; angular part zero.",
    ),
    Topic(
        name="/dp/estimate",
        type=ODOMETRY,
        publisher="vessel",
        rate="telemetry",
        frame="map",
        child_frame="vessel_level",
        about="Observer: low-frequency pose of the CoG (height zero); surge, sway and yaw rate, the rest is zero.",
    ),
    Topic(
        name="/dp/bias",
        type=WRENCH,
        publisher="vessel",
        rate="telemetry",
        frame="vessel_level",
        about="Observer: estimated unknown load about the CoG, surge, sway, yaw [N, N m].",
    ),
    Topic(
        name="/dp/reference",
        type=POSE,
        publisher="vessel",
        rate="telemetry",
        frame="map",
        about="Reference position of the CoG (height zero) and heading, on its way to the set-point.",
    ),
    Topic(
        name="/dp/wrench",
        type=WRENCH,
        publisher="vessel",
        rate="telemetry",
        frame="vessel_level",
        about="Load that DP asks for about the CoG: surge, sway, yaw [N, N m]; zero while DP is off.",
    ),
    Topic(
        name="/thrusters/joint_states",
        type=JOINTS,
        publisher="vessel",
        rate="telemetry",
        frame="base_link",
        joints=THRUSTERS,
        about="Azimuth, anticlockwise from forward [rad], shaft speed [rad/s], thrust [N].",
    ),
    Topic(
        name="/crane/joint_states",
        type=JOINTS,
        publisher="crane",
        rate="telemetry",
        frame="crane_base",
        joints=(*CRANE_JOINTS, *BOOM_CYLINDERS),
        about="Joints [rad, m; rad/s, m/s; N m, N] and boom cylinders [m, m/s, N].",
    ),
    Topic(
        name="/crane/joint_command_applied",
        type=JOINTS,
        publisher="crane",
        rate="telemetry",
        frame="crane_base",
        joints=CRANE_JOINTS,
        fields=("position", "velocity"),
        about="What the joints were told in the step that ends now: a position to go to, or a velocity.",
    ),
    Topic(
        name="/winch/joint_states",
        type=JOINTS,
        publisher="payload",
        rate="telemetry",
        frame="crane_tip",
        joints=("winch",),
        about="Wire paid out [m], its rate [m/s], largest line pull in the step that ends now [N].",
    ),
    Topic(
        name="/winch/joint_command_applied",
        type=JOINTS,
        publisher="payload",
        rate="telemetry",
        frame="crane_tip",
        joints=("winch",),
        fields=("position", "velocity"),
        about="What the winch was told in the step that ends now: a paid-out length to go to [m], or a speed [m/s].",
    ),
    Topic(
        name="/crane/joint_command",
        type=JOINTS,
        publisher="operator",
        rate="irregular",
        joints=COMMAND_JOINTS,
        fields=("position", "velocity"),
        about="Velocity or position wanted of the named joints, held until the next message [rad/s, m/s; rad, m].",
    ),
    Topic(
        name="/crane/tip_command",
        type=TWIST,
        publisher="operator",
        rate="irregular",
        frame="crane_base",
        about="Linear velocity wanted of the tip against the ship, for a short time [m/s]; angular part not read.",
    ),
    Topic(
        name="/dp/setpoint",
        type=POSE,
        publisher="operator",
        rate="irregular",
        frame="map",
        about="Wanted position of the CoG (height is not read) and heading; replaces the scenario's set-points.",
    ),
    Topic(
        name="/vessel/orders",
        type=DIAGNOSTICS,
        publisher="vessel",
        rate="irregular",
        about="Every order that the vessel took, stamped with the start of the step in which it takes effect.",
    ),
    Topic(
        name="/recorder/progress",
        type=CLOCK,
        publisher="recorder",
        rate="irregular",
        about="Simulated time up to which the bag holds everything; the clock never runs far ahead of it.",
    ),
    Topic(
        name="/diagnostics",
        type=DIAGNOSTICS,
        publisher="clock",
        others=("crane", "payload", "vessel"),
        rate="irregular",
        about="State of the lockstep, DP, crane and load, once per second of wall time: who is silent, what is broken.",
    ),
)

BY_NAME = {topic.name: topic for topic in TOPICS}


def published_by(name: str, topics: tuple[Topic, ...] = TOPICS) -> tuple[Topic, ...]:
    """Return the topics of one publisher, in table order."""
    return tuple(topic for topic in topics if topic.publisher == name)

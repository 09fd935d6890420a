"""Where the vessel node takes orders: DP's switch and set-point, faults.

Orders are taken between steps and published on ``/vessel/orders`` with the start of the step in which they take effect.
A fault is an event of the scenario that happens now.
"""

from collections.abc import Iterable
from typing import TypeVar

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool

from shipcrane_twin.config.dp import SetpointConfig
from shipcrane_twin.config.scenario import SENSORS, EventConfig, wrong_keys
from shipcrane_twin.config.settings import ConfigError, plain, read_settings
from shipcrane_twin.cosim.participant import Participant
from shipcrane_twin.cosim.subsystems.vessel import Vessel
from shipcrane_twin.cosim.time import seconds
from shipcrane_twin.cosim.topics import POSE
from shipcrane_twin.physics.frames import euler_from_matrix, heading_from_yaw, matrix_from_quat
from shipcrane_twin.ros.cdr import CdrError, read_stamped
from shipcrane_twin.ros.diagnostics import pairs, stamped
from shipcrane_twin.ros.parameters import declare

WORLD = "map"
POWER = "power_share"
FAULT = "fault."

OrderT = TypeVar("OrderT", str, float)


class VesselDesk:
    """Topic, service and parameters by which a running vessel is told what to do.

    Parameters
    ----------
    node : Node
    participant : Participant
        The vessel's.
    step_ns : int
    """

    def __init__(self, node: Node, participant: Participant, step_ns: int) -> None:
        vessel = participant.subsystem
        assert isinstance(vessel, Vessel)
        self._node, self._participant, self._step_ns = node, participant, step_ns
        self._dp, self._thrusters = vessel.positioning, vessel.thruster_names
        self._orders = node.create_publisher(DiagnosticArray, "/vessel/orders", 10)
        # serialized, because what is no PoseStamped must not end the node
        node.create_subscription(PoseStamped, "/dp/setpoint", self._take_setpoint, 10, raw=True)
        node.create_service(SetBool, "/dp/enable", self._serve_enable)
        kinds = "none, failed, frozen, runaway or limited with a share (limited 0.5)"
        for name in self._thrusters:
            declare_order(node, FAULT + name, "none", f"Fault of this thruster: {kinds}")
        for name in SENSORS:
            declare_order(node, FAULT + name, "none", "Fault of this sensor: none, drop_out or frozen")
        declare_order(node, POWER, 1.0, "Share of the thrusters' total power that is left, 0 to 1")
        node.add_on_set_parameters_callback(self._check_parameters)
        node.add_post_set_parameters_callback(self._apply_parameters)

    @property
    def _now_ns(self) -> int:
        """Start of the next step."""
        return max(self._participant.step, 0) * self._step_ns

    def _take_setpoint(self, message: bytes) -> None:
        try:
            frame, (east, north, _, *quat) = read_stamped(message, POSE)
        except CdrError as err:
            self._refuse(str(err))
            return
        found = [east, north, *quat]
        if frame not in ("", WORLD):
            self._refuse(f"its frame is {frame!r}, expected {WORLD!r}")
        elif not np.isfinite(found).all() or abs(np.linalg.norm(quat) - 1.0) > 1e-3:
            self._refuse(f"x, y and quaternion are {found}, expected finite numbers and a quaternion of length 1")
        else:
            yaw = euler_from_matrix(matrix_from_quat(np.array(quat)))[2]
            point = SetpointConfig(north_m=north, east_m=east, heading_deg=heading_from_yaw(yaw))
            self._dp.move_to(point)
            self._note("setpoint", plain(point))

    def _refuse(self, why: str) -> None:
        self._node.get_logger().warn(f"/dp/setpoint refused: {why}", throttle_duration_sec=1.0)

    def _serve_enable(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self._order({"event": "dp_on" if request.data else "dp_off"})
        response.success = True
        response.message = f"DP is {'on' if request.data else 'off'} from {seconds(self._now_ns):g} s"
        return response

    def _check_parameters(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in ours(parameters):
            try:
                event = self._event(event_of(parameter, self._thrusters))
                wrong = [f"{key}: {advice}" for key, advice in wrong_keys(event, self._thrusters)]
            except ValueError as err:  # of the settings, or a share that is no number
                wrong = [str(err)]
            if wrong:
                reason = f"{parameter.name} is {parameter.value!r}; {'; '.join(wrong)}"
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def _apply_parameters(self, parameters: list[Parameter]) -> None:
        for parameter in ours(parameters):
            self._order(event_of(parameter, self._thrusters))

    def _event(self, values: dict[str, object]) -> EventConfig:
        keys = {"label": "operator", "at_s": seconds(self._now_ns), **values}
        return read_settings(EventConfig, keys, lambda path: "order")

    def _order(self, values: dict[str, object]) -> None:
        self._dp.happen(self._event(values))
        self._note(str(values["event"]), {key: value for key, value in values.items() if key != "event"})

    def _note(self, what: str, values: dict[str, object]) -> None:
        """Publish an order that was taken."""
        told = DiagnosticStatus(name="vessel: order", message=what, values=pairs(values))
        self._orders.publish(stamped(told, self._now_ns))


def declare_order(node: Node, name: str, default: OrderT, about: str) -> None:
    """Declare a parameter that is an order; at the start there is none to be given.

    Raises
    ------
    ConfigError
        If it was set at the start.
    """
    given = declare(node, name, default, about, live=True)
    if given != default:
        raise ConfigError(
            f"{node.get_name()}: the parameter {name} is {given!r} at the start, expected {default!r}; what is broken "
            "from a time on is an event of the scenario, and this parameter can be set while it runs"
        )


def ours(parameters: Iterable[Parameter]) -> list[Parameter]:
    """Return those of the parameters that are orders."""
    return [parameter for parameter in parameters if parameter.name == POWER or parameter.name.startswith(FAULT)]


def event_of(parameter: Parameter, thrusters: tuple[str, ...]) -> dict[str, object]:
    """Return what a parameter orders, as keys of an event; ValueError for a share that is no number."""
    if parameter.name == POWER:
        return {"event": "power_limit", "share": parameter.value}
    which = parameter.name.removeprefix(FAULT)
    fault, _, share = parameter.value.partition(" ")
    values = {"event": "thruster_fault" if which in thrusters else "sensor_fault", "which": which, "fault": fault}
    return values | ({"share": float(share)} if share else {})


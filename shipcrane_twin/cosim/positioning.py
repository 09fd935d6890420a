"""Dynamic positioning as one chain: sensors, observer, reference model, controller, thrust allocation."""

from dataclasses import dataclass

import numpy as np

from shipcrane_twin.config.scenario import NS_PER_S, EventConfig, Scenario
from shipcrane_twin.control.allocation import allocate, allocation_start, horizontal_load
from shipcrane_twin.control.controller import controller_start, controller_update
from shipcrane_twin.control.controller import horizontal_load as crane_horizontal
from shipcrane_twin.control.ekf import ekf_start, ekf_step
from shipcrane_twin.control.observer import passive_start, passive_step
from shipcrane_twin.control.observer_model import observer_age, observer_bias, observer_pose, observer_velocity
from shipcrane_twin.control.reference import POSE, reference_start, reference_step
from shipcrane_twin.control.wave_frequency import frequency_start, frequency_step, wave_frequency
from shipcrane_twin.control.weathervane import weathervane_step
from shipcrane_twin.cosim import build, dp_build
from shipcrane_twin.cosim.weather import SENSORS, stream
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import matrix_from_quat, quat_from_euler, yaw_from_heading
from shipcrane_twin.physics.propeller import speed_for_thrust
from shipcrane_twin.physics.propulsion import FAILED, FROZEN, LIMITED, OK, RUNAWAY
from shipcrane_twin.physics.sensors import (
    antenna_position,
    gyro_heading,
    mru_motion,
    reference_point,
    relative_wind,
    sensor_start,
    sensor_step,
)
from shipcrane_twin.physics.wind import wind_load

THRUSTER_FAULTS = {"none": OK, "failed": FAILED, "frozen": FROZEN, "limited": LIMITED, "runaway": RUNAWAY}
LOST_TO_DP = (FAILED, FROZEN, RUNAWAY)
PITCH = 1
"""Column of the motion reference unit whose oscillation tells the waves' frequency."""


@dataclass(slots=True)
class Truth:
    """What is measured, at one time.

    Attributes
    ----------
    odom, accel : float64, shape (13,), (6,)
        As on ``/vessel/odom`` and ``/vessel/accel``.
    wind_w : float64, shape (3,)
        [m/s]
    crane_wrench : float64, shape (6,)
        On the ship at crane_base, body axes, mean over the last step.
    thruster_state : float64, shape (n, 2)
        Azimuth [rad], shaft speed [rev/s].
    thrust : float64, shape (n,)
        [N]
    """

    odom: Array
    accel: Array
    wind_w: Array
    crane_wrench: Array
    thruster_state: Array
    thrust: Array


class Positioning:
    """The chain with its states; `update` runs it once per period.

    Parameters
    ----------
    scenario : Scenario
    pose : float64, shape (3,)
        East, north, yaw of the CoG at t = 0.
    azimuth : float64, shape (n,)
        Of the thrusters at t = 0 [rad].
    """

    def __init__(self, scenario: Scenario, pose: Array, azimuth: Array) -> None:
        dp = scenario.dp
        self._dp, self._gravity = dp, scenario.constants.gravity_m_s2
        update_s = dp.period_ms * 1e-3
        mass, damping = dp_build.ship_3dof(scenario)
        self.thrusters = dp_build.propulsion_params(scenario)
        self._allocation = dp_build.allocation_of(scenario, self.thrusters)
        self._reference = dp_build.reference_of(dp)
        self._controller = dp_build.controller_of(dp, mass)
        self._weathervane = dp_build.weathervane_of(dp)
        self._frequency = dp_build.frequency_of(dp)
        self._wind = build.wind_params(scenario)
        self._passive = dp_build.passive_of(dp, mass, damping)
        self._ekf = dp_build.ekf_of(dp, mass, damping)
        self._sensors = dp_build.sensors_of(dp.sensors, update_s)

        self._rng = stream(scenario, SENSORS)
        self._sensor_states = {
            name: sensor_start(params, self._rng.standard_normal(params.noise_std.size))
            for name, params in self._sensors.items()
        }
        self.measured = {name: np.full(p.noise_std.size, np.nan) for name, p in self._sensors.items()}
        self._cog = np.array(scenario.vessel.cog_m)
        self._crane_arm = np.array(scenario.crane.base_m) - self._cog
        self._names = [thruster.name for thruster in scenario.vessel.thrusters]

        self._observer = ekf_start(self._ekf, pose) if dp.observer.kind == "ekf" else passive_start(self._passive, pose)
        self._frequency_state = frequency_start(self._frequency)
        self._controller_state = controller_start()
        self._reference_state = reference_start(self._reference, pose, np.zeros(3))
        self._weathervane_state = np.zeros(2)
        self._allocation_state = allocation_start(self._allocation, azimuth)
        self._achieved = np.zeros(3)
        self.pose, self.velocity_b, self.demand = pose.copy(), np.zeros(3), np.zeros(3)
        self.command = np.column_stack((azimuth, np.zeros_like(azimuth)))
        self.switched_on = True
        self.on = False

        self._setpoint = np.zeros(3)
        self._setpoints = [(0, self._pose_of(dp.setpoint))]
        self._setpoints += [(round(point.at_s * NS_PER_S), self._pose_of(point)) for point in dp.setpoints]
        self._events = sorted((event for event in scenario.events if event.which or event.share is not None), key=_start)
        self.fault = np.zeros(len(self._names), dtype=np.int64)
        self.share = np.ones(len(self._names))
        self.power_share = 1.0
        self._sensor_fault: dict[str, str] = {}

    @staticmethod
    def _pose_of(point: "object") -> Array:
        return np.array([point.east_m, point.north_m, yaw_from_heading(point.heading_deg)])  # type: ignore[attr-defined]

    @property
    def bias_b(self) -> Array:
        """Estimated unknown load (3,), body axes [N, N, N m]."""
        return observer_bias(self._observer)

    @property
    def reference(self) -> Array:
        """Reference pose (3,): east, north, yaw."""
        return self._reference_state[POSE]

    def update(self, time_ns: int, truth: Truth) -> None:
        """Run the chain once; `command` holds the thrusters' commands afterwards."""
        self._take_events(time_ns)
        measured = self._measure(truth)
        self._estimate(measured, truth)
        self._control(time_ns, truth)

    def place_order(self, setpoint: Array) -> None:
        """Take an operator's set-point (east, north, yaw), which replaces the scenario's."""
        self._setpoints = [(0, np.asarray(setpoint, float))]

    def warnings(self) -> list[str]:
        """Return what an operator should know now."""
        told = [f"thruster {name}: {_named(code)}" for name, code in zip(self._names, self.fault, strict=True) if code]
        told += [f"sensor {name}: {fault.replace('_', ' ')}" for name, fault in self._sensor_fault.items()]
        age = observer_age(self._observer)
        lost = [axis for axis, seconds in zip(("east", "north", "heading"), age, strict=True) if seconds > self._lost_s]
        if lost:
            told.append(f"dead reckoning: no {', '.join(lost)} for {age.max():.0f} s")
        if self.power_share < 1.0:
            told.append(f"power limited to {100 * self.power_share:.0f} %")
        if self.on and np.abs(self.demand - self._achieved).max() > 1e-3 * np.abs(self._controller.load_max).max():
            told.append("thrust is not enough for what DP asks for")
        return told

    @property
    def _lost_s(self) -> float:
        return self._dp.observer.lost_after_s

    def _take_events(self, time_ns: int) -> None:
        while self._events and round(self._events[0].at_s * NS_PER_S) <= time_ns:
            event = self._events.pop(0)
            if event.event == "power_limit":
                self.power_share = 1.0 if event.share is None else event.share
            elif event.event == "thruster_fault":
                i = self._names.index(event.which or "")
                self.fault[i] = THRUSTER_FAULTS[event.fault or "failed"]
                self.share[i] = 1.0 if event.share is None else event.share
            elif event.event == "sensor_fault":
                self._sensor_fault.pop(event.which or "", None)
                if event.fault != "none":
                    self._sensor_fault[event.which or ""] = event.fault or "drop_out"

    def _measure(self, truth: Truth) -> Array:
        """Run the sensors; return position of the CoG and heading (3,) as far as they are new."""
        sensors = self._dp.sensors
        truths = {
            "position": antenna_position(truth.odom, np.array(sensors.position.antenna_m)),
            "gyro": gyro_heading(truth.odom),
            "mru": mru_motion(truth.odom, truth.accel, np.array(sensors.mru.place_m), self._gravity),
            "wind": relative_wind(truth.odom, truth.wind_w, np.array(sensors.wind.place_m)),
        }
        new = {}
        for name, params in self._sensors.items():
            draws = self._rng.standard_normal(2 * params.noise_std.size)
            fault = self._sensor_fault.get(name)
            state, found = sensor_step(params, self._sensor_states[name], truths[name], draws, fault == "drop_out")
            self._sensor_states[name] = state
            if fault == "frozen" and np.isfinite(found).all():
                found = self.measured[name].copy()
            new[name] = found
            if np.isfinite(found).all():
                self.measured[name] = found
        roll, pitch = self.measured["mru"][:2]
        arm = np.array(sensors.position.antenna_m) - self._cog
        place = reference_point(new["position"], arm, roll, pitch, self.measured["gyro"][0])
        return np.array([place[0], place[1], new["gyro"][0]])

    def _estimate(self, measured: Array, truth: Truth) -> None:
        observer = self._dp.observer
        omega = 2.0 * np.pi / observer.wave_period_s
        if observer.adaptive:
            self._frequency_state = frequency_step(self._frequency, self._frequency_state, self.measured["mru"][PITCH])
            omega = wave_frequency(self._frequency_state)
        if observer.kind == "none":
            self.pose = np.where(np.isfinite(measured), measured, self.pose)
            self.velocity_b = truth.odom[[7, 8, 12]]
            return
        known = horizontal_load(self._allocation, truth.thruster_state[:, 0], truth.thrust) + self._wind_load()
        if self._dp.controller.crane_share > 0.0:
            known += self._crane_load(truth)
        step, params = (ekf_step, self._ekf) if observer.kind == "ekf" else (passive_step, self._passive)
        self._observer = step(params, self._observer, measured, known, np.full(3, omega))  # type: ignore[operator]
        self.pose, self.velocity_b = observer_pose(self._observer), observer_velocity(self._observer)

    def _control(self, time_ns: int, truth: Truth) -> None:
        was_on = self.on
        self.on = self.switched_on and time_ns >= round(self._dp.enabled_at_s * NS_PER_S)
        if self.on and not was_on:
            cos, sin = np.cos(self.pose[2]), np.sin(self.pose[2])
            surge, sway, turn = self.velocity_b
            drift_w = np.array([cos * surge - sin * sway, sin * surge + cos * sway, turn])
            self._reference_state = reference_start(self._reference, self.pose, drift_w)
            self._setpoint[2] = self.pose[2]
        for from_ns, point in self._setpoints:
            if from_ns <= time_ns:
                heading = self._setpoint[2] if self._dp.weathervane.enabled else point[2]
                self._setpoint = np.array([point[0], point[1], heading])
        if self.on:
            if self._dp.weathervane.enabled:
                self._weathervane_state, self._setpoint[2] = weathervane_step(
                    self._weathervane, self._weathervane_state, self.demand, self.pose[2], self._setpoint[2]
                )
            self._reference_state = reference_step(self._reference, self._reference_state, self._setpoint)
        self._controller_state, self.demand = controller_update(
            self._controller,
            self._controller_state,
            self.on,
            self._reference_state,
            self.pose,
            self.velocity_b,
            self._wind_load(),
            self._crane_load(truth),
            self._achieved,
        )
        self._allocate(truth)

    def _allocate(self, truth: Truth) -> None:
        """Share the demand among the thrusters that obey; the others' push is taken off it."""
        lost = np.isin(self.fault, LOST_TO_DP)
        stray = horizontal_load(self._allocation, truth.thruster_state[:, 0], truth.thrust * lost)
        available = np.where(lost, 0.0, np.where(self.fault == LIMITED, self.share, 1.0))
        self._allocation_state, given = allocate(
            self._allocation, self._allocation_state, self.demand - stray, truth.thruster_state[:, 0], available
        )
        self._achieved = given + stray
        azimuth, thrust = self._allocation_state[:, 0].copy(), self._allocation_state[:, 1].copy()
        speed = speed_for_thrust(self.thrusters, truth.thruster_state, thrust, self.velocity_b)
        self.command = np.column_stack((azimuth, speed))

    def _wind_load(self) -> Array:
        speed, direction = self.measured["wind"]
        if not np.isfinite(speed + direction):
            return np.zeros(3)
        load = wind_load(self._wind, -speed * np.cos(direction), -speed * np.sin(direction))
        return load[[0, 1, 5]]

    def _crane_load(self, truth: Truth) -> Array:
        roll, pitch = np.nan_to_num(self.measured["mru"][:2])
        rot = matrix_from_quat(quat_from_euler(roll, pitch, np.nan_to_num(self.measured["gyro"][0])))
        return crane_horizontal(truth.crane_wrench, self._crane_arm, rot)


def _start(event: EventConfig) -> float:
    return event.at_s


def _named(code: int) -> str:
    return next(name for name, number in THRUSTER_FAULTS.items() if number == code)

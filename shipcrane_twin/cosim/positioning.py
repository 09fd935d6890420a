"""Dynamic positioning as one chain: sensors, observer, reference model, controller, thrust allocation."""

from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from shipcrane_twin.config.dp import SetpointConfig, TimedSetpointConfig
from shipcrane_twin.config.scenario import NS_PER_S, EventConfig, Scenario
from shipcrane_twin.control.allocation import NO_PIECE, PIECE, allocate, allocation_start, horizontal_load
from shipcrane_twin.control.controller import controller_start, controller_update, to_world
from shipcrane_twin.control.controller import horizontal_load as crane_horizontal
from shipcrane_twin.control.ekf import ekf_start, ekf_step
from shipcrane_twin.control.observer import passive_start, passive_step
from shipcrane_twin.control.observer_model import observer_age, observer_bias, observer_pose, observer_velocity
from shipcrane_twin.control.reference import POSE, reference_start, reference_step
from shipcrane_twin.control.wave_frequency import frequency_start, frequency_step, heave_step, wave_frequency
from shipcrane_twin.control.weathervane import weathervane_step
from shipcrane_twin.cosim import build, dp_build
from shipcrane_twin.cosim.dp_faults import DpFaults
from shipcrane_twin.cosim.weather import SENSORS, stream
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import cross, matrix_from_quat, quat_from_euler, wrap_angle, yaw_from_heading
from shipcrane_twin.physics.propeller import speed_for_thrust
from shipcrane_twin.physics.sensors import (
    antenna_position,
    gyro_heading,
    mru_motion,
    reference_point,
    relative_wind,
    sensor_start,
    sensor_step,
    vertical_acceleration,
)
from shipcrane_twin.physics.wind import wind_load

EVENTS = ("thruster_fault", "sensor_fault", "power_limit", "dp_on", "dp_off")
"""The scenario's events that concern DP."""

IDLE_SHARE = 0.01
"""Of `load_max`: a demand below it while DP is off leaves the thrusters idle."""

SHORT_SHARE, SHORT_MEMORY_S = 0.03, 10.0
"""Of `load_max`: what the thrusters give less than asked for, as a mean over that time [s], that is worth a warning.
For moments they always do: an azimuth has to turn first."""

THRUST_BY_POWER = 2.0 / 3.0
"""Thrust at rest grows with this power of the shaft's power."""


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
        self._scenario = scenario
        self._dp, self._gravity = dp, scenario.constants.gravity_m_s2
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
        self._sensors = dp_build.sensors_of(dp.sensors, dp_build.seconds_of(dp.period_ms))

        self._rng = stream(scenario, SENSORS)
        self._sensor_states = {
            name: sensor_start(params, self._rng.standard_normal(params.noise_std.size))
            for name, params in self._sensors.items()
        }
        self.measured = {name: np.full(p.noise_std.size, np.nan) for name, p in self._sensors.items()}
        self._cog = cog = np.array(scenario.vessel.cog_m)
        self._crane_arm = np.array(scenario.crane.base_m) - cog
        sensors = dp.sensors
        self._antenna, self._mru, self._mast = map(
            np.array, (sensors.position.antenna_m, sensors.mru.place_m, sensors.wind.place_m)
        )
        self._antenna_arm = self._antenna - cog
        self._knows_crane = dp.controller.crane_share > 0.0

        self._observer = ekf_start(self._ekf, pose) if dp.observer.kind == "ekf" else passive_start(self._passive, pose)
        self._frequency_state, self._heave = frequency_start(self._frequency), np.zeros(2)
        self._controller_state = controller_start()
        self._reference_state = reference_start(self._reference, pose, np.zeros(3))
        self._weathervane_state = np.zeros(2)
        self._allocation_state = allocation_start(self._allocation, azimuth)
        self._achieved, self._short = np.zeros(3), np.zeros(3)
        self.pose, self.velocity_b, self.demand = pose.copy(), np.zeros(3), np.zeros(3)
        self.command = np.column_stack((azimuth, np.zeros_like(azimuth)))
        self._switch: bool | None = None
        self.on = False

        self._setpoint = np.zeros(3)
        self._setpoints = [(0, self._pose_of(dp.setpoint))]
        later = sorted(dp.setpoints, key=attrgetter("at_s"))
        self._setpoints += [(round(point.at_s * NS_PER_S), self._pose_of(point)) for point in later]
        self.faults = DpFaults([thruster.name for thruster in scenario.vessel.thrusters])
        own = (event for event in scenario.events if event.event in EVENTS)
        self._events = sorted(own, key=attrgetter("at_s"))

    @staticmethod
    def _pose_of(point: SetpointConfig | TimedSetpointConfig) -> Array:
        return np.array([point.east_m, point.north_m, yaw_from_heading(point.heading_deg)])

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
        measured = self._measure(truth)
        wind = self._wind_load()
        crane = self._crane_load(truth) if self._knows_crane else np.zeros(3)
        self._estimate(measured, truth, wind + crane)
        self._control(time_ns, truth, wind, crane)

    def move_to(self, point: SetpointConfig) -> None:
        """Take an operator's set-point, which replaces the scenario's from now on."""
        self._setpoints = [(0, self._pose_of(point))]

    def happen_until(self, time_ns: int) -> None:
        """Let the scenario's events up to a time happen; called at every step, as an operator's orders come at any."""
        while self._events and round(self._events[0].at_s * NS_PER_S) <= time_ns:
            self.happen(self._events.pop(0))

    def happen(self, event: EventConfig) -> None:
        """Let an event happen, of the scenario or by an operator's order."""
        if event.event in ("dp_on", "dp_off"):
            self._switch = event.event == "dp_on"
            return
        stopped = self.faults.stopped
        self.faults.happen(event)
        power_w = self._scenario.vessel.power_total_max_kw * 1e3
        self.thrusters = self.thrusters._replace(power_total_max=power_w * self.faults.power_share)
        if self.faults.stopped != stopped:
            self._allocation = dp_build.allocation_of(self._scenario, self.thrusters, self.faults.stopped)
            self._allocation_state[:, PIECE] = NO_PIECE

    def warnings(self) -> list[str]:
        """Return what an operator should know now."""
        told = self.faults.told()
        age = observer_age(self._observer)
        after_s = self._dp.observer.lost_after_s
        lost = [axis for axis, seconds in zip(("east", "north", "heading"), age, strict=True) if seconds > after_s]
        if lost:
            told.append(f"dead reckoning: no {', '.join(lost)} for {age.max():.0f} s")
        if self.on and (np.abs(self._short) > SHORT_SHARE * self._controller.load_max).any():
            told.append("the thrusters cannot give what DP asks for")
        return told

    def deviation(self) -> tuple[float, float]:
        """Return how far the estimated place [m] and heading [rad] are off the set-point."""
        east, north, yaw = self.pose - self._setpoint
        return float(np.hypot(east, north)), abs(float(wrap_angle(yaw)))

    def _measure(self, truth: Truth) -> Array:
        """Run the sensors; return position of the CoG and heading (3,) as far as they are new."""
        odom = truth.odom
        truths = {
            "position": antenna_position(odom, self._antenna),
            "gyro": gyro_heading(odom),
            "mru": mru_motion(odom, truth.accel, self._mru, self._gravity),
            "wind": relative_wind(odom, truth.wind_w, self._mast),
        }
        new = {}
        for name, params in self._sensors.items():
            draws = self._rng.standard_normal(2 * params.noise_std.size)
            fault = self.faults.sensor.get(name)
            self._sensor_states[name], found = sensor_step(
                params, self._sensor_states[name], truths[name], draws, fault == "drop_out"
            )
            if np.isfinite(found).all():
                if fault == "frozen":
                    found = self.measured[name].copy()
                self.measured[name] = found
            new[name] = found
        roll, pitch = self.measured["mru"][:2]
        place = reference_point(new["position"], self._antenna_arm, roll, pitch, self.measured["gyro"][0])
        return np.array([place[0], place[1], new["gyro"][0]])

    def _estimate(self, measured: Array, truth: Truth, known: Array) -> None:
        observer = self._dp.observer
        omega = 2.0 * np.pi / observer.wave_period_s
        if observer.adaptive:
            up = vertical_acceleration(self.measured["mru"], self._gravity)
            self._heave = heave_step(self._heave, up, dp_build.HEAVE_CORNER, self._frequency.period)
            self._frequency_state = frequency_step(self._frequency, self._frequency_state, self._heave[0])
            omega = wave_frequency(self._frequency_state)
        if observer.kind == "none":
            self.pose = np.where(np.isfinite(measured), measured, self.pose)
            at_cog = truth.odom[7:10] + cross(truth.odom[10:13], self._cog)
            self.velocity_b = np.array([at_cog[0], at_cog[1], truth.odom[12]])
            return
        known = known + horizontal_load(self._allocation, truth.thruster_state[:, 0], truth.thrust)
        waves = np.full(3, omega)
        if observer.kind == "ekf":
            self._observer = ekf_step(self._ekf, self._observer, measured, known, waves)
        else:
            self._observer = passive_step(self._passive, self._observer, measured, known, waves)
        self.pose, self.velocity_b = observer_pose(self._observer), observer_velocity(self._observer)

    def _control(self, time_ns: int, truth: Truth, wind: Array, crane: Array) -> None:
        was_on = self.on
        self.on = time_ns >= round(self._dp.enabled_at_s * NS_PER_S) if self._switch is None else self._switch
        if self.on and not was_on:
            drift_w = to_world(self.velocity_b, np.cos(self.pose[2]), np.sin(self.pose[2]))
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
            wind,
            crane,
            self._achieved,
        )
        self._allocate(truth)

    def _allocate(self, truth: Truth) -> None:
        """Share the demand among the thrusters that obey; the others' push is taken off it."""
        available = self.faults.available * self.faults.power_share**THRUST_BY_POWER
        stray = horizontal_load(self._allocation, truth.thruster_state[:, 0], truth.thrust * (available == 0.0))
        if not self.on and (np.abs(self.demand) < IDLE_SHARE * self._controller.load_max).all():
            available = np.zeros_like(available)
        self._allocation_state, given = allocate(
            self._allocation, self._allocation_state, self.demand - stray, truth.thruster_state[:, 0], available
        )
        self._achieved = given + stray
        share = self._controller.period / SHORT_MEMORY_S
        self._short = (1.0 - share) * self._short + share * (self.demand - self._achieved)
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


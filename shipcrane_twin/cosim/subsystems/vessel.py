"""The ship with its thrusters and dynamic positioning."""

import numpy as np

from shipcrane_twin.config.scenario import NS_PER_MS, Scenario
from shipcrane_twin.cosim.coupling import SCHEMES
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.cosim.positioning import Positioning, Truth
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import seconds
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import euler_from_matrix, matrix_from_quat, quat_from_euler
from shipcrane_twin.physics.vessel_step import THRUST, vessel_at_rest, vessel_macro_step, vessel_outputs


class Vessel:
    """Hull, thrusters and DP; the crane's wrench of the last step stands for crane and load."""

    name = "vessel"

    def __init__(self, scenario: Scenario) -> None:
        rest = at_rest(scenario)
        self._params = rest.params
        self._carries = SCHEMES[scenario.coupling].carries_inertia
        self._step_ns = scenario.step_ns
        self._step_s = seconds(scenario.step_ns)
        self._telemetry_every = scenario.telemetry_every
        self._dp_every = round(scenario.dp.period_ms * NS_PER_MS) // scenario.step_ns
        count = len(scenario.vessel.thrusters)
        self._memory = vessel_at_rest(self._params, rest.vessel, rest.inertia * self._carries, count)
        yaw = euler_from_matrix(matrix_from_quat(rest.vessel[3:7]))[2]
        azimuth = np.array([0.0 if thruster.azimuthing else 0.5 * np.pi for thruster in scenario.vessel.thrusters])
        self._memory[THRUST : THRUST + 2 * count : 2] = azimuth
        self.positioning = Positioning(scenario, np.array([rest.vessel[0], rest.vessel[1], yaw]), azimuth)
        self._count = count
        self.thruster_names = tuple(thruster.name for thruster in scenario.vessel.thrusters)
        self._crane = np.zeros(6)
        self._wind_w = np.zeros(3)

    def start(self) -> Signals:
        """Return the ship at rest at t = 0."""
        return self._outputs(0)

    def step(self, k: int, inputs: Signals) -> Signals:
        """Move the ship over step k."""
        self._crane = inputs["/crane/base_wrench"]
        time_ns = (k - 1) * self._step_ns
        self.positioning.happen_until(time_ns)
        if (k - 1) % self._dp_every == 0:
            self._position(time_ns)
        dp = self.positioning
        self._wind_w = inputs["/environment/wind"][:3]
        self._memory = vessel_macro_step(
            self._params,
            dp.thrusters,
            self._memory,
            dp.command,
            dp.faults.thruster,
            dp.faults.share,
            inputs["/environment/wave_wrench"] + inputs["/environment/wind_wrench"],
            self._crane,
            inputs["/crane/base_inertia"] * self._carries,
            inputs["/environment/current"][:3],
            self._step_s,
        )
        return self._outputs(k)

    def warnings(self) -> list[str]:
        """Return what an operator should know now."""
        return self.positioning.warnings()

    def condition(self) -> dict[str, str]:
        """Return how position keeping does, for diagnostics."""
        dp = self.positioning
        off_m, off_rad = dp.deviation()
        power = self._thrusters()[2]
        return {
            "dp": "on" if dp.on else "off",
            "position_error_m": f"{off_m:.2f}",
            "heading_error_deg": f"{np.rad2deg(off_rad):.2f}",
            "thruster_power_kw": f"{power.sum() / 1e3:.0f}",
        }

    def _position(self, time_ns: int) -> None:
        """Run dynamic positioning on what the sensors see at the start of a step."""
        odom, accel = vessel_outputs(self._memory, self._params.cog)
        state, thrust, _ = self._thrusters()
        self.positioning.update(time_ns, Truth(odom, accel, self._wind_w, self._crane, state, thrust))

    def _thrusters(self) -> tuple[Array, Array, Array]:
        """Return azimuth and shaft speed (n, 2), thrust (n,), power (n,)."""
        count = self._count
        part = self._memory[THRUST : THRUST + 4 * count]
        return part[: 2 * count].reshape((count, 2)), part[2 * count : 3 * count], part[3 * count :]

    def _outputs(self, k: int) -> Signals:
        odom, accel = vessel_outputs(self._memory, self._params.cog)
        out = {"/vessel/odom": odom, "/vessel/accel": accel}
        if k % self._telemetry_every == 0:
            out["/vessel/pose"] = odom[:7].copy()
            out |= self._telemetry()
        return out

    def _telemetry(self) -> dict[str, Array]:
        dp = self.positioning
        seen = {name: np.nan_to_num(values) for name, values in dp.measured.items()}
        roll, pitch = seen["mru"][:2]
        heading = float(seen["gyro"][0])
        speed, direction = seen["wind"]
        state, thrust, _ = self._thrusters()
        surge, sway, turn = dp.velocity_b
        still = np.zeros(3)
        return {
            "/vessel/imu": np.concatenate((quat_from_euler(roll, pitch, heading), seen["mru"][2:])),
            "/vessel/position_fix": np.concatenate((seen["position"], [0.0], quat_from_euler(0.0, 0.0, heading))),
            "/vessel/wind_sensor": np.array([-speed * np.cos(direction), -speed * np.sin(direction), 0.0, *still]),
            "/dp/estimate": np.concatenate((level_pose(dp.pose), [surge, sway, 0.0, 0.0, 0.0, turn])),
            "/dp/bias": spread(dp.bias_b),
            "/dp/reference": level_pose(dp.reference),
            "/dp/wrench": spread(dp.demand),
            "/thrusters/joint_states": np.concatenate((state[:, 0], 2.0 * np.pi * state[:, 1], thrust)),
        }


def level_pose(pose: Array) -> Array:
    """Return the pose (7,) of (east, north, yaw) at height zero."""
    return np.concatenate((pose[:2], [0.0], quat_from_euler(0.0, 0.0, pose[2])))


def spread(load: Array) -> Array:
    """Return the wrench (6,) of (surge, sway, yaw)."""
    return np.array([load[0], load[1], 0.0, 0.0, 0.0, load[2]])

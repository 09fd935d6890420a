"""What hangs on the wire, as the payload subsystem steps it: a point mass, or a rigid box in a sling."""

import numpy as np

from shipcrane_twin.config.lifting import BoxConfig, on_ship
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.initial import Rest
from shipcrane_twin.cosim.lifting import LoadWeather, load_at_start, rigid_params
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import seconds
from shipcrane_twin.physics import payload, rigid_load
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import matrix_from_quat, rotate_to_body
from shipcrane_twin.physics.rigid_step import Surroundings, rigid_step
from shipcrane_twin.physics.vessel_step import vessel_at_rest, vessel_outputs
from shipcrane_twin.physics.winch import Hold
from shipcrane_twin.physics.wire import SNAP_LAST, SNAP_MAX, SNAPS


def snap_events(record: Array) -> dict[str, float]:
    """Return the record of snaps (5,) by name."""
    return {
        "snaps": float(record[SNAPS]),
        "snap_tension_max_n": float(record[SNAP_MAX]),
        "snap_tension_last_n": float(record[SNAP_LAST]),
    }


class PointLoad:
    """A point mass; it meets neither wind nor water nor deck."""

    def __init__(self, scenario: Scenario, rest: Rest) -> None:
        self._wire = build.wire_params(scenario)
        self._hook_mass = scenario.payload.hook_mass_kg
        self._step_s = seconds(scenario.step_ns)
        self._state = payload.hanging_state(
            self._wire, rest.tip_w, np.zeros(3), scenario.winch.initial_length_m, scenario.payload.mass_kg
        )

    @property
    def line(self) -> tuple[float, float]:
        """Paid-out length [m] and its rate [m/s]."""
        return float(self._state[payload.LENGTH]), float(self._state[payload.SPEED])

    def release(self) -> None:
        """Take the load off the hook."""
        self._state = self._state.copy()
        self._state[payload.MASS] = self._hook_mass

    def step(self, hold: Hold, told: tuple[float, float], tips: tuple[Array, Array], k: int, _: Signals) -> Array:
        """Move over step k and return force on the tip (3,) and largest tension, in one array (4,) [N]."""
        self._state, force, tension = payload.payload_step(
            self._wire, hold, self._state, told[0], told[1], tips[0], tips[1], self._step_s
        )
        return np.append(force, tension)

    def odometry(self) -> Array:
        """Return the odometry (13,) of the load."""
        odom = np.zeros(13)
        odom[:3], odom[6], odom[7:10] = self._state[:3], 1.0, self._state[3:6]
        return odom

    def felt_mass(self) -> float:
        """Return the mass that the tip carries along the taut wire [kg]."""
        length, mass = self._state[payload.LENGTH], self._state[payload.MASS]
        return float(payload.carried(self._wire, length, mass)[0])

    def events(self) -> dict[str, float]:
        """Return what has happened to the load so far."""
        return snap_events(self._state[payload.RECORD :])


class BoxLoad:
    """A rigid box in a two-legged sling under the hook."""

    def __init__(self, scenario: Scenario, rest: Rest, box: BoxConfig) -> None:
        self._wire = build.wire_params(scenario)
        self._load = rigid_params(scenario, box)
        self._around = LoadWeather(scenario, box)
        self._step_ns, self._step_s = scenario.step_ns, seconds(scenario.step_ns)
        self._sees_ship = on_ship(scenario.payload)
        ship = vessel_outputs(vessel_at_rest(rest.params, rest.vessel, rest.inertia, 0), rest.params.cog)[0]
        self._planes = self._around.planes(0.0, ship)
        self._state = load_at_start(scenario, box, self._wire, self._load, rest.tip_w, self._planes)
        self._water = self._around.water(0.0, self._state[6:9])
        self._ship = ship

    @property
    def line(self) -> tuple[float, float]:
        """Paid-out length [m] and its rate [m/s]."""
        return float(self._state[rigid_load.LENGTH]), float(self._state[rigid_load.SPEED])

    def release(self) -> None:
        """Take the sling off the hook."""
        self._state = self._state.copy()
        self._state[rigid_load.SLUNG] = 0.0

    def step(self, hold: Hold, told: tuple[float, float], tips: tuple[Array, Array], k: int, inputs: Signals) -> Array:
        """Move over step k and return force on the tip (3,) and largest tension, in one array (4,) [N].

        Water counts at the place where the load is at the step's start, moved on by its velocity for the end.
        """
        end_s = seconds(k * self._step_ns)
        if self._sees_ship:
            self._ship = inputs["/vessel/odom"]
        planes = self._around.planes(end_s, self._ship)
        water = self._around.water(end_s, self._state[6:9] + self._step_s * self._state[9:12])
        wind = 0.5 * (self._around.wind(end_s - self._step_s) + self._around.wind(end_s))
        around = Surroundings(tips[0], tips[1], self._planes, planes, self._water, water, wind)
        self._state, force, tension = rigid_step(
            self._wire, hold, self._load, self._state, told[0], told[1], around, self._step_s
        )
        self._planes, self._water = planes, water
        return np.append(force, tension)

    def odometry(self) -> Array:
        """Return the odometry (13,) of the load's CoG, velocities in its own axes."""
        odom = np.zeros(13)
        odom[:3], odom[3:7], odom[10:13] = self._state[6:9], self._state[12:16], self._state[16:19]
        odom[7:10] = rotate_to_body(matrix_from_quat(self._state[12:16]), self._state[9:12])
        return odom

    def felt_mass(self) -> float:
        """Return the mass that the tip carries along the taut wire [kg]: the hook's, as the sling hides the box.

        With the box bolted to the tip as well, the true force a step late feeds the vibration of the sling.
        """
        return float(payload.carried(self._wire, self._state[rigid_load.LENGTH], self._load.hook_mass)[0])

    def events(self) -> dict[str, float]:
        """Return what has happened to the load so far."""
        record = self._state[rigid_load.LANDING :]
        return {
            **snap_events(self._state[rigid_load.RECORD :]),
            "landings": float(record[rigid_load.LANDINGS]),
            "impact_speed_last_m_s": float(record[rigid_load.IMPACT]),
            "impact_speed_max_m_s": float(record[rigid_load.IMPACT_MAX]),
            "lift_offs": float(record[rigid_load.LIFT_OFFS]),
        }


def hung_load(scenario: Scenario, rest: Rest) -> PointLoad | BoxLoad:
    """Return the load of a scenario at rest."""
    box = scenario.payload.box
    return PointLoad(scenario, rest) if box is None else BoxLoad(scenario, rest, box)

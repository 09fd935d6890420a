"""From settings to the rigid load and what surrounds it: planes, water and wind where the load is."""

import math

import numpy as np

from shipcrane_twin.config.lifting import BoxConfig, PlaneConfig
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim import weather
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.contact import STIFFNESS
from shipcrane_twin.physics.frames import (
    cross,
    matrix_from_quat,
    quat_from_matrix,
    rotate_to_world,
    towards_w,
    yaw_from_heading,
)
from shipcrane_twin.physics.payload import WireParams
from shipcrane_twin.physics.rigid_load import QUAT, TURNING, VELOCITY, RigidParams, make_rigid
from shipcrane_twin.physics.rigid_step import slung_state
from shipcrane_twin.physics.sea.current import current_at
from shipcrane_twin.physics.sea.gusts import gust
from shipcrane_twin.physics.sea.kinematics import elevation, orbital
from shipcrane_twin.physics.splash import SplashParams, body_added_mass

PLANE_THICKNESS_M = 1.0
"""Depth below a deck or a quay from which a corner is taken for one underneath."""


def rigid_params(scenario: Scenario, box: BoxConfig) -> RigidParams:
    """Return the constants of the rigid load; its planes are those of the settings and then the sea floor."""
    constants, payload, contact = scenario.constants, scenario.payload, box.contact
    size = np.array([box.length_m, box.breadth_m, box.height_m])
    centre = -np.array(box.cog_m)
    density = constants.water_density_kg_m3
    splash = SplashParams(
        size=size,
        centre=centre,
        displaced=box.displaced_share,
        density=density,
        gravity=constants.gravity_m_s2,
        drag=box.drag_coefficient,
        slamming=box.slamming_coefficient,
        added_mass=np.array(
            [
                body_added_mass(size[(k + 1) % 3], size[(k + 2) % 3], size[k], density, box.perforation)
                for k in range(3)
            ]
        ),
    )
    touch = (contact.stiffness_n_m, contact.loss_s_m, contact.friction)
    planes = [(0.5 * plane.length_m, 0.5 * plane.breadth_m, PLANE_THICKNESS_M, *touch) for plane in box.planes]
    if scenario.environment.water_depth_m is not None:
        planes.append((math.inf, math.inf, math.inf, *touch))
    half = 0.5 * box.sling.lug_distance_m
    return make_rigid(
        hook_mass=payload.hook_mass_kg,
        mass=payload.mass_kg - payload.hook_mass_kg,
        lugs=centre + np.array([[-half, 0.0, box.sling.lug_height_m], [half, 0.0, box.sling.lug_height_m]]),
        leg_length=box.sling.leg_length_m,
        leg_stiffness=box.sling.leg_stiffness_n_m,
        splash=splash,
        air_drag=0.5 * constants.air_density_kg_m3 * box.air_drag_coefficient,
        planes=np.array(planes).reshape(-1, 6),
        phase_max=scenario.wire.phase_max_rad,
    )


def turned(yaw: float) -> Array:
    """Return the matrix (3, 3) of a turn about the vertical [rad]."""
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def plane_row(plane: PlaneConfig, time_s: float, ship: Array) -> Array:
    """Return where a plane is, see `physics.contact`.

    Parameters
    ----------
    plane : PlaneConfig
    time_s : float
    ship : float64, shape (13,)
        ``/vessel/odom`` at that time; of no account for a plane that is not on the ship.
    """
    place, velocity, turning = np.array(plane.centre_m), np.zeros(3), np.zeros(3)
    if plane.moves_with == "ship":
        rot = matrix_from_quat(ship[3:7])
        turning = rotate_to_world(rot, ship[10:13])
        velocity = rotate_to_world(rot, ship[7:10] + cross(ship[10:13], place))
        place = ship[:3] + rotate_to_world(rot, place)
        rot = rot @ turned(-math.radians(plane.heading_deg))
    else:
        rot = turned(yaw_from_heading(plane.heading_deg))
    if plane.heave_amplitude_m is not None and plane.heave_period_s is not None:
        rate = 2.0 * math.pi / plane.heave_period_s
        angle = rate * time_s + math.radians(plane.heave_phase_deg or 0.0)
        place[2] += plane.heave_amplitude_m * math.sin(angle)
        velocity[2] += plane.heave_amplitude_m * rate * math.cos(angle)
    return np.concatenate((place, velocity, rot.ravel(), turning))


class LoadWeather:
    """Planes, water and wind at the load: the sea, gusts and current that the environment has, from the same seed."""

    def __init__(self, scenario: Scenario, box: BoxConfig) -> None:
        env = scenario.environment
        self._planes = box.planes
        self._depth = env.water_depth_m
        self._sea = weather.sea(scenario)
        self._gusts = weather.gusts(scenario)
        self._current = weather.current(scenario)
        self._mean_wind = env.wind_speed_m_s
        self._towards = towards_w(env.wind_direction_to_deg)

    def planes(self, time_s: float, ship: Array) -> Array:
        """Return all planes (n, 18) at a time [s], the sea floor last; ``ship`` is ``/vessel/odom``."""
        rows = [plane_row(plane, time_s, ship) for plane in self._planes]
        if self._depth is not None:
            floor = np.zeros(18)
            floor[2] = -self._depth
            floor[6:15] = np.eye(3).ravel()
            rows.append(floor)
        return np.array(rows).reshape(-1, 18)

    def water(self, time_s: float, place: Array) -> Array:
        """Return elevation, velocity and acceleration of the water (7,) at a place (3,) and time [s]."""
        out = np.zeros(7)
        out[1:3] = current_at(self._current, time_s)
        if len(self._sea.amplitude):
            x, y = float(place[0]), float(place[1])
            out[0] = elevation(self._sea, time_s, x, y)
            velocity, acceleration = orbital(self._sea, time_s, x, y, float(min(place[2], out[0])))
            out[1:4] += velocity
            out[4:7] = acceleration
        return out

    def wind(self, time_s: float) -> Array:
        """Return the wind (3,) at a time [s], that at 10 m height [m/s]."""
        speed = self._mean_wind + gust(self._gusts, time_s)
        return speed * self._towards


def load_at_start(
    scenario: Scenario, box: BoxConfig, wire: WireParams, load: RigidParams, tip_w: Array, planes: Array
) -> Array:
    """Return the state (32,) of the load at rest under the tip, or lying on its plane and moving with it."""
    rot = turned(yaw_from_heading(box.heading_deg))
    length = scenario.winch.initial_length_m
    if box.rests_on is None:
        return slung_state(wire, load, tip_w, length, quat_from_matrix(rot), np.zeros(3), False)
    row = planes[[plane.label for plane in box.planes].index(box.rests_on)]
    axes = row[6:15].reshape(3, 3)
    ahead, normal = axes.T @ rot[:, 0], axes[:, 2]
    rot = axes @ turned(math.atan2(ahead[1], ahead[0]))
    sink = 0.25 * load.mass * wire.gravity / load.planes[0, STIFFNESS]
    below_tip = tip_w + np.array([0.0, 0.0, ((row[:3] - tip_w) @ normal) / normal[2]])
    off = np.abs(axes.T @ (below_tip - row[:3]))[:2]
    rows = load.planes[[plane.label for plane in box.planes].index(box.rests_on)]
    if (off > rows[:2]).any():
        raise ValueError(
            f"payload.box.rests_on is {box.rests_on!r}, of which the crane's tip is {off[0]:.1f} m along and "
            f"{off[1]:.1f} m across from its centre; expected at most {rows[0]:g} and {rows[1]:g}: "
            "move the plane or the tip"
        )
    place = below_tip + (0.5 * box.height_m - load.splash.centre[2] - sink) * normal
    state = slung_state(wire, load, tip_w, length, quat_from_matrix(rot), place, True)
    state[VELOCITY:QUAT] = row[3:6] + cross(row[15:18], place - row[:3])
    state[TURNING : TURNING + 3] = rot.T @ row[15:18]
    return state

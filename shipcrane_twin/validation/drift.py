"""Mean drift in regular waves: the load alone, and the whole ship on soft springs, through the chain of a run."""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.build import hydro_database, vessel_params
from shipcrane_twin.cosim.dp_build import propulsion_params
from shipcrane_twin.cosim.weather import weather_params
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.hydro.database import HydroDatabase
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import cross, euler_from_matrix, matrix_from_quat, rotate_to_body, rotate_to_world
from shipcrane_twin.physics.propeller import PropulsionParams
from shipcrane_twin.physics.sea.components import Waves, make_waves
from shipcrane_twin.physics.sea.loads import wave_load, wave_load_params
from shipcrane_twin.physics.vessel import VesselParams
from shipcrane_twin.physics.vessel_step import vessel_at_rest, vessel_macro_step, vessel_outputs
from shipcrane_twin.physics.weather import WeatherParams, weather_step

NAMES = ("surge", "sway", "yaw")
BAR, JUDGED_FROM = 0.05, 0.10
"""Bar, and the share of its largest value from which a mean load is judged."""

OMEGA = (0.8, 1.05, 1.4, 1.65, 1.9, 2.2, 2.5)
DIRECTION_STEP_DEG = 15
AMPLITUDE_M, RAMP_S, SETTLE_S, CYCLES = 0.01, 40.0, 700.0, 20
"""A small wave keeps the mean offset, and with it the change of heading, small."""

PERIOD_S, DAMPING_RATIO = 160.0, 0.7
"""Of the springs that hold the ship: so soft that they hardly change its first-order motions."""

CALM = ("environment.waves.systems=[]", "environment.current_speed_m_s=0", "environment.wind_speed_m_s=0")


class Rig(NamedTuple):
    """The ship of a scenario in calm weather, and its macro step [s]."""

    ship: VesselParams
    thrusters: PropulsionParams
    weather: WeatherParams
    data: HydroDatabase
    step_s: float


class Drift(NamedTuple):
    """Mean loads per squared amplitude, surge, sway, yaw (n, m, 3), at omega (n,) and directions (m,)."""

    omega: Array
    direction: Array
    measured: Array
    expected: Array


def make_rig(scenario_name: str) -> Rig:
    """Return the ship of a scenario without its own weather, and without the drag that grows with squared speed.

    Such drag has a mean of its own in waves, which is real and not in the drift transfer function.
    """
    scenario = load_scenario(scenario_name, CALM)
    ship = vessel_params(scenario)
    smooth = ship.hull._replace(current_scale=np.zeros(3), strips=np.zeros((1, 2)), roll_quadratic=0.0)
    return Rig(
        ship._replace(hull=smooth),
        propulsion_params(scenario),
        weather_params(scenario),
        hydro_database(scenario),
        scenario.step_ns / 1e9,
    )


@njit(cache=True)
def hold_ship(
    ship: VesselParams,
    thrusters: PropulsionParams,
    weather: WeatherParams,
    spring: Array,
    damper: Array,
    step_s: float,
    count: int,
) -> Array:
    """Return the loads (count, 3) along east and north and about the vertical with which springs hold a ship.

    The ship heads east at the origin with its thrusters idle; the springs act on the CoG through the crane's wrench.
    `spring` and `damper` (3,) are those of east, north and heading [N/m, N m; N s/m, N m s].
    """
    state = np.zeros(13)
    state[2] = ship.hull.design_height
    state[6] = 1.0
    nothing = np.zeros(10)
    count_thrusters = thrusters.diameter.shape[0]
    idle = np.zeros((count_thrusters, 2))
    fault, share = np.zeros(count_thrusters, np.int64), np.ones(count_thrusters)
    memory = vessel_at_rest(ship, state, nothing, count_thrusters)
    arm = ship.crane_base - ship.cog
    slow = np.zeros((3, 2))
    out = np.empty((count, 3))
    wrench = np.empty(6)
    for k in range(count):
        odom, _ = vessel_outputs(memory, ship.cog)
        rot = matrix_from_quat(memory[3:7])
        velocity_w, turning_w = rotate_to_world(rot, memory[7:10]), rotate_to_world(rot, memory[10:13])
        out[k, 0] = -spring[0] * memory[0] - damper[0] * velocity_w[0]
        out[k, 1] = -spring[1] * memory[1] - damper[1] * velocity_w[1]
        out[k, 2] = -spring[2] * euler_from_matrix(rot)[2] - damper[2] * turning_w[2]
        force_b = rotate_to_body(rot, np.array([out[k, 0], out[k, 1], 0.0]))
        wrench[:3] = force_b
        wrench[3:] = rotate_to_body(rot, np.array([0.0, 0.0, out[k, 2]])) - cross(arm, force_b)
        slow, current_w, _, waved, blown = weather_step(weather, slow, odom, (k + 1) * step_s, step_s)
        memory = vessel_macro_step(
            ship, thrusters, memory, idle, fault, share, waved + blown, wrench, nothing, current_w, step_s
        )
    return out


def regular_wave(data: HydroDatabase, omega: float, direction: float, ramp: float) -> Waves:
    """Return a regular wave of `AMPLITUDE_M`."""
    columns = (np.array([value]) for value in (AMPLITUDE_M, omega, direction, 0.0))
    return make_waves(*columns, gravity=data.gravity, depth=data.depth, ramp=ramp)


def held_mean(rig: Rig, omega: float, direction: float) -> Array:
    """Return the mean load (3,) per squared amplitude that a wave exerts on the ship, from what holds it.

    Notes
    -----
    After 700 s the springs' transients are below 1e-8; a constant and two harmonics are fitted to twenty cycles.
    """
    waves = regular_wave(rig.data, omega, direction, RAMP_S)
    data = rig.data
    loads = wave_load_params(waves, data.omega, data.direction, data.excitation, data.drift)
    rate = 2.0 * np.pi / PERIOD_S
    mass = np.diag(rig.ship.rigid_mass + rig.ship.hull.added_mass)[[0, 1, 5]]
    span = CYCLES * 2.0 * np.pi / omega
    found = hold_ship(
        rig.ship,
        rig.thrusters,
        rig.weather._replace(waves=waves, wave_loads=loads),
        mass * rate**2,
        2.0 * DAMPING_RATIO * rate * mass,
        rig.step_s,
        int(np.ceil((SETTLE_S + span) / rig.step_s)),
    )
    last = round(span / rig.step_s)
    turn = omega * rig.step_s * np.arange(last)
    columns = np.column_stack([np.ones(last), np.cos(turn), np.sin(turn), np.cos(2.0 * turn), np.sin(2.0 * turn)])
    return np.asarray(-np.linalg.lstsq(columns, found[-last:], rcond=None)[0][0] / AMPLITUDE_M**2)


def held_drift(rig: Rig, wanted: tuple[float, ...] = OMEGA, step_deg: int = DIRECTION_STEP_DEG) -> Drift:
    """Return measured and expected mean loads at the table's frequencies nearest to the wanted ones."""
    data = rig.data
    rows = np.array([int(np.argmin(np.abs(data.omega - omega))) for omega in wanted])
    angles = np.deg2rad(np.arange(0, 181, step_deg))
    columns = np.array([int(np.argmin(np.abs(data.direction - angle))) for angle in angles])
    found = [[held_mean(rig, data.omega[i], data.direction[j]) for j in columns] for i in rows]
    return Drift(data.omega[rows], data.direction[columns], np.array(found), data.drift[np.ix_(rows, columns)])


def drift_rows(drift: Drift, data: HydroDatabase) -> list[Row]:
    """Compare what holds the ship with the transfer function, wherever that is above 10 % of its largest value.

    The whole chain runs: slow pose, interpolated loads, first-order motions, memory, thrusters idle. So the
    figure also shows what first-order loads and motions make together on average, which the transfer function holds
    already. The ship is free in heave, roll and pitch; springs hold it with a natural period of 160 s.
    """
    largest = np.abs(data.drift).max(axis=(0, 1))
    error = np.abs(drift.measured - drift.expected)
    rows = []
    for k, name in enumerate(NAMES):
        counts = np.abs(drift.expected[..., k]) > JUDGED_FROM * largest[k]
        share = np.where(counts, error[..., k] / np.where(counts, np.abs(drift.expected[..., k]), 1.0), 0.0)
        i, j = np.unravel_index(int(share.argmax()), share.shape)
        note = (
            f"{int((share > BAR).sum())} of {int(counts.sum())} cases above the bar, worst at "
            f"{drift.omega[i]:.3g} rad/s to {np.rad2deg(drift.direction[j]):.0f} deg"
        )
        rows.append(Row(f"mean {name} load on the held ship against the transfer function", share[i, j], BAR, "", note))
        beside = float(error[..., k].max() / largest[k])
        rows.append(Row(f"the same, {name}, largest difference over the largest mean load", beside, None))
    return rows


def load_rows(data: HydroDatabase) -> list[Row]:
    """Compare the kernel's mean drift load with the transfer function.

    Regular waves of every third frequency to every 5 degrees, on a ship away from the origin that heads elsewhere; mean
    over one period, wherever the transfer function is above 10 % of its largest value.
    """
    largest = np.abs(data.drift).max(axis=(0, 1))
    heading = 0.7
    worst, cases = np.zeros(3), 0
    for i in range(0, len(data.omega), 3):
        for j, direction in enumerate(data.direction):
            waves = regular_wave(data, data.omega[i], heading + direction, 0.0)
            loads = wave_load_params(waves, data.omega, data.direction, data.excitation, data.drift)
            times = 2.0 * np.pi / data.omega[i] * np.arange(8) / 8.0
            mean = np.mean([wave_load(loads, waves, t, 30.0, -20.0, heading)[1] for t in times], axis=0)
            expected = data.drift[i, j]
            counts = np.abs(expected) > JUDGED_FROM * largest
            error = np.abs(mean / AMPLITUDE_M**2 - expected)[counts] / np.abs(expected)[counts]
            worst[counts] = np.maximum(worst[counts], error)
            cases += int(counts.sum())
    told = f"{cases} cases in all"
    return [
        Row(f"mean {name} load of the kernel against the transfer function", float(value), BAR, "", told)
        for name, value in zip(NAMES, worst, strict=True)
    ]

"""Runs that show dynamic positioning: whole scenarios in one process, and what is read off them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import signal

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.scenario import NS_PER_S, Scenario
from shipcrane_twin.control.allocation import horizontal_load
from shipcrane_twin.cosim import build, dp_build
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.cosim.subsystems.vessel import Vessel
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import euler_from_matrix, matrix_from_quat, wrap_angle, yaw_from_heading
from shipcrane_twin.physics.wind import wind_load

SLOW_HZ = 0.05
"""Below it motion counts as slow; the waves here are at 0.1 Hz."""

AXES = ("surge", "sway", "yaw")
HORIZONTAL = [0, 1, 5]
"""Columns of surge, sway and yaw in a wrench."""


class Ride(NamedTuple):
    """What a run showed, at every telemetry period.

    Attributes
    ----------
    scenario : Scenario
    time_s : float64, shape (n,)
    pose : float64, shape (n, 3)
        True east and north of the CoG [m], yaw [rad].
    setpoint, reference, estimate : float64, shape (n, 3)
        The scenario's set-point, the reference on its way there, what the observer believes; as `pose`.
    bias, demand, known : float64, shape (n, 3)
        Level axes (surge, sway, yaw) [N, N, N m]: the observer's unknown load, what DP asks for, and what the observer
        knows of (thrusters and measured wind).
    azimuth, thrust : float64, shape (n, m)
        Of the thrusters [rad], [N].
    warnings : tuple of str
        All that an operator was told.
    """

    scenario: Scenario
    time_s: Array
    pose: Array
    setpoint: Array
    reference: Array
    estimate: Array
    bias: Array
    demand: Array
    known: Array
    azimuth: Array
    thrust: Array
    warnings: tuple[str, ...]

    @property
    def step_s(self) -> float:
        """Time between two rows [s]."""
        return float(self.time_s[1] - self.time_s[0])


def ride(name: str, changes: Sequence[str] = ()) -> Ride:
    """Run a scenario with changed keys, all subsystems in this process."""
    scenario = load_scenario(name, changes)
    run = InlineRun(scenario)
    vessel = run.subsystem("vessel")
    assert isinstance(vessel, Vessel)
    thrusters = dp_build.propulsion_params(scenario)
    allocation, wind = dp_build.allocation_of(scenario, thrusters), build.wind_params(scenario)
    cog, count = np.array(scenario.vessel.cog_m), len(scenario.vessel.thrusters)
    rows: list[Array] = []
    told: dict[str, None] = {}
    for k in run.steps():
        if k % scenario.telemetry_every:
            continue
        seen = run.latest
        odom, estimate, reference = seen["/vessel/odom"], seen["/dp/estimate"], seen["/dp/reference"]
        joints, air = seen["/thrusters/joint_states"], seen["/vessel/wind_sensor"]
        rot = matrix_from_quat(odom[3:7])
        thrust = horizontal_load(allocation, joints[:count], joints[2 * count :])
        blown = wind_load(wind, air[0], air[1])[HORIZONTAL]
        row = [odom[:2] + (rot @ cog)[:2], [euler_from_matrix(rot)[2]]]
        for pose in (reference, estimate):
            row += [pose[:2], [euler_from_matrix(matrix_from_quat(pose[3:7]))[2]]]
        row += [seen["/dp/bias"][HORIZONTAL], seen["/dp/wrench"][HORIZONTAL], thrust + blown]
        rows.append(np.concatenate([*row, joints[:count], joints[2 * count :]]))
        told |= dict.fromkeys(text.split(" for ")[0] for text in vessel.warnings())  # less the seconds it lasts
    table = np.array(rows)
    every_s = scenario.telemetry_every * scenario.step_ns / NS_PER_S
    time_s = np.arange(len(table), dtype=np.float64) * every_s
    pose, reference, estimate, bias, demand, known = (table[:, 3 * i : 3 * i + 3] for i in range(6))
    return Ride(
        scenario, time_s, pose, setpoints(scenario, time_s), reference, estimate, bias, demand, known,
        table[:, 18 : 18 + count], table[:, 18 + count :], tuple(told),
    )  # fmt: skip


def setpoints(scenario: Scenario, time_s: Array) -> Array:
    """Return the scenario's set-point (n, 3) at times (n,): east, north, yaw."""
    first = scenario.dp.setpoint
    out = np.tile([first.east_m, first.north_m, yaw_from_heading(first.heading_deg)], (len(time_s), 1))
    for point in scenario.dp.setpoints:
        out[time_s >= point.at_s] = [point.east_m, point.north_m, yaw_from_heading(point.heading_deg)]
    return out


def off_setpoint(run: Ride) -> tuple[Array, Array]:
    """Return how far the CoG is from the set-point (n,) [m], and the heading off it, clockwise (n,) [deg]."""
    off = run.pose - run.setpoint
    return np.hypot(off[:, 0], off[:, 1]), -np.rad2deg(wrapped(off[:, 2]))


def wrapped(angle: Array) -> Array:
    """Return angles (n,) within half a turn [rad]."""
    return np.array([wrap_angle(value) for value in angle])


def rms(values: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def during(run: Ride, from_s: float, to_s: float = np.inf) -> slice:
    """Return the rows of a time span."""
    return slice(*np.searchsorted(run.time_s, [from_s - 1e-6, to_s - 1e-6]))


def slow(values: Array, step_s: float, corner_hz: float = SLOW_HZ) -> Array:
    """Return what is slow of columns (n, k): a Butterworth filter of order 4, to and fro, so without delay."""
    filtered = signal.sosfiltfilt(signal.butter(4, corner_hz, fs=1.0 / step_s, output="sos"), values, axis=0)
    return np.asarray(filtered)


def to_level(vec_w: Array, yaw: Array) -> Array:
    """Return (east, north, yaw) components (n, 3) along the ship's heading (n,): surge, sway, yaw."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.column_stack([cos * vec_w[:, 0] + sin * vec_w[:, 1], cos * vec_w[:, 1] - sin * vec_w[:, 0], vec_w[:, 2]])

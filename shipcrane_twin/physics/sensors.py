"""What the ship's sensors report of the truth: position reference, gyro, motion reference unit, wind sensor.

One kernel serves them all. State of a sensor of n numbers, float64 (2 + n + (d + 1) n,): updates so far, place in the
ring, wandering bias (n), ring of the last d + 1 samples (d + 1, n) for a delay of d samples. The caller draws the
random numbers, 2 n at every update whatever happens, so that one sensor's settings do not shift another's noise.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import (
    cross,
    euler_from_matrix,
    matrix_from_quat,
    quat_from_euler,
    rotate_to_body,
    rotate_to_world,
    wrap_angle,
)


class SensorParams(NamedTuple):
    """Constants of a sensor of n numbers; stds and offset in the numbers' own units.

    Attributes
    ----------
    noise_std : float64, shape (n,)
        White, of each sample.
    offset : float64, shape (n,)
        Constant error.
    bias_std : float64, shape (n,)
        Stationary standard deviation of the wandering error, a first-order Gauss-Markov process.
    bias_memory : float64, shape (n,)
        Share of the wandering error left after a sample; 1 for an error that stays as drawn at the start.
    kind : float64, shape (n,)
        1 marks angles, brought into [-pi, pi); 2 marks magnitudes, never below zero; 0 all else.
    every : int
        Updates per sample.
    delay : int
        Samples by which the report lags behind.
    """

    noise_std: Array
    offset: Array
    bias_std: Array
    bias_memory: Array
    kind: Array
    every: int
    delay: int


PLAIN, ANGLE, MAGNITUDE = 0.0, 1.0, 2.0
POSITION_KINDS = np.array([PLAIN, PLAIN])
GYRO_KINDS = np.array([ANGLE])
MRU_KINDS = np.array([ANGLE, ANGLE, PLAIN, PLAIN, PLAIN, PLAIN, PLAIN, PLAIN])
WIND_KINDS = np.array([MAGNITUDE, ANGLE])


def sensor_params(
    kind: Array,
    update_s: float,
    *,
    noise_std: Array,
    offset: Array,
    bias_std: Array,
    bias_time_constant_s: float,
    sample_period_s: float,
    delay_s: float,
) -> SensorParams:
    """Return the constants of a sensor.

    Parameters
    ----------
    kind : float64, shape (n,)
        `PLAIN`, `ANGLE` or `MAGNITUDE`; `POSITION_KINDS` and its like.
    update_s : float
        Time between two calls [s].
    noise_std, offset, bias_std : float64, shape (n,)
    bias_time_constant_s : float
        Of the wandering error [s]; inf keeps it as drawn.
    sample_period_s, delay_s : float
        Whole multiples of the update's period, and of the sample's [s].

    Raises
    ------
    ValueError
        If a std is negative, a shape differs from that of ``kind``, or a time is no such multiple.
    """
    stds = np.array([noise_std, bias_std], dtype=np.float64)
    offset = np.array(offset, dtype=np.float64)
    if stds.shape != (2, kind.size) or offset.shape != kind.shape:
        raise ValueError(f"sensor: noise_std, offset and bias_std need {kind.size} values each")
    if not (np.all(stds >= 0.0) and np.all(np.isfinite(stds)) and np.all(np.isfinite(offset))):
        raise ValueError(f"sensor: noise_std {noise_std} and bias_std {bias_std} must be finite and >= 0")
    if not bias_time_constant_s > 0.0:
        raise ValueError(f"sensor: bias_time_constant_s is {bias_time_constant_s}, it must be > 0 (inf is allowed)")
    every = multiple("sample_period_s", sample_period_s, update_s, 1)
    memory = np.full(kind.size, np.exp(-sample_period_s / bias_time_constant_s))
    delay = multiple("delay_s", delay_s, sample_period_s, 0)
    return SensorParams(stds[0], offset, stds[1], memory, kind.astype(np.float64), every, delay)


def multiple(name: str, value: float, unit: float, least: int) -> int:
    """Return value / unit as a whole number; ValueError if it is none or below ``least``."""
    count = round(value / unit) if np.isfinite(value) and unit > 0.0 else -1
    if count < least or abs(value / unit - count) > 1e-6:
        raise ValueError(f"sensor: {name} is {value} s, it must be a whole multiple, at least {least}, of {unit} s")
    return count


def perfect_sensor(kind: Array) -> SensorParams:
    """Return the constants of a sensor that reports the truth at every update."""
    zero = np.zeros(kind.size)
    return SensorParams(zero, zero, zero, np.ones(kind.size), kind.astype(np.float64), 1, 0)


def sensor_start(params: SensorParams, draws: Array) -> Array:
    """Return the state before the first update; standard normal draws (n,) set the wandering error."""
    count = params.noise_std.size
    state = np.full(2 + count + (params.delay + 1) * count, np.nan)
    state[:2] = 0.0
    state[2 : 2 + count] = params.bias_std * draws
    return state


@njit(cache=True)
def sensor_step(
    params: SensorParams, state: Array, truth: Array, draws: Array, dropped: bool
) -> tuple[Array, Array]:
    """Return the state one update later and what the sensor reports now.

    Parameters
    ----------
    params : SensorParams
    state : float64, shape (2 + n + (d + 1) n,)
    truth : float64, shape (n,)
        Now; a number that is not finite is reported as missing.
    draws : float64, shape (2 n,)
        Standard normal: n for the noise, n for the wandering error.
    dropped : bool
        True while the sensor fails: a sample taken now is missing for good.

    Returns
    -------
    state : float64, shape (2 + n + (d + 1) n,)
    measured : float64, shape (n,)
        nan where there is no measurement: between samples, dropped, or before the first has come through.
    """
    count = truth.shape[0]
    new = state.copy()
    measured = np.full(count, np.nan)
    new[0] = (state[0] + 1.0) % params.every
    if state[0] != 0.0:
        return new, measured
    place = int(state[1])
    new[1] = (place + 1) % (params.delay + 1)
    ring = 2 + count
    for i in range(count):
        bias = state[2 + i]
        value = truth[i] + params.offset[i] + bias + params.noise_std[i] * draws[i]
        if params.kind[i] == ANGLE:
            value = wrap_angle(value)
        elif params.kind[i] == MAGNITUDE:
            value = max(0.0, value) if np.isfinite(value) else np.nan
        missing = dropped or not np.isfinite(value)
        new[ring + place * count + i] = np.nan if missing else value
        memory = params.bias_memory[i]
        new[2 + i] = memory * bias + params.bias_std[i] * np.sqrt(1.0 - memory * memory) * draws[count + i]
    oldest = int(new[1])  # the ring is just long enough that the next place to write holds the oldest sample
    for i in range(count):
        measured[i] = new[ring + oldest * count + i]
    return new, measured


@njit(cache=True)
def antenna_position(odom: Array, arm_b: Array) -> Array:
    """Return east and north (2,) [m] of a point of the ship.

    Parameters
    ----------
    odom : float64, shape (13,)
        Of base_link: position in the world, quaternion, velocity and angular velocity in body axes.
    arm_b : float64, shape (3,)
        The point seen from base_link [m].
    """
    return odom[:2] + rotate_to_world(matrix_from_quat(odom[3:7]), arm_b)[:2]


@njit(cache=True)
def gyro_heading(odom: Array) -> Array:
    """Return the yaw (1,) [rad] of an odometry (13,)."""
    return np.array([euler_from_matrix(matrix_from_quat(odom[3:7]))[2]])


@njit(cache=True)
def mru_motion(odom: Array, accel: Array, arm_b: Array, gravity: float) -> Array:
    """Return what a strapdown motion reference unit at a point of the ship feels.

    Parameters
    ----------
    odom : float64, shape (13,)
        Of base_link.
    accel : float64, shape (6,)
        Of base_link, body axes: acceleration in the world without gravity [m/s2], angular acceleration [rad/s2].
    arm_b : float64, shape (3,)
        The unit seen from base_link [m].
    gravity : float
        [m/s2].

    Returns
    -------
    float64, shape (8,)
        Roll, pitch [rad], angular velocity p, q, r [rad/s], specific force x, y, z [m/s2], body axes (FLU): at rest
        and upright the force is (0, 0, +g).
    """
    rot = matrix_from_quat(odom[3:7])
    omega = odom[10:13]
    force = accel[:3] + cross(accel[3:], arm_b) + cross(omega, cross(omega, arm_b)) + gravity * rot[2]
    roll, pitch, _ = euler_from_matrix(rot)
    return np.array([roll, pitch, omega[0], omega[1], omega[2], force[0], force[1], force[2]])


@njit(cache=True)
def vertical_acceleration(motion: Array, gravity: float) -> float:
    """Return the upward acceleration [m/s2] without gravity of a measured motion (8,), see `mru_motion`."""
    roll, pitch = motion[0], motion[1]
    up = np.cos(pitch) * (np.sin(roll) * motion[6] + np.cos(roll) * motion[7]) - np.sin(pitch) * motion[5]
    return up - gravity


@njit(cache=True)
def relative_wind(odom: Array, wind_w: Array, arm_b: Array) -> Array:
    """Return the wind (2,) that a sensor on the moving ship meets.

    Parameters
    ----------
    odom : float64, shape (13,)
        Of base_link.
    wind_w : float64, shape (3,)
        Velocity of the air, world [m/s].
    arm_b : float64, shape (3,)
        The sensor seen from base_link [m].

    Returns
    -------
    float64, shape (2,)
        Speed in the deck's plane [m/s]; direction it comes from relative to the bow, anticlockwise [rad].
    """
    air_b = rotate_to_body(matrix_from_quat(odom[3:7]), wind_w) - odom[7:10] - cross(odom[10:13], arm_b)
    return np.array([np.hypot(air_b[0], air_b[1]), np.arctan2(-air_b[1], -air_b[0])])


@njit(cache=True)
def reference_point(fix_w: Array, arm_b: Array, roll: float, pitch: float, yaw: float) -> Array:
    """Return east and north (2,) [m] of the point from which an antenna is seen at ``arm_b`` (3,) [m].

    Parameters
    ----------
    fix_w : float64, shape (2,)
        Measured position of the antenna [m]; nan stays nan.
    arm_b : float64, shape (3,)
    roll, pitch, yaw : float
        Measured attitude [rad]; a part that is not finite counts as zero, which leaves its lean in the fix.
    """
    attitude = quat_from_euler(
        roll if np.isfinite(roll) else 0.0, pitch if np.isfinite(pitch) else 0.0, yaw if np.isfinite(yaw) else 0.0
    )
    return fix_w - rotate_to_world(matrix_from_quat(attitude), arm_b)[:2]

"""Propellers of azimuth and tunnel thrusters: thrust, torque and power from shaft speed and inflow, and the inverse.

Row i of every array is one thruster. An azimuth [rad] runs anticlockwise from forward and is the direction of the
thrust on the ship; the jet goes the other way. State, float64 (n, 2): azimuth, shaft speed [rev/s].
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array


class PropulsionParams(NamedTuple):
    """Constants of the thrusters; float64, shape (n,), unless noted.

    Attributes
    ----------
    position : float64, shape (n, 3)
        Points of attack seen from the CoG, body axes [m].
    azimuthing : float64
        1 turns through all directions and pushes one way, 0 is a tunnel thruster that pushes both ways.
    diameter : float64
        Of the propeller [m].
    thrust_coefficient, torque_coefficient : float64
        KT0 and KQ0, of the propeller at rest in the water; from `bollard_coefficients`.
    deduction : float64
        Share of the propeller's thrust that hull or tunnel takes back.
    zero_thrust_advance, zero_torque_advance : float64
        Advance numbers J = V / (n D) at which the propeller gives no thrust and takes no torque.
    speed_max, speed_rate_max, speed_lag : float64
        Shaft speed [rev/s], its rate [rev/s2] and the lag of its loop [s].
    power_max, torque_max : float64
        Of the drive, at the shaft [W], [N m].
    rundown_lag : float64
        Time constant of a shaft without drive [s].
    azimuth_rate_max, azimuth_lag : float64
        Rate of the azimuth servo [rad/s] and its lag [s]; not read for tunnel thrusters.
    power_total_max : float
        Power for all thrusters together [W]; above it each gives up the same share.
    water_density : float
        [kg/m3].
    """

    position: Array
    azimuthing: Array
    diameter: Array
    thrust_coefficient: Array
    torque_coefficient: Array
    deduction: Array
    zero_thrust_advance: Array
    zero_torque_advance: Array
    speed_max: Array
    speed_rate_max: Array
    speed_lag: Array
    power_max: Array
    torque_max: Array
    rundown_lag: Array
    azimuth_rate_max: Array
    azimuth_lag: Array
    power_total_max: float
    water_density: float


def bollard_coefficients(
    thrust_max: Array, power_max: Array, diameter: Array, speed_max: Array, deduction: Array, water_density: float
) -> tuple[Array, Array]:
    """Return KT0 and KQ0 (n,) with which full power at full shaft speed gives the largest thrust, ship at rest.

    ``T = (1 - t) rho D^4 KT0 n^2`` and ``P = 2 pi rho D^5 KQ0 n^3``; units as in `PropulsionParams`.
    """
    thrust_coefficient = thrust_max / ((1.0 - deduction) * water_density * diameter**4 * speed_max**2)
    torque_coefficient = power_max / (2.0 * np.pi * water_density * diameter**5 * speed_max**3)
    return thrust_coefficient, torque_coefficient


@njit(cache=True)
def inflow_loss(speed: float, inflow: float, diameter: float, zero_advance: float) -> float:
    """Return what the inflow takes from ``n |n|`` [rev2/s2]: ``|n| V / (D J0)``, linear in the advance number.

    At most all of it: a windmilling propeller is drag of the hull. Inflow [m/s] from behind takes nothing.
    """
    ahead = inflow if speed > 0.0 else -inflow
    if not ahead > 0.0:
        return 0.0
    loss = min(abs(speed) * ahead / (diameter * zero_advance), speed * speed)
    return loss if speed > 0.0 else -loss


@njit(cache=True)
def propeller_thrust(params: PropulsionParams, i: int, speed: float, inflow: float) -> float:
    """Return the thrust on the ship [N] of thruster i at a shaft speed [rev/s] and an inflow along its axis [m/s].

    ``(1 - t) rho D^4 (KT0 n |n| - loss)``, Smogeli (2006), Control of marine propellers, eq. 2.10.
    """
    diameter = params.diameter[i]
    square = speed * abs(speed) - inflow_loss(speed, inflow, diameter, params.zero_thrust_advance[i])
    scale = (1.0 - params.deduction[i]) * params.water_density * diameter**4
    return scale * params.thrust_coefficient[i] * square


@njit(cache=True)
def propeller_power(params: PropulsionParams, i: int, speed: float, inflow: float) -> float:
    """Return the shaft power ``2 pi n Q`` [W] of thruster i; never negative."""
    diameter = params.diameter[i]
    square = speed * abs(speed) - inflow_loss(speed, inflow, diameter, params.zero_torque_advance[i])
    return 2.0 * np.pi * speed * params.water_density * diameter**5 * params.torque_coefficient[i] * square


@njit(cache=True)
def axis_inflow(params: PropulsionParams, i: int, azimuth: float, velocity_rel_b: Array) -> float:
    """Return the speed of thruster i through the water along its azimuth [m/s]."""
    x, y = params.position[i, 0], params.position[i, 1]
    surge, sway, turn = velocity_rel_b[0], velocity_rel_b[1], velocity_rel_b[2]
    return np.cos(azimuth) * (surge - turn * y) + np.sin(azimuth) * (sway + turn * x)


@njit(cache=True)
def speed_for_square(square: float, inflow: float, diameter: float, zero_advance: float) -> float:
    """Return the shaft speed [rev/s] whose ``n |n|`` less its inflow loss is ``square`` [rev2/s2]."""
    size = abs(square)
    if size == 0.0:
        return 0.0
    ahead = inflow if square > 0.0 else -inflow
    half = 0.5 * max(ahead, 0.0) / (diameter * zero_advance)
    speed = half + np.sqrt(half * half + size)
    return speed if square > 0.0 else -speed


@njit(cache=True)
def speed_for_thrust(params: PropulsionParams, state: Array, thrust: Array, velocity_rel_b: Array) -> Array:
    """Return the shaft speeds (n,) [rev/s] that give a thrust (n,) [N]: the thrust law inverted.

    Parameters
    ----------
    params : PropulsionParams
    state : float64, shape (n, 2)
        Its azimuths count for the inflow.
    thrust : float64, shape (n,)
        Azimuths push one way: their negative thrust becomes none.
    velocity_rel_b : float64, shape (3,)
        Of the CoG through the water: surge, sway [m/s], yaw rate [rad/s]; zeros for a law that knows no current.
    """
    out = np.empty(thrust.shape[0])
    for i in range(thrust.shape[0]):
        wanted = max(thrust[i], 0.0) if params.azimuthing[i] != 0.0 else thrust[i]
        diameter = params.diameter[i]
        scale = (1.0 - params.deduction[i]) * params.water_density * diameter**4 * params.thrust_coefficient[i]
        inflow = axis_inflow(params, i, state[i, 0], velocity_rel_b)
        out[i] = speed_for_square(wanted / scale, inflow, diameter, params.zero_thrust_advance[i])
    return out


@njit(cache=True)
def drive_limit(params: PropulsionParams, i: int, inflow: float) -> float:
    """Return the shaft speed [rev/s] that torque and power of drive i allow with inflow from ahead [m/s]."""
    diameter = params.diameter[i]
    scale = params.water_density * diameter**5 * params.torque_coefficient[i]
    by_torque = speed_for_square(params.torque_max[i] / scale, inflow, diameter, params.zero_torque_advance[i])
    half = 0.5 * max(inflow, 0.0) / (diameter * params.zero_torque_advance[i])
    cube = params.power_max[i] / (2.0 * np.pi * scale)
    # n^3 - 2 half n^2 = cube; Newton from above, where the cubic is convex and rises
    speed = 2.0 * half + cube ** (1.0 / 3.0)
    for _ in range(20):
        slope = speed * (3.0 * speed - 4.0 * half)
        if not slope > 0.0:
            break
        speed -= (speed * speed * (speed - 2.0 * half) - cube) / slope
    return min(min(by_torque, speed), params.speed_max[i])

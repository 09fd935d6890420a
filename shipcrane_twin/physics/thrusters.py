"""Thrusters as lagged, limited force vectors in the horizontal plane of the ship.

Row i of every array is one thruster. State, float64 (n, 2): forward and port thrust [N].
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array


class ThrusterParams(NamedTuple):
    """Constants of the thrusters.

    Attributes
    ----------
    position : float64, shape (n, 3)
        Points of attack seen from the CoG, body axes [m].
    thrust_max : float64, shape (n,)
        [N].
    azimuthing : float64, shape (n,)
        1 turns through all directions, 0 is a tunnel thruster that pushes sideways only.
    time_constant : float
        First-order lag from command to thrust [s].
    """

    position: Array
    thrust_max: Array
    azimuthing: Array
    time_constant: float


@njit(cache=True)
def limit_thrust(params: ThrusterParams, command: Array) -> Array:
    """Return the command (n, 2) [N] brought within each thruster's limits; direction is kept."""
    out = command.copy()
    for i in range(command.shape[0]):
        if params.azimuthing[i] == 0.0:
            out[i, 0] = 0.0
        size = np.sqrt(out[i, 0] ** 2 + out[i, 1] ** 2)
        if size > params.thrust_max[i]:
            out[i] *= params.thrust_max[i] / size
    return out


@njit(cache=True)
def thruster_step(params: ThrusterParams, state: Array, command: Array, step_s: float) -> tuple[Array, Array]:
    """Return thrust (n, 2) [N] at the end of a step and its mean over the step; exact for a held command."""
    target = limit_thrust(params, command)
    ratio = step_s / params.time_constant
    decay = np.exp(-ratio)
    mean_part = (1.0 - decay) / ratio
    return target + decay * (state - target), target + mean_part * (state - target)


@njit(cache=True)
def thruster_load(params: ThrusterParams, thrust: Array) -> Array:
    """Return force and moment (6,) about the CoG, body axes, of thrust (n, 2) [N]."""
    load = np.zeros(6)
    for i in range(thrust.shape[0]):
        fx, fy = thrust[i, 0], thrust[i, 1]
        x, y, z = params.position[i, 0], params.position[i, 1], params.position[i, 2]
        load[0] += fx
        load[1] += fy
        load[3] -= z * fy
        load[4] += z * fx
        load[5] += x * fy - y * fx
    return load

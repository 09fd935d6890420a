"""Memory of the water: the radiation part of Cummins's equation as linear second-order sections.

Cummins (1962) writes the load of the waves that a moving hull makes as ``-A_inf nu_dot`` and a convolution
of the past velocities. The convolution is the output of a linear system (Perez and Fossen 2009): for each of
the two blocks (surge, heave, pitch) and (sway, roll, yaw), every velocity drives p sections with poles
common to the block, and every load reads all of them.
"""

from typing import NamedTuple

from numba import njit

from shipcrane_twin.physics.arrays import Array


class RadiationParams(NamedTuple):
    """Sections and how they are read, about the CoG, level axes.

    Attributes
    ----------
    a : float64, shape (2, p, 2, 2)
        Sections of each block [1/s].
    b : float64, shape (2, p, 2)
        Input of a velocity to a section.
    c : float64, shape (2, 3, 3, p, 2)
        Load on mode i from the sections that mode j drives.
    """

    a: Array
    b: Array
    c: Array


@njit(cache=True)
def radiation_count(params: RadiationParams) -> int:
    """Return how many states the memory has."""
    return 12 * params.b.shape[1]


@njit(cache=True)
def add_memory_load(load: Array, params: RadiationParams, memory: Array, relative: Array, rate: Array) -> None:
    """Add to a load (6,) that of the memory, and write the memory's rate.

    Parameters
    ----------
    load : float64, shape (6,)
        About the CoG, level axes; changed in place.
    params : RadiationParams
    memory : float64, shape (12 p,)
        States by block, driving mode, section.
    relative : float64, shape (6,)
        Velocity relative to the water, level axes. A constant one gives no load in the end.
    rate : float64, shape (12 p,)
        Overwritten.
    """
    a, b, c = params.a, params.b, params.c
    sections = b.shape[1]
    at = 0
    for block in range(2):
        low = middle = high = 0.0
        for j in range(3):
            velocity = relative[block + 2 * j]
            for k in range(sections):
                first, second = memory[at], memory[at + 1]
                rate[at] = a[block, k, 0, 0] * first + a[block, k, 0, 1] * second + b[block, k, 0] * velocity
                rate[at + 1] = a[block, k, 1, 0] * first + a[block, k, 1, 1] * second + b[block, k, 1] * velocity
                low += c[block, 0, j, k, 0] * first + c[block, 0, j, k, 1] * second
                middle += c[block, 1, j, k, 0] * first + c[block, 1, j, k, 1] * second
                high += c[block, 2, j, k, 0] * first + c[block, 2, j, k, 1] * second
                at += 2
        load[block] -= low
        load[block + 2] -= middle
        load[block + 4] -= high

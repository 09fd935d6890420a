"""Place and heading without their motion at wave frequency: where waves act, and along which axes water loads do."""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array


def follower(period_s: float, step_s: float) -> Array:
    """Return the coefficients (2, 3) of a critically damped low-pass of second order.

    Parameters
    ----------
    period_s : float
        Natural period [s]; 0 follows at once.
    step_s : float
        [s].

    Notes
    -----
    Exact for an input held over the step: ``(y, y')`` becomes ``F (y, y') + g u``; rows are ``F_i0, F_i1, g_i``.
    """
    if period_s == 0.0:
        return np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    rate = 2.0 * np.pi / period_s
    turn = rate * step_s
    free = np.exp(-turn) * np.array([[1.0 + turn, step_s], [-rate * turn, 1.0 - turn]])
    return np.column_stack((free, np.array([1.0, 0.0]) - free[:, 0]))


@njit(cache=True)
def follow(rows: Array, value: float, rate: float, target: float) -> tuple[float, float]:
    """Return value and rate one step later; ``rows`` (2, 3) come from `follower`."""
    return (
        rows[0, 0] * value + rows[0, 1] * rate + rows[0, 2] * target,
        rows[1, 0] * value + rows[1, 1] * rate + rows[1, 2] * target,
    )


@njit(cache=True)
def follow_angle(rows: Array, value: float, rate: float, target: float) -> tuple[float, float]:
    """Return angle and rate one step later, the shorter way round [rad, rad/s]; see `follow`."""
    turns = np.floor((target - value) / (2.0 * np.pi) + 0.5)
    return follow(rows, value, rate, target - 2.0 * np.pi * turns)

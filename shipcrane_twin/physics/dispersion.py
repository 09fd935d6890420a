"""Linear dispersion of water waves."""

import numpy as np

from shipcrane_twin.physics.arrays import Array


def wave_numbers(omega: Array, gravity: float, depth: float) -> Array:
    """Return the wave numbers [1/m] of frequencies [rad/s] in water of a depth [m], ``inf`` for deep.

    Parameters
    ----------
    omega : float64, shape (n,)
        Positive frequencies.
    gravity, depth : float

    Notes
    -----
    Newton's method on ``k tanh(k d) = w^2 / g`` from the start of Fenton and McKee (1990), whose error
    is at most 1.5 %; five rounds reach rounding error.
    """
    deep = np.asarray(omega, float) ** 2 / gravity
    if np.isinf(depth):
        return deep
    number = deep / np.tanh((deep * depth) ** 0.75) ** (2.0 / 3.0)
    for _ in range(5):
        tanh = np.tanh(number * depth)
        slope = tanh + number * depth * (1.0 - tanh * tanh)
        number = number - (number * tanh - deep) / slope
    return number

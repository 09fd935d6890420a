"""Retardation functions from damping, and the added mass at infinite frequency that goes with them."""

from __future__ import annotations

import numpy as np

from shipcrane_twin.physics.arrays import Array

STEPS = 4000


def retardation(omega: Array, damping: Array, time: Array) -> Array:
    """Return the retardation functions ``K(t) = (2/pi) int_0^inf B(w) cos(w t) dw``.

    Parameters
    ----------
    omega : float64, shape (n,)
        Rising [rad/s].
    damping : float64, shape (n, ...)
    time : float64, shape (k,)
        Not negative [s].

    Returns
    -------
    float64, shape (k, ...)
        [damping/s]

    Notes
    -----
    Ogilvie (1964). Damping starts from zero at w = 0 and falls as ``w^-3`` above the table, a common rule; with a
    table that ends early K(t) below ``1/w_end`` is that rule's.
    """
    return 2.0 / np.pi * transform(np.cos, *extended(omega, damping), time)


def infinite_added_mass(omega: Array, added_mass: Array, damping: Array) -> Array:
    """Return the added mass at infinite frequency from a table that lacks it.

    Parameters
    ----------
    omega : float64, shape (n,)
    added_mass, damping : float64, shape (n, 6, 6)

    Notes
    -----
    ``A_inf = A(w) + (1/w) int_0^inf K(t) sin(w t) dt`` (Ogilvie 1964) with K from the damping, as the mean over the
    upper half of the table, where a small error of the integral counts least.
    """
    grid, values = extended(omega, damping)
    upper = omega >= np.median(omega)
    time = np.linspace(0.0, 60.0, 3001)
    kernel = 2.0 / np.pi * transform(np.cos, grid, values, time)
    sine = transform(np.sin, time, kernel, omega[upper])
    return np.asarray((added_mass[upper] + sine / omega[upper, None, None]).mean(axis=0))


def extended(omega: Array, damping: Array) -> tuple[Array, Array]:
    """Return a damping table on an even grid from 0 to four times its last frequency."""
    grid = np.linspace(0.0, 4.0 * omega[-1], STEPS)
    flat = damping.reshape(len(omega), -1)
    known = np.concatenate([np.zeros((1, flat.shape[1])), flat])
    at = np.concatenate([[0.0], omega])
    tail = np.minimum(1.0, omega[-1] / np.maximum(grid, omega[-1])) ** 3
    values = np.stack([np.interp(grid, at, column) for column in known.T], axis=1) * tail[:, None]
    return grid, values.reshape(-1, *damping.shape[1:])


def transform(wave: np.ufunc, x: Array, values: Array, y: Array) -> Array:
    """Return ``int values(x) wave(x y) dx`` by the trapezium rule, shape (k, ...)."""
    weights = np.gradient(x)
    weights[[0, -1]] *= 0.5
    flat = values.reshape(len(x), -1) * weights[:, None]
    out = wave(np.outer(y, x)) @ flat
    return np.asarray(out.reshape(len(y), *values.shape[1:]))

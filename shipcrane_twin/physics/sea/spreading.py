"""How wave energy spreads over directions about the main one."""

import numpy as np
from scipy.special import betaincinv, gammaln

from shipcrane_twin.physics.arrays import Array


def spreading_density(angle: Array, exponent: float) -> Array:
    """Return the share of energy per angle (n,) [1/rad]; its integral over -pi to pi is 1.

    Parameters
    ----------
    angle : float64, shape (n,)
        From the main direction, in [-pi, pi] [rad].
    exponent : float
        The s of ``cos^2s(angle / 2)``, 0 (all directions alike) and above.

    Notes
    -----
    Longuet-Higgins, Cartwright and Smith (1963); DNV-RP-C205 section 3.5. Its other form, ``cos^n`` of the
    whole angle, is about ``s = 2 n + 1``.
    """
    check_exponent(exponent)
    scale = np.exp(gammaln(exponent + 1.0) - gammaln(exponent + 0.5)) / (2.0 * np.sqrt(np.pi))
    return scale * np.cos(0.5 * np.asarray(angle)) ** (2.0 * exponent)


def spreading_angle(quantile: Array, exponent: float) -> Array:
    """Return the angles (n,) [rad] below which these shares (n,) of the energy go.

    Parameters
    ----------
    quantile : float64, shape (n,)
        In [0, 1].
    exponent : float
        See `spreading_density`; ``inf`` is a long-crested sea, all angles zero.

    Notes
    -----
    ``sin^2(angle / 2)`` follows a beta distribution with 1/2 and s + 1/2.
    """
    check_exponent(exponent)
    if np.isinf(exponent):
        return np.zeros(len(quantile))
    side = 2.0 * np.asarray(quantile) - 1.0
    return np.sign(side) * 2.0 * np.arcsin(np.sqrt(betaincinv(0.5, exponent + 0.5, np.abs(side))))


def check_exponent(exponent: float) -> None:
    """Refuse a negative exponent."""
    if not exponent >= 0.0:
        raise ValueError(f"spreading: the exponent s is {exponent:g}, expected 0 or more (inf: long-crested)")

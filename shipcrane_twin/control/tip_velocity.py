"""Commands for the crane's tip: joint rates that move it as asked, bounded near singular poses."""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_chain import ChainParams, tip_jacobian
from shipcrane_twin.physics.crane_cylinders import joint_rates_per_length, lengths_from_joints
from shipcrane_twin.physics.crane_reference import MotionLimits
from shipcrane_twin.physics.frames import rotate_to_body
from shipcrane_twin.physics.linalg import factorise, solve_factorised

DAMPING = 0.02
"""Tip speed that a joint at full speed must be worth for half its gain, over the best joint's [-]."""


@njit(cache=True)
def tip_joint_rates(chain: ChainParams, limits: MotionLimits, q: Array, velocity_b: Array) -> Array:
    """Return joint rates (n,) [rad/s, m/s] for a velocity of the tip against the crane's base.

    Parameters
    ----------
    chain, limits : ChainParams, MotionLimits
    q : float64, shape (n,)
        Joint values.
    velocity_b : float64, shape (3,)
        In crane_base axes [m/s]; anything not finite counts as zero.

    Notes
    -----
    Damped least squares (Nakamura and Hanafusa 1986; Wampler 1986) over the joint rates as shares u of their
    greatest: ``u = A^T (A A^T + d^2)^-1 v`` with ``A = J diag(rate_max)``, which stays below ``|v| / (2 d)`` in every
    pose. Joints at an end that would have to move into it are left out. All rates shrink together when one would be
    too fast, so the direction stays.
    """
    n = q.shape[0]
    jacobian = tip_jacobian(chain, q)
    lengths = lengths_from_joints(limits.drives, q)
    fastest = limits.rate_max * np.abs(joint_rates_per_length(limits.drives, q))
    part = np.empty((3, n))
    for k in range(3):
        for i in range(n):
            part[k, i] = jacobian[k, i] * fastest[i]
    wanted = np.zeros(3)
    for k in range(3):
        if np.isfinite(velocity_b[k]):
            wanted[k] = velocity_b[k]
    damping = DAMPING * np.sqrt(np.max(part[0] ** 2 + part[1] ** 2 + part[2] ** 2)) + 1e-12
    share = np.zeros(n)
    for _ in range(n):
        share = _damped_shares(part, wanted, damping)
        left_out = False
        for i in range(n):
            blocked = (share[i] > 0.0 and lengths[i] >= limits.high[i]) or (
                share[i] < 0.0 and lengths[i] <= limits.low[i]
            )
            if blocked:
                part[:, i] = 0.0
                left_out = True
        if not left_out:
            break
    most = max(1.0, np.max(np.abs(share)))
    rates = np.empty(n)
    for i in range(n):
        rates[i] = share[i] / most * fastest[i]
    return rates


@njit(cache=True)
def _damped_shares(part: Array, wanted: Array, damping: float) -> Array:
    n = part.shape[1]
    square, x = np.zeros((3, 3)), wanted.copy()
    for k in range(3):
        for m in range(3):
            for i in range(n):
                square[k, m] += part[k, i] * part[m, i]
        square[k, k] += damping * damping
    factorise(square)
    solve_factorised(square, x)
    share = np.zeros(n)
    for i in range(n):
        for k in range(3):
            share[i] += part[k, i] * x[k]
    return share


@njit(cache=True)
def tip_joint_rates_level(
    chain: ChainParams, limits: MotionLimits, q: Array, velocity_w: Array, rot: Array
) -> Array:
    """Return joint rates (n,) for a tip velocity (3,) against the ship, in world axes; rot (3, 3) is ship to world."""
    return tip_joint_rates(chain, limits, q, rotate_to_body(rot, velocity_w))

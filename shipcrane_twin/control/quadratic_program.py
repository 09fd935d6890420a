"""Small convex quadratic programs with a diagonal Hessian: dual active set, the same bits every time.

Own code, because a control law here is one compiled kernel over numpy, scipy and numba: a solver behind a Python call
would break that for a program of nine unknowns. It needs no feasible start, no tolerance that trades accuracy for
time, and ends after finitely many exact steps.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shipcrane_twin.physics.arrays import Array

IntArray = NDArray[np.int64]

DEPENDENT = 1e-20
"""Squared share of a unit normal outside the active ones below which it counts as dependent on them."""


@njit(cache=True)
def solve_qp(weight: Array, centre: Array, rows: Array, limits: Array, equalities: int) -> tuple[Array, Array, bool]:
    """Return the point nearest to ``centre`` that keeps linear constraints.

    Minimises ``sum(weight * (x - centre)**2) / 2`` subject to ``rows @ x = limits`` in the first ``equalities`` rows
    and ``rows @ x >= limits`` in the others.

    Parameters
    ----------
    weight : float64, shape (n,)
        Positive.
    centre : float64, shape (n,)
    rows : float64, shape (m, n)
    limits : float64, shape (m,)
    equalities : int

    Returns
    -------
    x : float64, shape (n,)
    multiplier : float64, shape (m,)
        Of the rows: ``weight * (x - centre) = rows.T @ multiplier``; not negative for inequalities.
    solved : bool
        False if no point keeps the constraints, or a number is not finite; x is then of no use.

    Notes
    -----
    Goldfarb and Idnani (1983), Mathematical Programming 27, 1-33, for the identity as Hessian (unknowns are scaled by
    the roots of their weights, rows to unit length). ``basis`` holds an orthonormal basis whose first columns span the
    normals of the active constraints, ``basis[:, :q] @ upper = active normals``.
    """
    count, n = rows.shape
    root = np.empty(n)
    for j in range(n):
        root[j] = np.sqrt(weight[j])
    normal, bound, length, sound = scaled_rows(root, centre, rows, limits, equalities)
    multiplier = np.zeros(count)
    if not sound:
        return centre.copy(), multiplier, False
    z = np.zeros(n)
    basis, upper = np.zeros((n, n)), np.zeros((n, n))
    for j in range(n):
        basis[j, j] = 1.0
    active, push, sign = np.zeros(n, dtype=np.int64), np.zeros(n), np.ones(count)
    q = 0
    solved = False
    for _ in range(10 * (count + n)):
        new, side = most_violated(normal, bound, z, active, q, equalities)
        if new < 0:
            solved = True
            break
        q = take_up(normal, bound, side, new, z, basis, upper, active, push, q, equalities)
        if q < 0:
            return centre.copy(), multiplier, False
        sign[new] = side
    for j in range(q):
        multiplier[active[j]] = sign[active[j]] * push[j] / length[active[j]]
    for j in range(n):
        z[j] = centre[j] + z[j] / root[j]
    return z, multiplier, solved


@njit(cache=True)
def scaled_rows(
    root: Array, centre: Array, rows: Array, limits: Array, equalities: int
) -> tuple[Array, Array, Array, bool]:
    """Return unit normals and bounds for ``z = root * (x - centre)``, the lengths cut, and if z can exist at all."""
    count = rows.shape[0]
    normal, bound, length = rows.copy(), limits.copy(), np.empty(count)
    for i in range(count):
        size = 0.0
        for j in range(root.shape[0]):
            normal[i, j] /= root[j]
            size += normal[i, j] ** 2
            bound[i] -= rows[i, j] * centre[j]
        length[i] = np.sqrt(size)
        if not np.isfinite(size + bound[i]):
            return normal, bound, length, False
        if size > 0.0:
            for j in range(root.shape[0]):
                normal[i, j] /= length[i]
            bound[i] /= length[i]
        elif bound[i] > 0.0 or (i < equalities and bound[i] < 0.0):
            return normal, bound, length, False
    return normal, bound, length, True


@njit(cache=True)
def take_up(
    normal: Array,
    bound: Array,
    side: float,
    new: int,
    z: Array,
    basis: Array,
    upper: Array,
    active: IntArray,
    push: Array,
    q: int,
    equalities: int,
) -> int:
    """Move z, in place, until constraint ``new`` is active; return the number of active ones, -1 if it cannot be.

    On the way inequalities that would begin to pull leave the active set; ``push`` holds the multipliers.
    """
    n = z.shape[0]
    gap = side * bound[new]
    for j in range(n):
        gap -= side * normal[new, j] * z[j]
    added = 0.0
    while True:
        share, free = split_normal(basis, normal, side, new, q)
        effect = back_substitute(upper, share, q)
        partial, leaving = longest_step(active, push, effect, q, equalities)
        full = gap / free if free > DEPENDENT else np.inf
        step = min(partial, full)
        if not step < np.inf:
            return -1
        if free > DEPENDENT:
            for k in range(n):
                for j in range(q, n):
                    z[k] += step * basis[k, j] * share[j]
            gap -= step * free
        for j in range(q):
            push[j] -= step * effect[j]
        added += step
        if step == full:
            active[q], push[q] = new, added
            add_column(basis, upper, share, q)
            return q + 1
        remove_column(basis, upper, leaving, q)
        for j in range(leaving, q - 1):
            active[j], push[j] = active[j + 1], push[j + 1]
        q -= 1


@njit(cache=True)
def most_violated(
    normal: Array, bound: Array, z: Array, active: IntArray, q: int, equalities: int
) -> tuple[int, float]:
    """Return the constraint to take up next, -1 for none, and the sign of its normal; equalities come first."""
    size = 10.0
    for value in z:
        size = max(size, abs(value))
    taken = np.zeros(normal.shape[0], dtype=np.bool_)
    for j in range(q):
        taken[active[j]] = True
    worst, found, side = -1e-13 * size, -1, 1.0
    for i in range(normal.shape[0]):
        if taken[i]:
            continue
        margin = -bound[i]
        for j in range(z.shape[0]):
            margin += normal[i, j] * z[j]
        if i < equalities:
            if margin != 0.0:
                return i, -1.0 if margin > 0.0 else 1.0
        elif margin < worst:
            worst, found = margin, i
    return found, side


@njit(cache=True)
def longest_step(active: IntArray, push: Array, effect: Array, q: int, equalities: int) -> tuple[float, int]:
    """Return the step at which the first active inequality would begin to pull, and its place; inf and -1 for none."""
    step, leaving = np.inf, -1
    for j in range(q):
        if active[j] >= equalities and effect[j] > 0.0 and push[j] / effect[j] < step:
            step, leaving = push[j] / effect[j], j
    return step, leaving


@njit(cache=True)
def split_normal(basis: Array, normal: Array, side: float, new: int, q: int) -> tuple[Array, float]:
    """Return ``side * normal[new]`` in the basis (n,), and its squared length outside the q active normals."""
    n = basis.shape[0]
    share, free = np.zeros(n), 0.0
    for k in range(n):
        for j in range(n):
            share[j] += basis[k, j] * side * normal[new, k]
    for j in range(q, n):
        free += share[j] ** 2
    return share, free


@njit(cache=True)
def back_substitute(upper: Array, share: Array, q: int) -> Array:
    """Return ``upper[:q, :q]^-1 @ share[:q]`` (n,), zeros behind."""
    out = np.zeros(share.shape[0])
    for i in range(q - 1, -1, -1):
        value = share[i]
        for j in range(i + 1, q):
            value -= upper[i, j] * out[j]
        out[i] = value / upper[i, i]
    return out


@njit(cache=True)
def add_column(basis: Array, upper: Array, share: Array, q: int) -> None:
    """Turn the basis, in place, so that its column q takes the part of the new normal outside the active ones."""
    n = share.shape[0]
    for j in range(n - 1, q, -1):
        radius = np.hypot(share[j - 1], share[j])
        if radius == 0.0:
            continue
        cos, sin = share[j - 1] / radius, share[j] / radius
        share[j - 1], share[j] = radius, 0.0
        for k in range(n):
            a, b = basis[k, j - 1], basis[k, j]
            basis[k, j - 1], basis[k, j] = cos * a + sin * b, cos * b - sin * a
    for k in range(q + 1):
        upper[k, q] = share[k]


@njit(cache=True)
def remove_column(basis: Array, upper: Array, leaving: int, q: int) -> None:
    """Take an active normal out of the factors, in place."""
    n = basis.shape[0]
    for j in range(leaving, q - 1):
        for k in range(j + 2):
            upper[k, j] = upper[k, j + 1]
        radius = np.hypot(upper[j, j], upper[j + 1, j])
        if radius == 0.0:
            continue
        cos, sin = upper[j, j] / radius, upper[j + 1, j] / radius
        upper[j, j], upper[j + 1, j] = radius, 0.0
        for k in range(j + 2, q):
            a, b = upper[j, k], upper[j + 1, k]
            upper[j, k], upper[j + 1, k] = cos * a + sin * b, cos * b - sin * a
        for k in range(n):
            a, b = basis[k, j], basis[k, j + 1]
            basis[k, j], basis[k, j + 1] = cos * a + sin * b, cos * b - sin * a

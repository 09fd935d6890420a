"""Small dense algebra for the kernels."""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array


@njit(cache=True)
def solve_spd(matrix: Array, rhs: Array) -> Array:
    """Solve ``matrix @ x = rhs`` for a symmetric positive definite matrix by Cholesky's method.

    Own code because numba's LAPACK calls cost more than the whole solve at these sizes.

    Parameters
    ----------
    matrix : float64, shape (n, n)
        Only the lower triangle is read.
    rhs : float64, shape (n,)

    Returns
    -------
    float64, shape (n,)

    Raises
    ------
    ValueError
        If the matrix is not positive definite.
    """
    n = rhs.shape[0]
    low = np.empty((n, n))
    x = np.empty(n)
    for i in range(n):
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= low[i, k] * low[j, k]
            if i == j:
                if total <= 0.0:
                    raise ValueError("solve_spd: the matrix is not positive definite")
                low[i, i] = np.sqrt(total)
            else:
                low[i, j] = total / low[j, j]
    for i in range(n):
        total = rhs[i]
        for k in range(i):
            total -= low[i, k] * x[k]
        x[i] = total / low[i, i]
    for i in range(n - 1, -1, -1):
        total = x[i]
        for k in range(i + 1, n):
            total -= low[k, i] * x[k]
        x[i] = total / low[i, i]
    return x

"""Small dense algebra for the kernels."""

from numba import njit

from shipcrane_twin.physics.arrays import Array


@njit(cache=True)
def row_dot(matrix: Array, i: int, x: Array) -> float:
    """Return row i of ``matrix @ x`` for a matrix (n, 6)."""
    return (
        (matrix[i, 0] * x[0] + matrix[i, 1] * x[1])
        + (matrix[i, 2] * x[2] + matrix[i, 3] * x[3])
        + (matrix[i, 4] * x[4] + matrix[i, 5] * x[5])
    )


@njit(cache=True)
def factorise(matrix: Array) -> bool:
    """Replace a symmetric positive definite matrix (n, n) by its factors L D L^T, in the lower triangle.

    Return False, with the matrix spoilt, if a pivot is not positive, as with a value that is not a number.
    """
    n = matrix.shape[0]
    for j in range(n):
        pivot = matrix[j, j]
        for k in range(j):
            pivot -= matrix[j, k] * matrix[j, k] * matrix[k, k]
        if not pivot > 0.0:
            return False
        matrix[j, j] = pivot
        for i in range(j + 1, n):
            element = matrix[i, j]
            for k in range(j):
                element -= matrix[i, k] * matrix[j, k] * matrix[k, k]
            matrix[i, j] = element / pivot
    return True


@njit(cache=True)
def solve_factorised(factors: Array, x: Array) -> None:
    """Replace x (n,) by the solution of the equations whose matrix was factorised."""
    n = x.shape[0]
    for i in range(n):
        for k in range(i):
            x[i] -= factors[i, k] * x[k]
    for i in range(n - 1, -1, -1):
        x[i] /= factors[i, i]
        for k in range(i + 1, n):
            x[i] -= factors[k, i] * x[k]


@njit(cache=True)
def solve_in_place(matrix: Array, x: Array) -> bool:
    """Replace x (n,) by matrix^-1 x for a symmetric positive definite matrix, which becomes L D L^T.

    Return False if the matrix is not positive definite.
    """
    if not factorise(matrix):
        return False
    solve_factorised(matrix, x)
    return True


@njit(cache=True)
def solve_spd(matrix: Array, rhs: Array) -> Array:
    """Return x (n,) with ``matrix @ x = rhs`` for a symmetric positive definite matrix (n, n).

    Own code because numba's LAPACK calls cost more than the whole solve at these sizes.

    Raises
    ------
    ValueError
        If the matrix is not positive definite.
    """
    x = rhs.copy()
    if not solve_in_place(matrix.copy(), x):
        raise ValueError("solve_spd: the matrix is not positive definite")
    return x

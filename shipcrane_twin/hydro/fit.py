"""State-space models of the radiation memory: common poles by vector fitting, passive residues by a convex fit."""

from importlib import import_module
from typing import Any

import numpy as np
from scipy.linalg import block_diag, null_space, qr, solve_continuous_lyapunov

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import LATERAL, LONGITUDINAL, Complex, RadiationFit
from shipcrane_twin.physics.arrays import Array

SECTIONS = 4
"""Second-order sections of a block; 8 poles."""
POLE_MAX = 15.0
"""Fastest pole [rad/s]; a Runge-Kutta step of 20 ms stays accurate."""
POLE_DAMPING_MIN = 0.02
"""Slowest decay of a pole [1/s]; memory ends within a few minutes."""
APART = 0.03
"""Least distance of two poles, as a share of their size."""
UPPER = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
"""The entries of a symmetric block."""
ROUNDS = 25
"""Relocations of the poles; they rest after about ten."""


def fit_radiation(omega: Array, added_mass: Array, damping: Array, added_mass_inf: Array) -> RadiationFit:
    """Return a passive state-space model of ``K(iw) = B(w) + i w (A(w) - A_inf)``.

    Parameters
    ----------
    omega : float64, shape (n,)
        Positive, rising [rad/s].
    added_mass, damping : float64, shape (n, 6, 6)
        Symmetric; no coupling between surge, heave, pitch and sway, roll, yaw is read.
    added_mass_inf : float64, shape (6, 6)

    Returns
    -------
    RadiationFit
        Two blocks of four sections each; Re K(iw) has no negative eigenvalue at any frequency, K(0) = 0, poles stable
        and at most 15 rad/s.

    Raises
    ------
    ConfigError
        If cvxpy is not installed, or the fit finds no solution.

    Notes
    -----
    Poles by vector fitting (Gustavsen and Semlyen 1999) over all entries of a block at once, residues by the
    positive-real lemma: ``C = B^T P`` with ``A^T P + P A <= 0`` (Coelho, Phillips and Silveira 2004; K(0) = 0 and
    passivity of ship memory: Perez and Fossen 2009). Above the last frequency there are no data; what the model
    does there is bounded by passivity, and its integral by ``A(w) - A_inf`` below.
    """
    memory = damping + 1j * omega[:, None, None] * (added_mass - added_mass_inf)
    blocks = [fit_block(omega, memory[np.ix_(range(len(omega)), modes, modes)]) for modes in (LONGITUDINAL, LATERAL)]
    a, b, c = (np.stack(parts) for parts in zip(*blocks, strict=True))
    return RadiationFit(a=a, b=b, c=c)


def fit_block(omega: Array, memory: Complex) -> tuple[Array, Array, Array]:
    """Return a (p, 2, 2), b (p, 2) and c (3, 3, p, 2) of one block from K(iw), shape (n, 3, 3)."""
    scale = np.sqrt(np.abs(np.diagonal(memory, axis1=1, axis2=2)).max(axis=0))
    if not scale.any():  # a source that has no memory in these modes
        a, b = sections(start_poles(omega))
        return a, b, np.zeros((3, 3, *b.shape))
    scale = np.maximum(scale, 1e-6 * scale.max())
    target = memory / np.outer(scale, scale)
    target = 0.5 * (target + np.swapaxes(target, 1, 2))
    weight = np.sqrt(np.gradient(omega))
    poles = fit_poles(omega, np.stack([target[:, i, j] for i, j in UPPER]), weight)
    a, b = sections(poles)
    c = fit_residues(omega, target, weight, a, b)
    return a, b, c * np.outer(scale, scale)[:, :, None, None]


def fit_poles(omega: Array, responses: Complex, weight: Array) -> Complex:
    """Return eight poles (8,) common to the responses (r, n), conjugates included.

    A response of zero at zero frequency counts as a measured point, with the weight of all others together, because
    the residues will have to fulfil it.
    """
    points = np.concatenate([[0.0], omega])
    heavy = np.concatenate([[np.sqrt((weight**2).sum())], weight])
    values = np.concatenate([np.zeros((len(responses), 1)), responses], axis=1)
    poles = start_poles(omega)
    for _ in range(ROUNDS):
        a, b = sections(poles)
        basis = states(points, a, b) * heavy[:, None]
        known = as_real(basis)
        rows, right = [], []
        for value in values:
            # the residues of each response are eliminated, what is left decides on the poles all share
            system = np.concatenate([known, as_real(-value[:, None] * basis)], axis=1)
            q, r = qr(system, mode="economic")
            rows.append(r[2 * SECTIONS :, 2 * SECTIONS :])
            right.append((q.T @ as_real(value * heavy))[2 * SECTIONS :])
        shift = np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=None)[0]
        moved = np.linalg.eigvals(block_diag(*a) - np.outer(b.ravel(), shift))
        poles = admissible(moved)
    return poles


def start_poles(omega: Array) -> Complex:
    """Return lightly damped poles over the frequencies, from which the fit starts."""
    start = np.geomspace(max(0.5 * omega[0], 0.1), omega[-1], SECTIONS)
    return np.concatenate([start * (-0.2 + 1j), start * (-0.2 - 1j)])


def admissible(poles: Complex) -> Complex:
    """Return poles mirrored to the stable side, slower than POLE_MAX, decaying, and no two of them alike.

    Equal poles, which data of fewer dynamics bring about, would make states that no velocity reaches.
    """
    poles = np.minimum(-np.abs(poles.real), -POLE_DAMPING_MIN) + 1j * poles.imag
    poles = poles * np.minimum(1.0, POLE_MAX / np.abs(poles))
    out: list[complex] = []
    for pole in sorted(poles[poles.imag >= 0.0].tolist(), key=abs, reverse=True):
        apart = pole
        while any(abs(apart - other) < APART * abs(apart) for other in out):
            apart *= 1.0 - 2.0 * APART
        out.append(apart)
    upper = np.array(out)
    return np.concatenate([upper, upper[upper.imag > 0.0].conj()])


def sections(poles: Complex) -> tuple[Array, Array]:
    """Return second-order sections a (p, 2, 2), b (p, 2) with these poles: conjugate pairs, then real poles by twos."""
    above = poles[poles.imag > 1e-9]
    real = np.sort(poles[np.abs(poles.imag) <= 1e-9].real)
    a = [[[p.real, p.imag], [-p.imag, p.real]] for p in above[np.argsort(np.abs(above))]]
    a += [[[first, 0.0], [0.0, second]] for first, second in real.reshape(-1, 2)]
    b = [[1.0, 0.0]] * len(above) + [[1.0, 1.0]] * (len(real) // 2)
    return np.array(a), np.array(b)


def states(omega: Array, a: Array, b: Array) -> Complex:
    """Return the state responses (n, 2 p) of all sections to a unit velocity at frequencies (n,)."""
    pencil = 1j * omega[:, None, None, None] * np.eye(2) - a
    pushed = np.broadcast_to(b[..., None], (*pencil.shape[:3], 1))
    return np.linalg.solve(pencil, pushed).reshape(len(omega), -1).astype(np.complex128)


def as_real(values: Any) -> Array:
    """Return complex rows as twice as many real ones."""
    return np.concatenate([values.real, values.imag])


def load_cvxpy() -> Any:
    """Import cvxpy, or say how to get it."""
    try:
        return import_module("cvxpy")
    except ImportError:
        raise ConfigError(
            "the state-space fit needs cvxpy; install it with `pip install shipcrane_twin[hydro]`"
        ) from None


def fit_residues(omega: Array, target: Complex, weight: Array, a: Array, b: Array) -> Array:
    """Return c (3, 3, p, 2), symmetric in its first two axes, that makes a passive model closest to K(iw) (n, 3, 3).

    Notes
    -----
    K(0) = 0 leaves ``Q = -(A^T P + P A)`` no interior: ``Q A^-1 B = 0``. Q is therefore sought on the complement of
    A^-1 B only (facial reduction), which fulfils K(0) = 0 and keeps the solver well conditioned.
    """
    cvxpy = load_cvxpy()
    size = 3 * b.size
    # states whose responses are orthonormal: neighbouring poles would leave the solver without digits
    one, push = block_diag(*a), b.reshape(-1, 1)
    root = np.linalg.cholesky(solve_continuous_lyapunov(one, -push @ push.T))
    state = np.kron(np.eye(3), np.linalg.solve(root, one @ root))
    entry = np.kron(np.eye(3), np.linalg.solve(root, push))
    face = null_space(np.linalg.solve(state, entry).T)
    rank = face.shape[1]
    # P follows linearly from Q: one Lyapunov equation per entry of Q on the face
    gains = np.empty((rank, rank, 3, size))
    for i, j in zip(*np.tril_indices(rank), strict=True):
        loss = 0.5 * (np.outer(face[:, i], face[:, j]) + np.outer(face[:, j], face[:, i]))
        gains[i, j] = gains[j, i] = entry.T @ solve_continuous_lyapunov(state.T, -loss)
    # the sums over frequencies shrink to one triangle per entry
    q, r = np.linalg.qr(as_real(states(omega, a, b) @ np.linalg.inv(root).T * weight[:, None]))
    free = cvxpy.Variable((rank, rank), PSD=True)
    # half of K and half of its transpose is as passive as K and symmetric
    gains = gains.reshape(rank * rank, 3, 3, -1)
    gains = 0.5 * (gains + np.swapaxes(gains, 1, 2))
    flat = cvxpy.vec(free, order="C")
    cost = 0.0
    for row, column in UPPER:
        miss = (r @ gains[:, row, column].T) @ flat - q.T @ as_real(target[:, row, column] * weight)
        cost += cvxpy.sum_squares(miss) * (1.0 + (row < column))
    problem = cvxpy.Problem(cvxpy.Minimize(cost))
    try:
        problem.solve(solver=cvxpy.CLARABEL)
    except cvxpy.SolverError as err:
        raise ConfigError(f"no passive fit of the radiation memory: {err}; check added mass and damping") from None
    if free.value is None:
        raise ConfigError(f"no passive fit of the radiation memory: {problem.status}; check added mass and damping")
    # what the solver leaves below zero goes, so that passivity is exact
    eigenvalues, vectors = np.linalg.eigh(free.value)
    loss = vectors * np.maximum(eigenvalues, 0.0) @ vectors.T
    found = np.einsum("k,kijm->ijm", loss.ravel(), gains) @ np.linalg.inv(root)
    return found.reshape(3, 3, *b.shape)

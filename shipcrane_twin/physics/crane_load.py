"""The load's immediate reaction, inside the crane's own equations.

The wire is so stiff that the load follows the tip along the wire like a mass bolted to it. The wire's
force, though, comes back one step late. Feeding it back alone is unstable as soon as the load is about as
heavy as the crane's own inertia at its tip. So the crane carries the mass of the load along the wire, and
the force F of the last step counts without what this mass gave then: ``F - m n n.(a - a_last)``, with the
pull's direction n and the tip's acceleration a. While the wire is slack the mass is zero.
"""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_chain import cross
from shipcrane_twin.physics.crane_links import ChainWork


@njit(cache=True)
def hang_load(base: Array, work: ChainWork) -> None:
    """Add the carried mass to mass matrix, bias, momenta and wrenches of `work`.

    Parameters
    ----------
    base : float64, shape (16,)
        See `crane_dynamics`; read are the tip force, the tip's mean proper acceleration over the last
        step [m/s2] and the mass carried [kg]; the force's direction is that of the wire.
    work : ChainWork
        After `fill_mass_matrix` and `fill_bias`.
    """
    mass = base[15]
    pull = np.sqrt(base[9] ** 2 + base[10] ** 2 + base[11] ** 2)
    if mass <= 0.0 or pull <= 0.0:
        return
    n = work.bias.shape[0]
    nx, ny, nz = base[9] / pull, base[10] / pull, base[11] / pull
    px, py, pz = work.origin_b[n, 0], work.origin_b[n, 1], work.origin_b[n, 2]
    lx, ly, lz = cross(px, py, pz, nx, ny, nz)
    late = (
        nx * (work.tip_acc_b[0] - base[12])
        + ny * (work.tip_acc_b[1] - base[13])
        + nz * (work.tip_acc_b[2] - base[14])
    )
    for i in range(n):
        # the tip's velocity along n per unit rate of the joint
        own = along(work, i, nx, ny, nz, lx, ly, lz)
        work.bias[i] += mass * late * own
        for k in range(i + 1):
            element = mass * own * along(work, k, nx, ny, nz, lx, ly, lz)
            work.mass_matrix[i, k] += element
            if k != i:
                work.mass_matrix[k, i] += element
    for i in range(n):
        own = along(work, i, nx, ny, nz, lx, ly, lz)
        for k, part in enumerate((nx, ny, nz, lx, ly, lz)):
            work.momentum_b[i, k] += mass * own * part
            work.wrench_b[i, k] += mass * late * part


@njit(cache=True)
def along(
    work: ChainWork, i: int, nx: float, ny: float, nz: float, lx: float, ly: float, lz: float
) -> float:
    """Return joint i's screw projected on the line through the tip along n, with moment l about the base."""
    return (
        work.screw_b[i, 0] * nx
        + work.screw_b[i, 1] * ny
        + work.screw_b[i, 2] * nz
        + work.screw_b[i, 3] * lx
        + work.screw_b[i, 4] * ly
        + work.screw_b[i, 5] * lz
    )


@njit(cache=True)
def add_tip_acceleration(work: ChainWork, qdd: Array, weight: float, total_b: Array) -> None:
    """Add ``weight`` times the tip's proper acceleration (3,) for joint accelerations qdd (n,) to a sum."""
    n = qdd.shape[0]
    px, py, pz = work.origin_b[n, 0], work.origin_b[n, 1], work.origin_b[n, 2]
    for k in range(3):
        total_b[k] += weight * work.tip_acc_b[k]
    for i in range(n):
        tx, ty, tz = cross(work.screw_b[i, 3], work.screw_b[i, 4], work.screw_b[i, 5], px, py, pz)
        total_b[0] += weight * qdd[i] * (work.screw_b[i, 0] + tx)
        total_b[1] += weight * qdd[i] * (work.screw_b[i, 1] + ty)
        total_b[2] += weight * qdd[i] * (work.screw_b[i, 2] + tz)

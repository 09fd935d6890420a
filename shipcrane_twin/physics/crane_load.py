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
from shipcrane_twin.physics.crane_links import ChainWork, project_row


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
    _add_mass(
        mass, base, pull, work.origin_b, work.tip_acc_b, work.screw_b, work.bias, work.mass_matrix, work.momentum_b,
        work.wrench_b, work.along,
    )  # fmt: skip


@njit(cache=True)
def _add_mass(
    mass: float,
    base: Array,
    pull: float,
    origin_b: Array,
    tip_acc_b: Array,
    screw_b: Array,
    bias: Array,
    mass_matrix: Array,
    momentum_b: Array,
    wrench_b: Array,
    along: Array,
) -> None:
    """Do the work of `hang_load` on arrays by themselves, ``along`` (n,) is scratch."""
    n = bias.shape[0]
    nx, ny, nz = base[9] / pull, base[10] / pull, base[11] / pull
    lx, ly, lz = cross(origin_b[n, 0], origin_b[n, 1], origin_b[n, 2], nx, ny, nz)
    late = mass * (
        nx * (tip_acc_b[0] - base[12]) + ny * (tip_acc_b[1] - base[13]) + nz * (tip_acc_b[2] - base[14])
    )
    for i in range(n):
        # the tip's velocity along n per unit rate of the joint
        own = project_row(screw_b, i, nx, ny, nz, lx, ly, lz)
        along[i] = own
        bias[i] += late * own
        for k in range(i + 1):
            element = mass * own * along[k]
            mass_matrix[i, k] += element
            if k != i:
                mass_matrix[k, i] += element
        add_row(momentum_b, i, mass * own, nx, ny, nz, lx, ly, lz)
        add_row(wrench_b, i, late, nx, ny, nz, lx, ly, lz)


@njit(cache=True)
def add_row(
    rows: Array, i: int, share: float, nx: float, ny: float, nz: float, lx: float, ly: float, lz: float
) -> None:
    """Add a share of six numbers to row i of an (n, 6) array."""
    rows[i, 0] += share * nx
    rows[i, 1] += share * ny
    rows[i, 2] += share * nz
    rows[i, 3] += share * lx
    rows[i, 4] += share * ly
    rows[i, 5] += share * lz


@njit(cache=True)
def add_tip_acceleration(work: ChainWork, qdd: Array, weight: float, total_b: Array) -> None:
    """Add ``weight`` times the tip's proper acceleration (3,) for joint accelerations qdd (n,) to a sum."""
    screw_b, origin_b, tip_acc_b = work.screw_b, work.origin_b, work.tip_acc_b
    n = qdd.shape[0]
    px, py, pz = origin_b[n, 0], origin_b[n, 1], origin_b[n, 2]
    for k in range(3):
        total_b[k] += weight * tip_acc_b[k]
    for i in range(n):
        tx, ty, tz = cross(screw_b[i, 3], screw_b[i, 4], screw_b[i, 5], px, py, pz)
        total_b[0] += weight * qdd[i] * (screw_b[i, 0] + tx)
        total_b[1] += weight * qdd[i] * (screw_b[i, 1] + ty)
        total_b[2] += weight * qdd[i] * (screw_b[i, 2] + tz)

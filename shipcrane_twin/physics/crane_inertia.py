"""Whole-crane quantities of inertia and energy: what the vessel adds to its mass, and what tests balance."""

from __future__ import annotations

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_chain import REVOLUTE, ChainParams, cross, joint_count
from shipcrane_twin.physics.crane_dynamics import bias_forces
from shipcrane_twin.physics.crane_links import ChainWork, new_work, place_links, slide_moment


@njit(cache=True)
def fill_composite(chain: ChainParams, work: ChainWork, total: Array) -> None:
    """Fill total (10,) as `composite_inertia` returns it; `place_links` goes first."""
    m, hx, hy, hz = 0.0, 0.0, 0.0, 0.0
    for i in range(chain.kind.shape[0]):
        m += chain.mass[i]
        hx += chain.mass[i] * work.cog_b[i, 0]
        hy += chain.mass[i] * work.cog_b[i, 1]
        hz += chain.mass[i] * work.cog_b[i, 2]
    total[0], total[1], total[2], total[3] = m, hx / m, hy / m, hz / m
    total[4:10] = 0.0
    for i in range(chain.kind.shape[0]):
        own = chain.mass[i]
        x, y, z = work.cog_b[i, 0] - hx / m, work.cog_b[i, 1] - hy / m, work.cog_b[i, 2] - hz / m
        total[4] += work.inertia_b[i, 0] + own * (y * y + z * z)
        total[5] += work.inertia_b[i, 1] - own * x * y
        total[6] += work.inertia_b[i, 2] - own * x * z
        total[7] += work.inertia_b[i, 3] + own * (x * x + z * z)
        total[8] += work.inertia_b[i, 4] - own * y * z
        total[9] += work.inertia_b[i, 5] + own * (x * x + y * y)


@njit(cache=True)
def composite_inertia(chain: ChainParams, q: Array) -> Array:
    """Return the crane's rigid-body inertia with its joints frozen at q (n,), shape (10,).

    m [kg], centre of mass x, y, z from the crane_base origin [m], then Ixx, Ixy, Ixz, Iyy, Iyz, Izz
    about that centre [kg m2], all in crane_base axes: the order of geometry_msgs/Inertia, off-diagonal
    entries being elements of the inertia tensor (products of inertia with their minus sign).
    """
    work = new_work(joint_count(chain, q))
    place_links(chain, q, work)
    total = np.empty(10)
    fill_composite(chain, work, total)
    return total


@njit(cache=True)
def coriolis_matrix(chain: ChainParams, q: Array, qd: Array) -> Array:
    """Return C(q, qd), shape (n, n), of the Christoffel symbols.

    C qd is the Coriolis bias and dM/dt - 2 C is skew.
    Exact without derivatives: on a resting base without weight the bias is the quadratic form of the
    Christoffel symbols of the first kind, which are symmetric, so its polarisation gives them.
    """
    joints = joint_count(chain, q)
    zero = np.zeros(3)
    matrix = np.empty((joints, joints))
    for j in range(joints):
        shifted = qd.copy()
        shifted[j] += 1.0
        ahead = bias_forces(chain, q, shifted, zero, zero, zero, zero)
        shifted[j] -= 2.0
        behind = bias_forces(chain, q, shifted, zero, zero, zero, zero)
        matrix[:, j] = 0.25 * (ahead - behind)
    return matrix


@njit(cache=True)
def kinetic_energy(chain: ChainParams, q: Array, qd: Array, v0: Array, w0: Array) -> float:
    """Return the kinetic energy [J] on a base moving with v0 [m/s] and w0 [rad/s], (3,) in base axes."""
    joints = joint_count(chain, q)
    work = new_work(joints)
    place_links(chain, q, work)
    energy = 0.0
    wx, wy, wz = w0[0], w0[1], w0[2]
    vx, vy, vz = v0[0], v0[1], v0[2]  # of the link's material point at the base origin
    for i in range(joints):
        s = work.screw_b[i]
        vx, vy, vz = vx + s[0] * qd[i], vy + s[1] * qd[i], vz + s[2] * qd[i]
        if chain.kind[i] == REVOLUTE:
            wx, wy, wz = wx + s[3] * qd[i], wy + s[4] * qd[i], wz + s[5] * qd[i]
        c = work.cog_b[i]
        ux, uy, uz = cross(wx, wy, wz, c[0], c[1], c[2])
        ux, uy, uz = ux + vx, uy + vy, uz + vz
        t = work.inertia_b[i]
        energy += 0.5 * chain.mass[i] * (ux * ux + uy * uy + uz * uz)
        energy += 0.5 * (t[0] * wx * wx + t[3] * wy * wy + t[5] * wz * wz)
        energy += t[1] * wx * wy + t[2] * wx * wz + t[4] * wy * wz
        if work.slide[i, 0] != 0.0:
            # segments that trail: m r qd z against the velocity that they would have with their link
            hx, hy, hz = slide_moment(work.slide, work.rotation_b, work.origin_b, i, 0)
            ux, uy, uz = cross(wx, wy, wz, hx, hy, hz)
            r = work.slide[i, 0]
            energy += qd[i] * (s[0] * (r * vx + ux) + s[1] * (r * vy + uy) + s[2] * (r * vz + uz))
            energy += 0.5 * work.slide[i, 8] * qd[i] * qd[i]
    return energy


@njit(cache=True)
def potential_energy(chain: ChainParams, q: Array, gravity_b: Array) -> float:
    """Return the potential energy [J] against the base origin; gravity_b (3,) points down [m/s2]."""
    joints = joint_count(chain, q)
    work = new_work(joints)
    place_links(chain, q, work)
    energy = 0.0
    for i in range(joints):
        for k in range(3):
            energy -= chain.mass[i] * gravity_b[k] * work.cog_b[i, k]
    return energy

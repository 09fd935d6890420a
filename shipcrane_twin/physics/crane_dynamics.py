r"""Rigid-body dynamics of a crane on a moving base.

:math:`M(q)\,\ddot q + h(q, \dot q, \text{base}, \text{tip force}) = \tau`, by Newton and Euler link by link.

The base motion enters as three vectors in crane_base axes: angular velocity w0 [rad/s], angular
acceleration al0 [rad/s2] and proper acceleration f0 = acceleration of the crane_base origin minus
the gravity vector [m/s2] (at rest and upright: (0, 0, +9.80665)). Kernels that take all of it at once
read `base`, float64 of shape (16,): w0, al0, f0, the force on the tip tip_force_b [N], and for
`crane_load` the tip's mean proper acceleration over the last step [m/s2] and the mass carried there [kg].

All is exact for rigid links; flexibility of boom and oil belongs to the servo model.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_chain import REVOLUTE, ChainParams, cross, joint_count
from shipcrane_twin.physics.crane_links import ChainWork, new_work, place_links, project_row, slide_moment, store_row


@njit(cache=True)
def fill_mass_matrix(chain: ChainParams, work: ChainWork) -> None:
    """Fill mass matrix and joint momenta of `work`; `place_links` goes first.

    From the last link inward: everything outboard of a joint moves as one body with that joint.
    """
    m, hx, hy, hz = 0.0, 0.0, 0.0, 0.0
    jxx, jxy, jxz, jyy, jyz, jzz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(chain.kind.shape[0] - 1, -1, -1):
        own = chain.mass[i]
        x, y, z = work.cog_b[i, 0], work.cog_b[i, 1], work.cog_b[i, 2]
        m += own
        hx += own * x
        hy += own * y
        hz += own * z
        jxx += work.inertia_b[i, 0] + own * (y * y + z * z)
        jxy += work.inertia_b[i, 1] - own * x * y
        jxz += work.inertia_b[i, 2] - own * x * z
        jyy += work.inertia_b[i, 3] + own * (x * x + z * z)
        jyz += work.inertia_b[i, 4] - own * y * z
        jzz += work.inertia_b[i, 5] + own * (x * x + y * y)
        vx, vy, vz = work.screw_b[i, 0], work.screw_b[i, 1], work.screw_b[i, 2]
        wx, wy, wz = work.screw_b[i, 3], work.screw_b[i, 4], work.screw_b[i, 5]
        px, py, pz = m * vx + wy * hz - wz * hy, m * vy + wz * hx - wx * hz, m * vz + wx * hy - wy * hx
        lx = jxx * wx + jxy * wy + jxz * wz + hy * vz - hz * vy
        ly = jxy * wx + jyy * wy + jyz * wz + hz * vx - hx * vz
        lz = jxz * wx + jyz * wy + jzz * wz + hx * vy - hy * vx
        extra = 0.0
        if work.slide[i, 0] != 0.0:
            # trailing segments move by r = ds/dq - 1 per unit rate against their link
            r = work.slide[i, 0]
            ux, uy, uz = slide_moment(work.slide, work.rotation_b, work.origin_b, i, 0)
            ux, uy, uz = cross(ux, uy, uz, vx, vy, vz)
            px, py, pz = px + r * vx, py + r * vy, pz + r * vz
            lx, ly, lz = lx + ux, ly + uy, lz + uz
            extra = r + work.slide[i, 8]
        store_row(work.momentum_b, i, px, py, pz, lx, ly, lz)
        for k in range(i + 1):
            element = project_row(work.screw_b, k, px, py, pz, lx, ly, lz)
            if k == i:
                element += extra
            work.mass_matrix[i, k] = element
            work.mass_matrix[k, i] = element


@njit(cache=True)
def fill_bias(chain: ChainParams, qd: Array, base: Array, work: ChainWork) -> None:
    """Fill bias, wrench_b and tip_acc_b of `work` for joint rates qd (n,) and base (16,), after `place_links`."""
    joints = chain.kind.shape[0]
    wx, wy, wz = base[0], base[1], base[2]
    ax, ay, az = base[3], base[4], base[5]
    fx, fy, fz = base[6], base[7], base[8]  # proper acceleration of the present link's origin
    px, py, pz = 0.0, 0.0, 0.0
    for i in range(joints):
        ox, oy, oz = work.origin_b[i, 0], work.origin_b[i, 1], work.origin_b[i, 2]
        sx, sy, sz = _swing(wx, wy, wz, ax, ay, az, ox - px, oy - py, oz - pz)
        fx, fy, fz = fx + sx, fy + sy, fz + sz
        px, py, pz = ox, oy, oz
        zx = work.rotation_b[i, 0, 2] * qd[i]
        zy = work.rotation_b[i, 1, 2] * qd[i]
        zz = work.rotation_b[i, 2, 2] * qd[i]
        gx, gy, gz = cross(wx, wy, wz, zx, zy, zz)
        if chain.kind[i] == REVOLUTE:
            ax, ay, az = ax + gx, ay + gy, az + gz
            wx, wy, wz = wx + zx, wy + zy, wz + zz
        else:
            fx, fy, fz = fx + 2.0 * gx, fy + 2.0 * gy, fz + 2.0 * gz
        cx, cy, cz = work.cog_b[i, 0], work.cog_b[i, 1], work.cog_b[i, 2]
        sx, sy, sz = _swing(wx, wy, wz, ax, ay, az, cx - px, cy - py, cz - pz)
        m = chain.mass[i]
        kx, ky, kz = m * (fx + sx), m * (fy + sy), m * (fz + sz)
        lx, ly, lz = _turned(work.inertia_b, i, wx, wy, wz)
        ux, uy, uz = _turned(work.inertia_b, i, ax, ay, az)
        gx, gy, gz = cross(wx, wy, wz, lx, ly, lz)
        cx, cy, cz = cross(cx, cy, cz, kx, ky, kz)
        store_row(work.wrench_b, i, kx, ky, kz, ux + gx + cx, uy + gy + cy, uz + gz + cz)
        work.bias[i] = 0.0
        store_row(work.motion_b, i, wx, wy, wz, ax, ay, az)
        work.motion_b[i, 6], work.motion_b[i, 7], work.motion_b[i, 8] = fx, fy, fz
    tx, ty, tz = work.origin_b[joints, 0], work.origin_b[joints, 1], work.origin_b[joints, 2]
    sx, sy, sz = _swing(wx, wy, wz, ax, ay, az, tx - px, ty - py, tz - pz)
    work.tip_acc_b[0], work.tip_acc_b[1], work.tip_acc_b[2] = fx + sx, fy + sy, fz + sz
    _add_slides(
        joints, qd, work.slide, work.rotation_b, work.origin_b, work.motion_b, work.wrench_b, work.bias
    )
    _gather_inward(joints, base, work.origin_b, work.screw_b, work.wrench_b, work.bias)


@njit(cache=True)
def _add_slides(
    joints: int,
    qd: Array,
    slide: Array,
    rotation_b: Array,
    origin_b: Array,
    motion_b: Array,
    wrench_b: Array,
    bias: Array,
) -> None:
    """Add to wrenches and bias what the segments of telescopes differ from a rigid link.

    Against the link, a segment has the acceleration ``2 w x z r qd + z s'' qd^2`` along the telescope's axis z, and
    the joint feels its force times ``ds/dq = 1 + r``.
    """
    for i in range(joints):
        r, b, rate = slide[i, 0], slide[i, 4], qd[i]
        if r == 0.0:
            continue
        wx, wy, wz = motion_b[i, 0], motion_b[i, 1], motion_b[i, 2]
        zx, zy, zz = rotation_b[i, 0, 2], rotation_b[i, 1, 2], rotation_b[i, 2, 2]
        gx, gy, gz = cross(wx, wy, wz, zx, zy, zz)
        gx, gy, gz = 2.0 * rate * gx, 2.0 * rate * gy, 2.0 * rate * gz
        bx, by, bz = rate * rate * zx, rate * rate * zy, rate * rate * zz
        rx, ry, rz = slide_moment(slide, rotation_b, origin_b, i, 0)
        cx, cy, cz = cross(rx, ry, rz, gx, gy, gz)
        sx, sy, sz = slide_moment(slide, rotation_b, origin_b, i, 4)
        dx, dy, dz = cross(sx, sy, sz, bx, by, bz)
        wrench_b[i, 0] += r * gx + b * bx
        wrench_b[i, 1] += r * gy + b * by
        wrench_b[i, 2] += r * gz + b * bz
        wrench_b[i, 3] += cx + dx
        wrench_b[i, 4] += cy + dy
        wrench_b[i, 5] += cz + dz
        rx, ry, rz = rx - r * origin_b[i, 0], ry - r * origin_b[i, 1], rz - r * origin_b[i, 2]
        sx, sy, sz = _swing(wx, wy, wz, motion_b[i, 3], motion_b[i, 4], motion_b[i, 5], rx, ry, rz)
        sx, sy, sz = sx + r * motion_b[i, 6], sy + r * motion_b[i, 7], sz + r * motion_b[i, 8]
        bias[i] = zx * sx + zy * sy + zz * sz + slide[i, 9] * rate * rate


@njit(cache=True)
def _turned(inertia_b: Array, i: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return the inertia of link i times a vector."""
    return (
        inertia_b[i, 0] * x + inertia_b[i, 1] * y + inertia_b[i, 2] * z,
        inertia_b[i, 1] * x + inertia_b[i, 3] * y + inertia_b[i, 4] * z,
        inertia_b[i, 2] * x + inertia_b[i, 4] * y + inertia_b[i, 5] * z,
    )


@njit(cache=True)
def _swing(
    wx: float, wy: float, wz: float, ax: float, ay: float, az: float, dx: float, dy: float, dz: float
) -> tuple[float, float, float]:
    """Return al x d + w x (w x d): what the far end of d gains in acceleration on a turning body."""
    ux, uy, uz = cross(wx, wy, wz, dx, dy, dz)
    cx, cy, cz = cross(wx, wy, wz, ux, uy, uz)
    tx, ty, tz = cross(ax, ay, az, dx, dy, dz)
    return cx + tx, cy + ty, cz + tz


@njit(cache=True)
def _gather_inward(joints: int, base: Array, origin_b: Array, screw_b: Array, wrench_b: Array, bias: Array) -> None:
    """Sum link wrenches from the tip inward and project them on the joints; arrays of `ChainWork` by themselves."""
    fx, fy, fz = -base[9], -base[10], -base[11]
    mx, my, mz = cross(
        origin_b[joints, 0], origin_b[joints, 1], origin_b[joints, 2], fx, fy, fz
    )
    for i in range(joints - 1, -1, -1):
        fx, fy, fz = fx + wrench_b[i, 0], fy + wrench_b[i, 1], fz + wrench_b[i, 2]
        mx, my, mz = mx + wrench_b[i, 3], my + wrench_b[i, 4], mz + wrench_b[i, 5]
        store_row(wrench_b, i, fx, fy, fz, mx, my, mz)
        bias[i] += project_row(screw_b, i, fx, fy, fz, mx, my, mz)


@njit(cache=True)
def fill_base_wrench(work: ChainWork, qdd: Array, wrench_b: Array) -> None:
    """Write the wrench of the crane on the ship (6,) for joint accelerations qdd (n,)."""
    for k in range(6):
        total = work.wrench_b[0, k]
        for i in range(qdd.shape[0]):
            total += work.momentum_b[i, k] * qdd[i]
        wrench_b[k] = -total


@njit(cache=True)
def pack_base(w0: Array, al0: Array, f0: Array, tip_force_b: Array) -> Array:
    """Return `base` (16,) from its four vectors (3,), all in crane_base axes, with no mass carried."""
    base = np.zeros(16)
    base[0:3] = w0
    base[3:6] = al0
    base[6:9] = f0
    base[9:12] = tip_force_b
    return base


@njit(cache=True)
def mass_matrix(chain: ChainParams, q: Array) -> Array:
    """Return the joint-space mass matrix (n, n) [kg m2, kg m or kg by joint kinds] at q (n,)."""
    work = new_work(joint_count(chain, q))
    place_links(chain, q, work)
    fill_mass_matrix(chain, work)
    return work.mass_matrix


@njit(cache=True)
def bias_forces(
    chain: ChainParams, q: Array, qd: Array, w0: Array, al0: Array, f0: Array, tip_force_b: Array
) -> Array:
    """Return h (n,) [N m] or [N] of M qdd + h = tau: weight, base motion, Coriolis and tip force.

    Parameters
    ----------
    chain : ChainParams
        Crane.
    q, qd : float64, shape (n,)
        Joint values and rates.
    w0, al0, f0, tip_force_b : float64, shape (3,)
        Base motion and tip force in crane_base axes, as in the head of this module.
    """
    work = new_work(joint_count(chain, q))
    place_links(chain, q, work)
    fill_bias(chain, qd, pack_base(w0, al0, f0, tip_force_b), work)
    return work.bias


@njit(cache=True)
def base_wrench(
    chain: ChainParams,
    q: Array,
    qd: Array,
    qdd: Array,
    w0: Array,
    al0: Array,
    f0: Array,
    tip_force_b: Array,
) -> Array:
    """Return force (3) [N] and moment (3) [N m] of the crane on the ship, shape (6,).

    At the crane_base origin, in crane_base axes; weight, inertia forces of links and base motion, and
    the tip force are in it. Arguments as in `bias_forces`, with the joint accelerations qdd (n,).
    """
    work = new_work(joint_count(chain, q))
    place_links(chain, q, work)
    fill_mass_matrix(chain, work)
    fill_bias(chain, qd, pack_base(w0, al0, f0, tip_force_b), work)
    wrench_b = np.empty(6)
    fill_base_wrench(work, qdd, wrench_b)
    return wrench_b

"""Contact of a body's corners with rectangles that may move: a deck, a quay, the sea floor, a supply ship.

A rectangle's motion is a row of float64 (18,): position of its middle and velocity [m, m/s], its axes along length and
breadth and its normal as columns of a matrix (row by row), angular velocity [rad/s], all in the world.
"""

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array

HALF_LENGTH, HALF_BREADTH, THICKNESS, STIFFNESS, LOSS, FRICTION = range(6)
"""Columns of a rectangle's constants: [m], [m], depth at which it is no longer met [m], per corner [N/m], [s/m], -."""

CREEP_SPEED = 0.01
"""Sliding speed at which friction has reached 71 % of its full force [m/s]."""


@njit(cache=True)
def contact_load(
    planes: Array,
    constants: Array,
    corners: Array,
    radius: float,
    place: Array,
    rot: Array,
    velocity: Array,
    turning: Array,
    force: Array,
    moment: Array,
) -> tuple[float, float]:
    """Add the load of all rectangles on a body, and return the sum of normal forces and the fastest approach.

    Parameters
    ----------
    planes : float64, shape (n, 18)
        Where the rectangles are now.
    constants : float64, shape (n, 6)
    corners : float64, shape (m, 3)
        Corners of the body seen from its CoG, body axes [m].
    radius : float
        Greatest distance of a corner from the CoG [m].
    place, velocity, turning : float64, shape (3,)
        CoG [m], its velocity [m/s] and the angular velocity [rad/s], world.
    rot : float64, shape (3, 3)
        Body to world.
    force, moment : float64, shape (3,)
        Are added to: load about the CoG [N, N m], world.

    Returns
    -------
    normal : float
        [N], zero without contact.
    approach : float
        Largest normal speed of a touching corner into its rectangle [m/s].

    Notes
    -----
    ``N = k d max(0, 1 + loss dd/dt)`` with penetration d: continuous, never pulls (Hunt and Crossley 1975). A body that
    meets it at v leaves at u with ``ln((1 + loss v) / (1 - loss u)) = loss (v + u)``. Friction is
    ``mu N v / sqrt(v^2 + creep^2)`` against sliding: it holds up to a creep of less than `CREEP_SPEED`. Only corners
    touch: an edge of the body on an edge of a rectangle is not seen.
    """
    normal, approach = 0.0, 0.0
    for j in range(planes.shape[0]):
        row = planes[j]
        away = 0.0
        for i in range(3):
            away += (place[i] - row[i]) * row[8 + 3 * i]
        if away > radius or away < -radius - constants[j, THICKNESS]:
            continue
        for corner in range(corners.shape[0]):
            x, y, z = corners[corner, 0], corners[corner, 1], corners[corner, 2]
            ax = rot[0, 0] * x + rot[0, 1] * y + rot[0, 2] * z
            ay = rot[1, 0] * x + rot[1, 1] * y + rot[1, 2] * z
            az = rot[2, 0] * x + rot[2, 1] * y + rot[2, 2] * z
            rx, ry, rz = place[0] + ax - row[0], place[1] + ay - row[1], place[2] + az - row[2]
            depth = -(rx * row[8] + ry * row[11] + rz * row[14])
            if depth <= 0.0 or depth > constants[j, THICKNESS]:
                continue
            if abs(rx * row[6] + ry * row[9] + rz * row[12]) > constants[j, HALF_LENGTH]:
                continue
            if abs(rx * row[7] + ry * row[10] + rz * row[13]) > constants[j, HALF_BREADTH]:
                continue
            # velocity of the corner over the rectangle's point under it
            vx = velocity[0] + turning[1] * az - turning[2] * ay - row[3] - (row[16] * rz - row[17] * ry)
            vy = velocity[1] + turning[2] * ax - turning[0] * az - row[4] - (row[17] * rx - row[15] * rz)
            vz = velocity[2] + turning[0] * ay - turning[1] * ax - row[5] - (row[15] * ry - row[16] * rx)
            opening = vx * row[8] + vy * row[11] + vz * row[14]
            pressed = constants[j, STIFFNESS] * depth * max(0.0, 1.0 - constants[j, LOSS] * opening)
            vx, vy, vz = vx - opening * row[8], vy - opening * row[11], vz - opening * row[14]
            hold = constants[j, FRICTION] * pressed / np.sqrt(vx * vx + vy * vy + vz * vz + CREEP_SPEED**2)
            fx, fy, fz = pressed * row[8] - hold * vx, pressed * row[11] - hold * vy, pressed * row[14] - hold * vz
            force[0] += fx
            force[1] += fy
            force[2] += fz
            moment[0] += ay * fz - az * fy
            moment[1] += az * fx - ax * fz
            moment[2] += ax * fy - ay * fx
            normal += pressed
            approach = max(approach, -opening)
    return normal, approach

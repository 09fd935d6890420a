"""Heel, trim and sinkage of the ship under crane and load, by hand: weights, levers, hydrostatic stiffness.

Written from the published tables and the database's hydrostatic stiffness; uses no code of the package.
"""

from pathlib import Path

import numpy as np
from scipy.io import netcdf_file

GRAVITY = 9.80665
COG = np.array([15.516, 0.0, 3.624])
BASE = np.array([5.516, -3.0, 6.624])

with netcdf_file(Path(__file__).parents[2] / "config" / "vessels" / "gunnerus" / "hydro.nc", mmap=False) as file:
    STIFFNESS = np.array(file.variables["restoring"][:])
C33, C35, C44, C55 = STIFFNESS[[2, 2, 3, 4], [2, 4, 3, 4]]

# modified (Craig) D-H: a, alpha, d, theta of base to tip for joints 0; then which of d and theta the joint moves
DH = [(0.0, 0.0, 2.0, 0.0), (-0.38, 90.0, 0.0, 0.0), (1.85, 0.0, -0.6, 0.0), (0.0, 90.0, 0.0, 0.0)]
TIP = (-0.5, 0.0, 2.0, 0.0)
REVOLUTE = (True, True, True, False)
MASSES = (1524.0, 2236.0, 1264.0)
SEGMENTS = (190.0, 170.0, 150.0, 135.0, 115.0, 95.0, 80.0, 65.0)  # of the telescope, 1.25 m of stroke each
CENTRES = ((0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (-0.5, -1.0, 0.0), (-0.5, 0.0, 1.0))


def craig(a, alpha_deg, d, theta):
    """Transform of one modified D-H row."""
    ca, sa = np.cos(np.deg2rad(alpha_deg)), np.sin(np.deg2rad(alpha_deg))
    ct, st = np.cos(theta), np.sin(theta)
    return np.array(
        [[ct, -st, 0.0, a], [st * ca, ct * ca, -sa, -d * sa], [st * sa, ct * sa, ca, d * ca], [0.0, 0.0, 0.0, 1.0]]
    )


def weights_on_ship(joints, load_kg):
    """Masses and their places from the ship's CoG (n, 3), x forward, y port, z up: the links, then the load."""
    frame, places = np.eye(4), []
    for row, revolute, value, centre in zip(DH, REVOLUTE, joints, CENTRES, strict=True):
        a, alpha, d, theta = row
        if not revolute:
            for number, _ in enumerate(SEGMENTS):
                slid = frame @ craig(a, alpha, d + min(value, 1.25 * (number + 1)), theta)
                places.append((slid @ [*centre, 1.0])[:3])
        frame = frame @ craig(a, alpha, d + (0.0 if revolute else value), theta + (value if revolute else 0.0))
        if revolute:
            places.append((frame @ [*centre, 1.0])[:3])
    places.append((frame @ craig(*TIP))[:3, 3])  # the wire pulls at the tip
    return np.array([*MASSES, *SEGMENTS, load_kg]), np.array(places) + BASE - COG


def heel_trim_sinkage(joints, load_kg):
    """Heel to starboard and trim by the bow [rad], sinkage [m]."""
    masses, places = weights_on_ship(joints, load_kg)
    heel = trim = sinkage = 0.0
    for _ in range(100):
        # levers in the heeled and trimmed ship: what stands high swings out to the low side
        outward = -places[:, 1] * np.cos(heel) + places[:, 2] * np.sin(heel)
        upright = places[:, 1] * np.sin(heel) + places[:, 2] * np.cos(heel)
        forward = places[:, 0] * np.cos(trim) + upright * np.sin(trim)
        heel = GRAVITY * masses @ outward * np.cos(trim) / C44
        # heave (up) and trim (bow down) share a stiffness: the waterplane's centre lies aft of the CoG
        loads = GRAVITY * np.array([-masses.sum(), masses @ forward])
        rise, trim = np.linalg.solve([[C33, C35], [C35, C55]], loads)
        sinkage = -rise
    return heel, trim, sinkage

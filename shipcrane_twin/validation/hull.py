"""The hull against the real ship's, its panels against finer ones, its state-space model against the panel method."""

import dataclasses

import numpy as np

from shipcrane_twin.hydro.build import HullBuildConfig, hull_mesh
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.hydro.database import LATERAL, LONGITUDINAL, HydroDatabase, moved
from shipcrane_twin.hydro.mesh import lid_panels
from shipcrane_twin.hydro.panel_method import floating_body, solve

VOLUME, KB, C33, C44, C55 = 493.472e3 / 1025.0, 1.591, 2.7320945e6, 7.9895465e6, 2.0532877e8
"""R/V Gunnerus, elongated, in ShipX 4.09.6: displacement, VCB (vesselcoeff.xml), restoring matrix (retfun.re10)."""
GM = C44 / (482026.94 * 9.81)
"""The same restoring matrix with the mass that stands beside it [m]."""
COG = np.array([15.516, 0.0, 3.624])
"""What C44 and C55 refer to, from aft perpendicular, centre line, baseline [m]."""

FINER = {"along": 76, "girth": 26, "skeg": 4, "lid": 6}
"""Panels of the mesh that convergence is measured against, about twice as many."""
PANEL_OMEGA = (0.5, 1.05, 1.75, 2.8, 4.0)
PANEL_DIRECTION = np.deg2rad([0.0, 45.0, 90.0, 135.0, 180.0])

FIT_OMEGA = np.concatenate([[0.0], np.geomspace(1e-3, 15.0, 3000), np.linspace(0.005, 15.0, 3001)])
"""Where passivity is looked at [rad/s]; the fit has seen none of these."""
COUNTED = 0.05
"""Entries of K are judged from this share of their diagonal scale on."""


def hull_rows(data: HydroDatabase) -> list[Row]:
    """Compare volume, stiffness, centre of buoyancy and metacentric height with the real ship's."""
    ship = moved(data, COG)
    pairs = (
        ("volume", ship.volume, VOLUME, 0.01, "m3"),
        ("C33", ship.restoring[2, 2], C33, 0.01, "N/m"),
        ("C44", ship.restoring[3, 3], C44, 0.01, "N m"),
        ("C55", ship.restoring[4, 4], C55, 0.01, "N m"),
        ("KB", ship.centre_of_buoyancy[2], KB, 0.02, "m"),
        ("GM_T", ship.restoring[3, 3] / (ship.mass * ship.gravity), GM, 0.02, "m"),
    )
    return [
        Row(f"{name} of the hull", abs(value / wanted - 1.0), bar, "", f"{value:.5g}, ShipX {wanted:.5g} {unit}")
        for name, value, wanted, bar, unit in pairs
    ]


def panel_rows(config: HullBuildConfig) -> list[Row]:
    """Compare added mass, damping and wave loads with those of a mesh of twice as many panels.

    Five frequencies from 0.5 to 4 rad/s, five wave directions; the largest change of each entry as a share of its
    largest value over frequencies and directions. About a minute.

    Raises
    ------
    ConfigError
        If Capytaine is not installed.
    """
    finer = dataclasses.replace(config.mesh, **FINER)
    found, counts = [], []
    for mesh in (config.mesh, finer):
        hull = hull_mesh(dataclasses.replace(config, mesh=mesh))
        lid = lid_panels(config.form, config.skeg, mesh, config.draught_m)
        body = floating_body(hull, config.draught_m, np.array(config.cog_m), lid)
        water = config.water_density_kg_m3, config.gravity_m_s2
        found.append([solve(body, omega, PANEL_DIRECTION, *water) for omega in PANEL_OMEGA])
        counts.append(len(hull[1]))
    rows = []
    note = f"{counts[0]} panels on the half hull against {counts[1]}"
    for name, letter in (("added_mass", "A"), ("damping", "B"), ("excitation", "F")):
        own, better = (np.array([getattr(one, name) for one in of]) for of in found)
        for mode in range(6):
            pick = (..., mode) if letter == "F" else (..., mode, mode)
            change = np.abs(own[pick] - better[pick]).max() / np.abs(better[pick]).max()
            entry = f"{letter}{mode + 1}" if letter == "F" else f"{letter}{mode + 1}{mode + 1}"
            rows.append(Row(f"change of {entry} with twice as many panels", float(change), 0.01, "", note))
    return rows


def fit_rows(data: HydroDatabase) -> list[Row]:
    """Compare the state-space model with the radiation it stands for, and look for negative damping.

    For each entry of ``K(iw) = B + i w (A - A_inf)`` whose largest value is above 5 % of its diagonal scale: what is
    left of the variance over the table's frequencies, 1 - R2 (complex). For all of K: the lowest eigenvalue of its real
    part from 0 to 15 rad/s, entries over the diagonal scale; below zero the model would feed motion.
    """
    wanted = data.damping + 1j * data.omega[:, None, None] * (data.added_mass - data.added_mass_inf)
    found = data.fit.response(data.omega)
    scale = np.sqrt(np.abs(np.diagonal(wanted, axis1=1, axis2=2)).max(axis=0))
    rows = []
    for i, j in ((i, j) for modes in (LONGITUDINAL, LATERAL) for i in modes for j in modes if i <= j):
        if np.abs(wanted[:, i, j]).max() < COUNTED * scale[i] * scale[j]:
            continue
        left = (np.abs(found[:, i, j] - wanted[:, i, j]) ** 2).sum()
        spread = (np.abs(wanted[:, i, j] - wanted[:, i, j].mean()) ** 2).sum()
        note = f"R2 = {1.0 - left / spread:.4f}"
        rows.append(Row(f"state space: 1 - R2 of K{i + 1}{j + 1}", float(left / spread), 0.03, "", note))
    real = (data.fit.response(FIT_OMEGA) / np.outer(scale, scale)).real
    lowest = np.linalg.eigvalsh(0.5 * (real + np.swapaxes(real, 1, 2))).min()
    rows.append(Row("state space: -min eig Re K(iw), 0 to 15 rad/s", float(-lowest), 1e-6, "of scale"))
    return rows

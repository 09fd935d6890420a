"""Panels of a parametric hull, and the hydrostatics of panels."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.hull_form import (
    COLUMNS,
    HullFormConfig,
    MeshConfig,
    SkegConfig,
    half_breadth,
    keel_depth,
    section_exponent,
    section_points,
)
from shipcrane_twin.physics.arrays import Array

Panels = NDArray[np.int64]


class Hydrostatics(NamedTuple):
    """What still water does to a hull that is the same on both sides; positions as the mesh has them, SI units."""

    volume: float
    centre_of_buoyancy: Array
    waterplane_area: float
    restoring: Array
    metacentric_height: float


def hull_panels(form: HullFormConfig, skeg: SkegConfig, mesh: MeshConfig, draught: float) -> tuple[Array, Panels]:
    """Return the port half of the wetted hull: nodes (k, 3) [m] and panels (p, 4) of node numbers.

    Nodes are from aft perpendicular, centre line, baseline; normals point into the water; triangles repeat a node.
    """
    grid = np.stack([station(form, skeg, mesh, draught, x, below) for x, below in stations(form, skeg, mesh)])
    corners = [grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]]
    quads = [np.stack(corners, axis=2).reshape(-1, 4, 3)]
    inward = np.linspace(1.0, 0.0, COLUMNS + 1)
    transom = grid[0] * np.stack([np.ones_like(inward), inward, np.ones_like(inward)], axis=1)[:, None, :]
    corners = [transom[:-1, :-1], transom[:-1, 1:], transom[1:, 1:], transom[1:, :-1]]
    quads.append(np.stack(corners, axis=2).reshape(-1, 4, 3))
    return merged(np.concatenate(quads))


def lid_panels(form: HullFormConfig, skeg: SkegConfig, mesh: MeshConfig, draught: float) -> tuple[Array, Panels]:
    """Return the port half of the still water inside the hull, normals down; nodes and panels as `hull_panels`.

    It meets the hull's panels at the waterline, so that no gap lets an irregular frequency through.
    """
    x = np.array([here for here, _ in stations(form, skeg, mesh)])
    y = half_breadth(form, x)[:, None] * np.linspace(1.0, 0.0, mesh.lid + 1)
    grid = np.stack([np.broadcast_to(x[:, None], y.shape), y, np.full_like(y, draught)], axis=2)
    corners = [grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]]
    return merged(np.stack(corners, axis=2).reshape(-1, 4, 3))


def stations(form: HullFormConfig, skeg: SkegConfig, mesh: MeshConfig) -> list[tuple[float, bool]]:
    """Return x [m] of the mesh stations, and whether the skeg hangs there; its ends stand twice, without and with."""
    share = np.linspace(0.0, 1.0, mesh.along + 1)
    crowded = 0.5 * share + 0.25 * (1.0 - np.cos(np.pi * share))  # ends at half the spacing
    x = form.stern_x_m + (form.bow_x_m - form.stern_x_m) * crowded
    for end in (skeg.aft_x_m, skeg.fore_x_m):
        x[1 + np.argmin(np.abs(x[1:-1] - end))] = end
    out: list[tuple[float, bool]] = []
    for here in x.tolist():
        if here == skeg.aft_x_m:
            out += [(here, False), (here, True)]
        elif here == skeg.fore_x_m:
            out += [(here, True), (here, False)]
        else:
            out.append((here, skeg.aft_x_m < here < skeg.fore_x_m))
    return out


def station(form: HullFormConfig, skeg: SkegConfig, mesh: MeshConfig, draught: float, x: float, below: bool) -> Array:
    """Return the nodes (girth + skeg + 2, 3) of one station, from the waterline to the centre line."""
    at = np.array([x])
    breadth, depth = half_breadth(form, at)[0], keel_depth(form, draught, at)[0]
    inner = min(0.5 * skeg.breadth_m, 0.3 * breadth)
    hull = section_points(breadth, depth, section_exponent(form, at)[0], inner, mesh.girth)
    bottom = max(hull[-1, 1], skeg.draught_m) if below else hull[-1, 1]
    side = np.linspace(hull[-1, 1], bottom, mesh.skeg + 1)[1:]
    keel = max(depth, bottom)
    y = np.concatenate([hull[:, 0], np.full(mesh.skeg, inner), [0.0]])
    d = np.concatenate([hull[:, 1], side, [keel]])
    return np.stack([np.full_like(y, x), y, draught - d], axis=1)


def merged(quads: Array) -> tuple[Array, Panels]:
    """Return nodes and panels of corners (p, 4, 3) without double nodes and without panels that have no area."""
    keys = np.round(quads.reshape(-1, 3) / 1e-6).astype(np.int64)
    _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    points, panels = quads.reshape(-1, 3)[first], number.reshape(-1, 4)
    normals = np.cross(points[panels[:, 2]] - points[panels[:, 0]], points[panels[:, 3]] - points[panels[:, 1]])
    panels = panels[np.linalg.norm(normals, axis=1) > 1e-7]
    for _ in range(3):  # a triangle ends with its double node, as mesh readers expect
        double = (panels == np.roll(panels, 1, axis=1)).any(axis=1)
        other = double & (panels[:, 3] != panels[:, 2])
        panels[other] = np.roll(panels[other], 1, axis=1)
    return points, panels


def triangles(points: Array, panels: Panels) -> Array:
    """Return the corners (2 p, 3, 3) of the two triangles that make each panel."""
    return np.concatenate([points[panels[:, [0, 1, 2]]], points[panels[:, [0, 2, 3]]]])


def hydrostatics(
    points: Array, panels: Panels, draught: float, cog: Array, water_density: float, gravity: float
) -> Hydrostatics:
    """Return the hydrostatics of a port half with its weight, equal to that of the displaced water, at `cog`.

    Parameters
    ----------
    points : float64, shape (k, 3)
        Nodes from aft perpendicular, centre line, baseline [m].
    panels : int64, shape (p, 4)
        Normals into the water.
    draught : float
        Still water above the baseline [m].
    cog : float64, shape (3,)
        From aft perpendicular, centre line, baseline [m].
    water_density, gravity : float

    Raises
    ------
    ConfigError
        If the panels enclose no water, or reach above it.

    Notes
    -----
    Gauss' theorem over the panels and a lid at the waterline, exact for flat triangles. Stiffness after Newman
    (1977), Marine Hydrodynamics, section 6.16: C33 = rho g A, C35 = -rho g int x dA,
    C44 = rho g (int y^2 dA + V (z_B - z_G)), C55 alike with x. C46 and C56, which vanish once buoyancy stands over
    the CoG, are left out.
    """
    corners = triangles(points, panels) - np.array([cog[0], 0.0, draught])
    if corners[..., 2].max() > 1e-6:
        raise ConfigError(f"the mesh reaches {corners[..., 2].max():.3g} m above still water; cut it at the draught")
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])  # twice the vector area
    # edge midpoints integrate polynomials of second order exactly over a triangle
    mid = 0.5 * (corners + np.roll(corners, 1, axis=1))

    def over(values: Array, axis: int) -> float:
        """Integrate values (t, 3) at the midpoints times a normal component over both halves [value x m2]."""
        return float(2.0 * (0.5 * area[:, axis] * values.mean(axis=1)).sum())

    x, y, z = mid[..., 0], mid[..., 1], mid[..., 2]
    volume, plane = over(z, 2), -over(np.ones_like(z), 2)
    if volume <= 0.0 or plane <= 0.0:
        raise ConfigError(f"the mesh encloses {volume:.4g} m3 of water; turn its normals into the water, leave no gap")
    buoyancy = np.array([over(x * z, 2), 0.0, 0.5 * over(z * z, 2)]) / volume
    lever = buoyancy[2] - (cog[2] - draught)
    weight = water_density * gravity
    restoring = np.zeros((6, 6))
    restoring[2, 2] = weight * plane
    restoring[2, 4] = restoring[4, 2] = weight * over(x, 2)  # of the waterplane: -int x dA
    restoring[3, 3] = weight * (-over(y * y, 2) + volume * lever)
    restoring[4, 4] = weight * (-over(x * x, 2) + volume * lever)
    return Hydrostatics(
        volume=volume,
        centre_of_buoyancy=buoyancy + np.array([cog[0], 0.0, draught]),
        waterplane_area=plane,
        restoring=restoring,
        metacentric_height=float(restoring[3, 3] / (weight * volume)),
    )

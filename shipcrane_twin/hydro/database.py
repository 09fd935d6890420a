"""The hydrodynamic database of one hull: what it holds, in which convention, and what it must fulfil.

One convention for every source, in which importers and builders deliver:

- Axes x forward, y port, z up (FLU); order surge, sway, heave, roll, pitch, yaw; SI units.
- Everything refers to one point, the ship's CoG, given from aft perpendicular, centre line, baseline.
- Time factor ``e^{+i w t}``: a quantity q(t) is the real part of ``Q e^{i w t}``. Positive damping takes energy out.
- A wave direction is where the wave goes, anticlockwise from the bow: 0 is a following sea, pi/2 goes to
  port, pi is a head sea. Tables run from 0 to pi; the hull is the same on both sides.
- Excitation and drift refer to a wave whose elevation above or below the point is ``Re(a e^{i w t})``.
"""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.dispersion import wave_numbers

Complex = NDArray[np.complex128]

MIRROR = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
"""Signs of a load (6,) when the wave comes from the other side."""

LONGITUDINAL, LATERAL = (0, 2, 4), (1, 3, 5)
"""The two blocks that a hull with port-starboard symmetry falls into: surge heave pitch, sway roll yaw."""

ASYMMETRY_MAX = 0.03
"""Largest asymmetry of an added mass or damping matrix, as a share of its scale, that numerics explain."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RadiationFit:
    """State-space model of the radiation memory, both blocks with poles common to their modes.

    Attributes
    ----------
    a : float64, shape (2, p, 2, 2)
        For each block, p second-order sections [1/s].
    b : float64, shape (2, p, 2)
        How a velocity enters a section.
    c : float64, shape (2, 3, 3, p, 2)
        Load on mode i from the sections driven by mode j of the same block.

    Notes
    -----
    Section states obey ``x_jk' = a_k x_jk + b_k nu_j``; the load that the water exerts is
    ``-(A_inf nu_dot_i + sum_jk c_ijk x_jk)``. So ``K_ij(iw) = sum_k c_ijk (iw - a_k)^-1 b_k`` approximates
    ``B_ij(w) + i w (A_ij(w) - A_inf_ij)``.
    """

    a: Array
    b: Array
    c: Array

    def response(self, omega: Array) -> Complex:
        """Return K(iw), shape (n, 6, 6), at frequencies (n,) [rad/s]."""
        out = np.zeros((len(omega), 6, 6), complex)
        for block, modes in enumerate((LONGITUDINAL, LATERAL)):
            pencil = 1j * omega[:, None, None, None] * np.eye(2) - self.a[block]
            state = np.linalg.solve(pencil, np.broadcast_to(self.b[block][..., None], (*pencil.shape[:3], 1)))[..., 0]
            out[np.ix_(range(len(omega)), modes, modes)] = np.einsum("ijkm,nkm->nij", self.c[block], state)
        return out


@dataclass(frozen=True, slots=True, kw_only=True)
class HydroDatabase:
    """A hull in potential flow, at zero speed.

    Attributes
    ----------
    name, source : str
        The ship; where the data come from: code, version, settings, conventions converted, date.
    cog : float64, shape (3,)
        The point everything refers to, from aft perpendicular, centre line, baseline [m].
    draught : float
        Still water above the baseline [m].
    length : float
        Between perpendiculars [m].
    water_density, gravity, depth : float
        [kg/m3], [m/s2], [m] (``inf`` for deep water).
    volume : float
        [m3]; the ship's mass is density times volume.
    centre_of_buoyancy : float64, shape (3,)
        From aft perpendicular, centre line, baseline [m].
    restoring : float64, shape (6, 6)
        Hydrostatic stiffness with the ship's own weight at ``cog``.
    omega : float64, shape (n,)
        Frequencies, rising [rad/s].
    added_mass, damping : float64, shape (n, 6, 6)
    added_mass_inf : float64, shape (6, 6)
        Limit at infinite frequency.
    direction : float64, shape (m,)
        Wave directions, rising from 0 to pi [rad].
    excitation : complex128, shape (n, m, 6)
        First-order load per wave amplitude [N/m, N].
    drift : float64, shape (n, m, 3)
        Mean surge force, sway force, yaw moment per squared amplitude [N/m2, N/m].
    fit : RadiationFit
    points, panels : float64, shape (k, 3); int32, shape (p, 4)
        Mesh of the port half, corners from aft perpendicular, centre line, baseline [m] and four of them per
        panel (a triangle repeats one); empty where the source has none.
    """

    name: str
    source: str
    cog: Array
    draught: float
    length: float
    water_density: float
    gravity: float
    depth: float
    volume: float
    centre_of_buoyancy: Array
    restoring: Array
    omega: Array
    added_mass: Array
    damping: Array
    added_mass_inf: Array
    direction: Array
    excitation: Complex
    drift: Array
    fit: RadiationFit
    points: Array = dataclasses.field(default_factory=lambda: np.zeros((0, 3)))
    panels: NDArray[np.int32] = dataclasses.field(default_factory=lambda: np.zeros((0, 4), np.int32))

    @property
    def mass(self) -> float:
        """What the ship weighs: the water it displaces [kg]."""
        return self.water_density * self.volume


def check(data: HydroDatabase, where: str) -> HydroDatabase:
    """Return the database if it can be that of a ship.

    Parameters
    ----------
    data : HydroDatabase
    where : str
        File name for messages.

    Raises
    ------
    ConfigError
        Naming what is wrong: a shape, a number that is not finite, frequencies or directions out of order
        or missing, a volume that is not positive, units that do not fit together, an asymmetric matrix.
    """

    def demand(holds: object, found: str, expected: str) -> None:
        if not holds:
            raise ConfigError(f"{where}: {found}, expected {expected}")

    n, m = len(data.omega), len(data.direction)
    shapes = {
        "added_mass": (n, 6, 6),
        "damping": (n, 6, 6),
        "added_mass_inf": (6, 6),
        "restoring": (6, 6),
        "excitation": (n, m, 6),
        "drift": (n, m, 3),
        "cog": (3,),
        "centre_of_buoyancy": (3,),
    }
    for name, shape in shapes.items():
        values = getattr(data, name)
        demand(values.shape == shape, f"{name} has the shape {values.shape}", f"{shape}")
        demand(np.isfinite(values).all(), f"{name} holds numbers that are not finite", "finite numbers only")
    for name in ("volume", "draught", "length", "water_density", "gravity", "depth"):
        demand(getattr(data, name) > 0.0, f"{name} is {getattr(data, name):g}", "a positive number")
    rises = n >= 8 and data.omega[0] > 0.0 and (np.diff(data.omega) > 0.0).all()
    demand(rises, f"{n} frequencies are not positive and rising", "at least 8 rising frequencies in rad/s")
    gap = np.diff(data.direction).max(initial=0.0)
    covered = m >= 2 and abs(data.direction[0]) < 1e-6 and abs(data.direction[-1] - np.pi) < 1e-6
    demand(
        covered and (np.diff(data.direction) > 0.0).all() and gap < np.deg2rad(31.0),
        f"wave directions are {np.array2string(np.rad2deg(data.direction), precision=1, threshold=8)} degrees",
        "rising from 0 to 180 degrees without a gap above 30 degrees",
    )
    corners = data.panels.max(initial=-1) < len(data.points) and data.panels.min(initial=0) >= 0
    demand(corners, f"the mesh has panels beyond its {len(data.points)} points", "corners that exist")
    check_units(data, demand)
    for name in ("added_mass_inf", "added_mass", "damping"):
        error = asymmetry(np.atleast_3d(getattr(data, name).T).T)
        demand(
            error <= ASYMMETRY_MAX,
            f"{name} is asymmetric by {100 * error:.1f} % of its scale",
            f"a symmetric matrix within {100 * ASYMMETRY_MAX:g} %",
        )
    return data


def check_units(data: HydroDatabase, demand: Callable[[object, str, str], None]) -> None:
    """Compare quantities with what the hull's size makes of them; a factor of 50 is a wrong unit."""
    waterplane = data.restoring[2, 2] / (data.water_density * data.gravity)
    expected = data.volume / data.draught
    demand(
        0.3 < waterplane / expected < 30.0,
        f"C33 = {data.restoring[2, 2]:.4g} makes a waterplane of {waterplane:.4g} m2 beside a volume of "
        f"{data.volume:.4g} m3 and a draught of {data.draught:g} m",
        "SI units (N/m, m3, m)",
    )
    heave = data.added_mass_inf[2, 2] / data.mass
    demand(0.02 < heave < 50.0, f"A33 is {heave:.3g} times the ship's mass", "SI units (kg)")
    slowest = int(np.argmin(data.omega))
    long_wave = np.abs(data.excitation[slowest, :, 2]).max() / data.restoring[2, 2]
    demand(
        long_wave < 3.0,
        f"the heave load in long waves is {long_wave:.3g} times C33",
        "at most C33 times the wave amplitude: SI units (N/m)",
    )


def asymmetry(matrices: Array) -> float:
    """Return the largest ``|M_ij - M_ji|`` of matrices (n, 6, 6) over ``sqrt(max|M_ii| max|M_jj|)``."""
    scale = np.sqrt(np.abs(np.diagonal(matrices, axis1=1, axis2=2)).max(axis=0))
    scale = np.maximum(scale, 1e-12 * scale.max(initial=1.0))
    return float((np.abs(matrices - np.swapaxes(matrices, 1, 2)) / np.outer(scale, scale)).max())


def moved(data: HydroDatabase, cog: Array) -> HydroDatabase:
    """Return the database about another CoG; the weight that restores moves along.

    Parameters
    ----------
    data : HydroDatabase
    cog : float64, shape (3,)
        From aft perpendicular, centre line, baseline [m].

    Raises
    ------
    ConfigError
        If it is off the centre line.
    """
    arm = np.asarray(cog, float) - data.cog
    if not arm.any():
        return data
    x, y, z = arm
    if y:
        raise ConfigError(f"the CoG is {y:g} m off the centre line, where a symmetric hull's database cannot follow")
    shift = np.eye(6)  # velocity of the old point from that of the new one: v + omega x (-arm)
    shift[:3, 3:] = -np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    # phase: the wave is now counted where the new point stands
    number = wave_numbers(data.omega, data.gravity, data.depth)
    phase = np.exp(1j * number[:, None] * np.cos(data.direction) * x)
    restoring = shift.T @ data.restoring @ shift
    weight = data.mass * data.gravity
    restoring[3, 3] -= weight * z
    restoring[4, 4] -= weight * z
    drift = data.drift.copy()
    drift[..., 2] -= x * drift[..., 1]
    turned = {
        name: np.einsum("ki,...kl,lj->...ij", shift, getattr(data, name), shift)
        for name in ("added_mass", "damping", "added_mass_inf")
    }
    return dataclasses.replace(
        data,
        cog=np.asarray(cog, float),
        restoring=restoring,
        excitation=(data.excitation @ shift) * phase[..., None],
        drift=drift,
        fit=dataclasses.replace(
            data.fit,
            c=np.stack(
                [
                    np.einsum("ki,klpm,lj->ijpm", shift[np.ix_(modes, modes)], c, shift[np.ix_(modes, modes)])
                    for c, modes in zip(data.fit.c, (LONGITUDINAL, LATERAL), strict=True)
                ]
            ),
        ),
        **turned,
    )

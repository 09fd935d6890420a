"""What all importers share: particulars, a move of the reference point, folding of directions, the last checks."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import (
    ASYMMETRY_MAX,
    LATERAL,
    LONGITUDINAL,
    MIRROR,
    Complex,
    HydroDatabase,
    RadiationFit,
    asymmetry,
    check,
)
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.dispersion import wave_numbers

Fit = Callable[[Array, Array, Array, Array], RadiationFit]
"""From frequencies, added mass, damping and added mass at infinite frequency to a state-space model."""


class Particulars(NamedTuple):
    """What the files of a potential-flow code leave out.

    Attributes
    ----------
    name : str
        The ship.
    cog : float64, shape (3,)
        Centre of gravity from aft perpendicular, centre line, baseline [m].
    origin : float64, shape (3,)
        Where the code's axes have their zero, from aft perpendicular, centre line, baseline [m]. The axes
        are x forward, y port, z up, and the wave's phase is counted there.
    centre : float64, shape (3,)
        The point that loads and motions refer to, in the code's axes [m].
    draught, length : float
        [m], between perpendiculars.
    volume : float
        [m3]
    centre_of_buoyancy : float64, shape (3,)
        From aft perpendicular, centre line, baseline [m].
    water_density, gravity, depth : float
        [kg/m3], [m/s2], [m]; ``inf`` is deep water.
    """

    name: str
    cog: Array
    origin: Array
    draught: float
    length: float
    volume: float
    centre_of_buoyancy: Array
    centre: Array = np.zeros(3)  # a default, never written to
    water_density: float = 1025.0
    gravity: float = 9.80665
    depth: float = np.inf

    @property
    def arm(self) -> Array:
        """From the point the loads refer to, to the CoG [m]."""
        return np.asarray(self.cog, float) - np.asarray(self.origin, float) - np.asarray(self.centre, float)


def transfer(arm: Array) -> Array:
    """Return the matrix (6, 6) that makes velocities at a point from those at another one.

    Parameters
    ----------
    arm : float64, shape (3,)
        From the point to the other one [m].

    Notes
    -----
    ``v = v' + arm x omega``. With S the matrix, loads go the other way: ``F' = S^T F``, and an added mass,
    damping or stiffness becomes ``S^T A S`` (Fossen 2021, section 3.3).
    """
    x, y, z = arm
    matrix = np.eye(6)
    matrix[:3, 3:] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    return matrix


def phase_shift(omega: Array, direction: Array, x: float, gravity: float, depth: float) -> Complex:
    """Return the factors (n, m) that count a wave's phase at a point x [m] further forward.

    Notes
    -----
    A wave is ``a e^{i(w t - k x cos d - k y sin d)}``; where it is ``a e^{iwt}`` at the new point, it leads
    by ``k x cos d`` at the old one.
    """
    number = wave_numbers(omega, gravity, depth)
    return np.exp(1j * number[:, None] * np.cos(direction) * x)


def fold(direction_deg: Array, values: Complex, signs: Array = MIRROR) -> tuple[Array, Complex]:
    """Bring wave directions into 0 to 180 degrees; a wave from the other side makes the mirrored load.

    Parameters
    ----------
    direction_deg : float64, shape (m,)
        Where the wave goes, anticlockwise from the bow [deg], any range, any order.
    values : complex128, shape (n, m, k)
        One load or motion per direction.
    signs : float64, shape (k,)
        Their signs in the mirror.

    Returns
    -------
    float64, shape (j,), and complex128, shape (n, j, k)
        Directions, rising [rad], and values. Where both sides are given, the port side's are taken.
    """
    turned = np.mod(np.asarray(direction_deg, float), 360.0)
    mirrored = turned > 180.0 + 1e-6
    folded = np.where(mirrored, 360.0 - turned, turned)
    # port side first, so that unique() keeps it
    order = np.lexsort((mirrored, np.round(folded, 6)))
    _, first = np.unique(np.round(folded[order], 6), return_index=True)
    chosen = order[first]
    return np.deg2rad(folded[chosen]), values[:, chosen] * np.where(mirrored[chosen, None], signs, 1.0)


def finish(
    data: HydroDatabase, where: str, fit: Fit | None, grid: tuple[Array, Array, Array] | None = None
) -> HydroDatabase:
    """Check what an importer has read, make it exactly symmetric, and fit the state-space model.

    Parameters
    ----------
    data : HydroDatabase
        With any fit; it is replaced.
    where : str
        File name for messages.
    fit : callable, optional
        `fit.fit_radiation` if absent.
    grid : tuple of float64, shapes (k,), (k, 6, 6), (k, 6, 6), optional
        Frequencies, added mass and damping to fit, where the source knows more than the database keeps.

    Raises
    ------
    ConfigError
        As `database.check`, and if port and starboard differ.
    """
    check(data, where)
    if fit is None:
        from shipcrane_twin.hydro.fit import fit_radiation

        fit = fit_radiation
    whole = dataclasses.replace(
        data,
        added_mass_inf=symmetric(data.added_mass_inf, f"{where}: added_mass_inf"),
        added_mass=symmetric(data.added_mass, f"{where}: added_mass"),
        damping=symmetric(data.damping, f"{where}: damping"),
        restoring=symmetric(data.restoring, f"{where}: restoring"),
    )
    omega, added_mass, damping = grid or (data.omega, whole.added_mass, whole.damping)
    return check(dataclasses.replace(whole, fit=fit(omega, added_mass, damping, whole.added_mass_inf)), where)


def symmetric(matrices: Array, where: str) -> Array:
    """Return matrices (..., 6, 6) made symmetric, without what couples the two blocks.

    Raises
    ------
    ConfigError
        If more than numerics is lost: the hull's two sides differ, or axes are turned.
    """
    mean = 0.5 * (matrices + np.swapaxes(matrices, -1, -2))
    block = np.zeros((6, 6), bool)
    for modes in (LONGITUDINAL, LATERAL):
        block[np.ix_(modes, modes)] = True
    inside = np.where(block, mean, 0.0)
    # asymmetry() measures M - M^T against the diagonal's scale: give it what was lost as M
    lost = np.triu(mean - inside) + np.where(np.eye(6, dtype=bool), mean, 0.0)
    error = asymmetry(lost.reshape(-1, 6, 6))
    if error > ASYMMETRY_MAX:
        raise ConfigError(
            f"{where} couples surge, heave, pitch with sway, roll, yaw by {100 * error:.1f} % of its scale, expected "
            f"less than {100 * ASYMMETRY_MAX:g} %: a hull that is the same on both sides, x along its centre line"
        )
    return inside


def no_fit(sections: int = 1) -> RadiationFit:
    """Return a state-space model that exerts nothing: radiation without memory."""
    return RadiationFit(
        a=np.tile(-np.eye(2), (2, sections, 1, 1)), b=np.zeros((2, sections, 2)), c=np.zeros((2, 3, 3, sections, 2))
    )

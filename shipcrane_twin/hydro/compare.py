"""Figures that compare one database with another, or an import with what its files say themselves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import Complex, HydroDatabase
from shipcrane_twin.hydro.rao import coupled_periods, natural_periods, own_mass, raos, roll_damping, usual_mass
from shipcrane_twin.physics.arrays import Array

MODES = ("surge", "sway", "heave", "roll", "pitch", "yaw")
JUDGED = (1, 2, 3, 4)
"""Sway, heave, roll, pitch: the loads on which strip theory and three-dimensional theory should agree."""

PERIODS = ((6.0, 0.25), (8.0, 0.15), (10.0, 0.15), (12.0, 0.15), (15.0, 0.15), (20.0, 0.15))
"""Wave periods [s] at which loads are compared, and the bars."""

ADDED_MASS_BAR, ADDED_MASS_PERIODS = 0.20, np.arange(5.0, 12.01, 0.5)
PERIOD_BARS = {"roll": 0.02, "heave": 0.03, "pitch": 0.10}
MOTION_BAR, FIT_BAR = 0.02, 0.03


class Row(NamedTuple):
    """One figure.

    Attributes
    ----------
    what : str
    value : float
    bar : float or None
        None where the figure is told, not judged.
    unit : str
    note : str
    """

    what: str
    value: float
    bar: float | None
    unit: str = ""
    note: str = ""

    @property
    def holds(self) -> bool:
        """Whether the figure keeps its bar; one without a bar does."""
        return self.bar is None or self.value <= self.bar


def at(data: HydroDatabase, values: Complex | Array, omega: Array | float) -> Complex:
    """Return a table (n, ...) at other frequencies, by a cubic spline of real and imaginary parts.

    Raises
    ------
    ConfigError
        If the table does not reach there.
    """
    wanted = np.atleast_1d(np.asarray(omega, float))
    if wanted.min() < data.omega[0] - 1e-6 or wanted.max() > data.omega[-1] + 1e-4:
        raise ConfigError(
            f"{data.name}: the table runs from {data.omega[0]:.3g} to {data.omega[-1]:.3g} rad/s, "
            f"expected one that holds {wanted.min():.3g} to {wanted.max():.3g} rad/s"
        )
    return np.asarray(CubicSpline(data.omega, values, axis=0)(wanted), complex)


def over_directions(values: Complex, found: Array, wanted: Array) -> Complex:
    """Return loads (n, m, k) at other directions, by a cubic spline of real and imaginary parts."""
    if len(found) == len(wanted) and np.abs(found - wanted).max() < 1e-6:
        return values
    return np.asarray(CubicSpline(found, values, axis=1)(wanted))


def compare_with_veres(ours: HydroDatabase, veres: HydroDatabase, mass6: Array) -> list[Row]:
    """Compare a database with VERES's of the same ship.

    Parameters
    ----------
    ours, veres : HydroDatabase
        About the same CoG; use `database.moved` where they differ.
    mass6 : float64, shape (6, 6)
        VERES's rigid-body mass. Each ship keeps its own mass, with these moments of inertia.

    Returns
    -------
    list of Row
        Loads: the largest difference of amplitudes over all directions, as a share of the largest amplitude over all
        directions, of that load at that period. With the phase, the same of complex numbers, without a bar.
        Added mass: the largest difference over periods of 5 to 12 s as a share of VERES's value at that period.
        Motions of heave and pitch, and what strip theory cannot give (F1, F6, damping, A55, A66), have no bar.
    """
    if np.abs(ours.cog - veres.cog).max() > 0.01:
        raise ConfigError(f"CoG at {ours.cog} and {veres.cog} m: move one database with `moved` before the comparison")
    mass = own_mass(mass6, ours)
    rows = table_rows("F", (ours, veres), (ours.excitation, veres.excitation), tuple(range(6)), JUDGED)
    rows += table_rows("RAO", (ours, veres), (raos(ours, mass), raos(veres, mass6)), (2, 4), ())
    omega = 2.0 * np.pi / ADDED_MASS_PERIODS
    for table, letter in (("added_mass", "A"), ("damping", "B")):
        own, theirs = (at(data, getattr(data, table), omega).real for data in (ours, veres))
        for mode in range(1, 6):
            ratio = own[:, mode, mode] / theirs[:, mode, mode]
            bar = ADDED_MASS_BAR if letter == "A" and mode in (1, 2, 3) else None
            note = f"ratio to VERES {ratio.min():.2f} to {ratio.max():.2f}"
            what = f"{letter}{mode + 1}{mode + 1} against VERES, periods of 5 to 12 s"
            rows.append(Row(what, float(np.abs(ratio - 1.0).max()), bar, "", note))
    for name, bar in PERIOD_BARS.items():
        period, reference = natural_periods(ours, mass)[name], natural_periods(veres, mass6)[name]
        note = f"{period:.2f} s, VERES {reference:.2f} s, coupled {coupled_periods(ours, mass)[name]:.2f} s"
        rows.append(Row(f"natural period of {name} against VERES", abs(period / reference - 1.0), bar, "", note))
    return rows


def table_rows(
    letter: str,
    ships: tuple[HydroDatabase, HydroDatabase],
    tables: tuple[Complex, Complex],
    modes: tuple[int, ...],
    judged: tuple[int, ...],
) -> list[Row]:
    """Compare loads or motions (n, m, 6) of two ships by amplitude, with bars for some, and with phase, without."""
    ours, veres = ships
    rows = []
    for period, bar in PERIODS:
        omega = 2.0 * np.pi / period
        theirs = at(veres, tables[1], omega)
        own = over_directions(at(ours, tables[0], omega), ours.direction, veres.direction)
        for mode in modes:
            scale = np.abs(theirs[..., mode]).max()
            amplitude = np.abs(np.abs(own[..., mode]) - np.abs(theirs[..., mode]))
            whole = np.abs(own[..., mode] - theirs[..., mode])
            worst = np.rad2deg(veres.direction[int(amplitude[0].argmax())])
            what = f"{letter}{mode + 1} ({MODES[mode]}) against VERES at {period:g} s"
            note = f"worst at direction {worst:.0f} deg"
            rows.append(Row(what, float(amplitude.max() / scale), bar if mode in judged else None, "", note))
            rows.append(Row(f"{what}, with phase", float(whole.max() / scale), None))
    return rows


def largest(found: Complex, reference: Complex) -> float:
    """Return the largest difference of amplitudes as a share of the largest reference amplitude."""
    return float(np.abs(np.abs(found) - np.abs(reference)).max() / np.abs(reference).max())


def validate_import(
    data: HydroDatabase,
    mass6: Array | None = None,
    motions: Complex | None = None,
    extra_damping: Array | None = None,
) -> list[Row]:
    """Rebuild motions from an imported database and compare.

    Parameters
    ----------
    data : HydroDatabase
    mass6 : float64, shape (6, 6), optional
        Rigid-body mass about the CoG, that of `motions` where they are given; else `rao.usual_mass` will do.
    motions : complex128, shape (n, m, 6), optional
        The code's own motions per amplitude, in the database's convention.
    extra_damping : float64, shape (6, 6), optional
        Linear damping beside radiation; 5 % of critical in roll if absent.

    Returns
    -------
    list of Row
        Against the file's own motions: heave and pitch with a bar, by amplitude, as a share of the largest over all
        frequencies and directions; the others hang on viscous roll damping, which depends on wave height. From
        state space against the tables: all modes. Long waves and the Haskind relation, which show wrong units.

    Raises
    ------
    ConfigError
        If motions come without a mass matrix.
    """
    if mass6 is None:
        if motions is not None:
            raise ConfigError(f"{data.name}: motions without the mass matrix they were made with; give mass6")
        mass6 = usual_mass(data)
    if extra_damping is None:
        extra_damping = roll_damping(data, mass6)
    direct = raos(data, mass6, extra_damping)
    rows = []
    if motions is not None:
        for mode in range(6):
            bar = MOTION_BAR if mode in (2, 4) else None
            what = f"{MODES[mode]} RAO against the file's own"
            rows.append(Row(what, largest(direct[..., mode], motions[..., mode]), bar))
            whole = np.abs(direct[..., mode] - motions[..., mode]).max() / np.abs(motions[..., mode]).max()
            rows.append(Row(f"{what}, with phase", float(whole), None))
    fitted = raos(data, mass6, extra_damping, from_fit=True)
    for mode in range(6):
        value = largest(fitted[..., mode], direct[..., mode])
        rows.append(Row(f"{MODES[mode]} RAO from state space against the tables", value, FIT_BAR))
    return rows + long_wave_rows(data) + haskind_rows(data)


def long_wave_rows(data: HydroDatabase) -> list[Row]:
    """Check the loads of the longest waves.

    Notes
    -----
    Heave: C33. Surge and sway: the fluid accelerates by ``i k g`` where the wave goes and by ``-w^2`` upwards, so
    ``F_i = i k g (m + A_ii) n_i - w^2 A_i3`` (Newman 1977, section 6.18).
    """
    number = data.omega[0] ** 2 / data.gravity if np.isinf(data.depth) else np.nan
    heave = data.excitation[0, :, 2] / data.restoring[2, 2]
    rows = [Row("heave load in the longest wave against C33", float(np.abs(heave - 1.0).max()), 0.15)]
    if np.isfinite(number):
        for mode, toward in ((0, np.cos(data.direction)), (1, np.sin(data.direction))):
            inertia = data.mass + data.added_mass[0, mode, mode]
            expected = 1j * number * data.gravity * inertia * toward - data.omega[0] ** 2 * data.added_mass[0, mode, 2]
            error = np.abs(data.excitation[0, :, mode] - expected).max() / np.abs(expected).max()
            what = f"{MODES[mode]} load in the longest wave against what the fluid's acceleration makes"
            rows.append(Row(what, float(error), 0.15))
    return rows


def haskind_rows(data: HydroDatabase) -> list[Row]:
    """Compare damping with what the loads say of it; strip theory fulfils this roughly, panel codes closely.

    Notes
    -----
    ``B_ii = w^3/(4 pi rho g^3) int_0^{2 pi} |F_i|^2 dd`` in deep water (Newman 1977, section 6.18).
    """
    if not np.isinf(data.depth):
        return []
    # the other side mirrors this one
    squared = 2.0 * np.trapezoid(np.abs(data.excitation) ** 2, data.direction, axis=1)
    from_loads = (data.omega**3 / (4.0 * np.pi * data.water_density * data.gravity**3))[:, None] * squared
    rows = []
    for mode in range(6):
        own = data.damping[:, mode, mode]
        scale = max(own.max(), from_loads[:, mode].max())
        error = np.abs(own - from_loads[:, mode]).max() / scale
        rows.append(Row(f"B{mode + 1}{mode + 1} against the wave loads (Haskind)", float(error), None))
    return rows

"""A realised sea: harmonic components drawn from wave spectra."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.dispersion import wave_numbers
from shipcrane_twin.physics.sea.spreading import spreading_angle

TAIL = 1e-3
"""Share of a spectrum's energy, that of its highest frequencies, that the components leave out and make good."""

FEWEST, MOST = 20, 2000
"""Numbers of components between which a sea is realised."""

SLOWEST = 1e-3
"""Lowest frequency of a component [rad/s]; below, wave numbers lose their digits."""

FEWEST_OF_ONE = 8
"""Components that even a weak system among several has, to keep its shape."""


class Irregular(NamedTuple):
    """A wave system with a spectrum, such as the wind sea or the swell.

    Attributes
    ----------
    omega, density : float64, shape (n,)
        Rising frequencies [rad/s] and energy there [m2 s], linear in between, none outside.
    direction : float
        Where the waves go, anticlockwise from east [rad].
    spreading : float
        The s of cos^2s(angle / 2); ``inf`` is a long-crested sea.
    """

    omega: Array
    density: Array
    direction: float
    spreading: float


class Regular(NamedTuple):
    """A regular wave.

    Attributes
    ----------
    height, period : float
        Crest to trough [m], [s].
    direction : float
        Where it goes, anticlockwise from east [rad].
    phase : float
        At the origin at t = 0 [rad]; 0 is a crest.
    """

    height: float
    period: float
    direction: float
    phase: float = 0.0


class Waves(NamedTuple):
    """A realised sea.

    Attributes
    ----------
    amplitude, omega, number, number_x, number_y, direction, phase : float64, shape (n,)
        Of each component [m], [rad/s], wave number and its east and north parts [1/m], [rad], [rad].
    gravity, depth : float
        [m/s2]; [m], ``inf`` for deep water.
    ramp : float
        Time over which the sea grows from rest [s]; 0 for none.
    """

    amplitude: Array
    omega: Array
    number: Array
    number_x: Array
    number_y: Array
    direction: Array
    phase: Array
    gravity: float
    depth: float
    ramp: float


def realise(
    systems: Sequence[Irregular | Regular],
    rng: np.random.Generator,
    *,
    gravity: float,
    depth: float,
    ramp: float,
    error: float = 0.025,
) -> Waves:
    """Return a sea drawn from its wave systems.

    Parameters
    ----------
    systems : sequence of Irregular or Regular
    rng : numpy.random.Generator
        Four uniform numbers per component are drawn, system by system, whatever the spreading; so another direction
        or spreading keeps frequencies and phases.
    gravity, depth, ramp : float
        See `Waves`.
    error : float
        Largest departure from a Gaussian sea: the magnitude of the excess kurtosis of the elevation at a point.

    Returns
    -------
    Waves

    Raises
    ------
    ValueError
        If a spectrum, a height, a period, the error or a surrounding number is out of range.

    Notes
    -----
    A sum of independent random-phase cosines has the excess kurtosis ``-3/2 sum p_i^2`` with p_i the energy
    shares; N equal ones have ``-3 / (2 N)``. So ``N = 1.5 / error`` components (20 to 2000) hold the error, and
    systems get components in proportion to their energy, each rounded up. The kurtosis is what the heights of extreme
    crests depend on first; beyond the memory of the sea the autocorrelation keeps a noise of ``1 / sqrt(2 N)``.
    A regular wave is one component and does not count: with one, the sea is not Gaussian by design.

    Each system is cut into bins of equal energy, with one frequency in each, uniform in energy; so the
    frequencies have no common divisor and the series does not repeat. Directions are drawn the same way, from bins of
    equal probability, one per component in random order. The highest frequencies with `TAIL` of the energy are
    left out, their energy goes to all components, so the variance is exact.

    All numbers are rounded to 1e-9, beyond what differs between mathematical libraries: the same seed gives the same
    bits everywhere.
    """
    if not 1.5 / MOST <= error <= 1.5 / FEWEST:
        raise ValueError(f"waves: the error is {error:g}, expected {1.5 / MOST:g} to {1.5 / FEWEST:g}")
    if not systems:
        raise ValueError("waves: no wave system is given; leave the waves out or give at least one")
    energy = [check_system(s) if isinstance(s, Irregular) else 0.0 for s in systems]
    drawn: list[tuple[Array, Array, Array, Array]] = []
    for system, own in zip(systems, energy, strict=True):
        if isinstance(system, Regular):
            drawn.append(regular_component(system))
        elif own > 0.0:
            count = int(np.ceil(own / sum(energy) * 1.5 / error - 1e-9))
            drawn.append(irregular_components(system, min(max(count, FEWEST_OF_ONE), MOST), rng))
    calm = [np.zeros(0)]
    amplitude, omega, direction, phase = (np.concatenate([part[i] for part in drawn] or calm) for i in range(4))
    return make_waves(amplitude, omega, direction, phase, gravity=gravity, depth=depth, ramp=ramp)


def make_waves(
    amplitude: Array, omega: Array, direction: Array, phase: Array, *, gravity: float, depth: float, ramp: float
) -> Waves:
    """Return a sea of given components (n,), with their wave numbers; see `Waves`."""
    if not (0.0 < gravity < np.inf and depth > 0.0 and 0.0 <= ramp < np.inf):
        raise ValueError(
            f"waves: gravity {gravity:g} m/s2, depth {depth:g} m, ramp {ramp:g} s; "
            "expected a positive gravity and depth (inf: deep), a ramp of 0 s or more"
        )
    columns = [np.ascontiguousarray(column, dtype=np.float64) for column in (amplitude, omega, direction, phase)]
    if not all(column.shape == columns[0].shape and np.isfinite(column).all() for column in columns):
        raise ValueError("waves: amplitudes, frequencies, directions and phases must be finite and equally many")
    if not (columns[1] >= SLOWEST).all():
        raise ValueError(f"waves: a component's frequency is below {SLOWEST:g} rad/s; no wind or swell is that slow")
    number = wave_numbers(columns[1], gravity, depth)
    return Waves(
        amplitude=columns[0],
        omega=columns[1],
        number=np.round(number, 12),
        number_x=np.round(number * np.cos(columns[2]), 12),
        number_y=np.round(number * np.sin(columns[2]), 12),
        direction=columns[2],
        phase=columns[3],
        gravity=float(gravity),
        depth=float(depth),
        ramp=float(ramp),
    )


def significant_height(waves: Waves) -> float:
    """Return ``4 sqrt(m0)`` of the components [m]."""
    return float(4.0 * np.sqrt(0.5 * np.sum(waves.amplitude**2)))


def irregular_components(system: Irregular, count: int, rng: np.random.Generator) -> tuple[Array, Array, Array, Array]:
    """Return amplitudes, frequencies, directions and phases (count,) of one system."""
    drawn = rng.random((count, 4))
    place = np.arange(count)
    omega = frequency_at((place + drawn[:, 0]) / count * (1.0 - TAIL), system.omega, system.density)
    order = np.argsort(drawn[:, 2], kind="stable")
    angle = spreading_angle((order + drawn[:, 3]) / count, system.spreading)
    amplitude = np.full(count, np.sqrt(2.0 * np.trapezoid(system.density, system.omega) / count))
    return (
        np.round(amplitude, 9),
        np.round(omega, 9),
        np.round(system.direction + angle, 9),
        np.round(2.0 * np.pi * drawn[:, 1], 9),
    )


def regular_component(system: Regular) -> tuple[Array, Array, Array, Array]:
    """Return amplitude, frequency, direction and phase (1,) of a regular wave."""
    if not (0.0 <= system.height < np.inf and 0.0 < system.period < np.inf):
        raise ValueError(
            f"regular wave: height {system.height:g} m, period {system.period:g} s; "
            "expected a height of 0 or more, a period above 0"
        )
    columns = (0.5 * system.height, 2.0 * np.pi / system.period, system.direction, system.phase)
    return tuple(np.round([value], 9) for value in columns)  # type: ignore[return-value]


def frequency_at(quantile: Array, omega: Array, density: Array) -> Array:
    """Return the frequencies (n,) below which these shares (n,) of the energy of a piecewise linear density lie."""
    width = np.diff(omega)
    below = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * width)])
    wanted = quantile * below[-1]
    part = np.clip(np.searchsorted(below, wanted, side="right") - 1, 0, len(width) - 1)
    slope = (density[part + 1] - density[part]) / width[part]
    missing = wanted - below[part]
    # missing = S x + slope x^2 / 2, solved in the form that neither a zero S nor a zero slope harms
    root = np.sqrt(np.maximum(density[part] ** 2 + 2.0 * slope * missing, 0.0)) + density[part]
    return omega[part] + np.divide(2.0 * missing, root, out=np.zeros(len(root)), where=root > 0.0)


def check_system(system: Irregular) -> float:
    """Return the energy [m2] of a system that can be realised."""
    omega, density = np.asarray(system.omega), np.asarray(system.density)
    if omega.ndim != 1 or omega.shape != density.shape or len(omega) < 2:
        raise ValueError(
            f"wave spectrum: frequencies {omega.shape} and densities {density.shape}, "
            "expected two columns of the same length, at least 2"
        )
    if not (np.isfinite(omega).all() and omega[0] > 0.0 and (np.diff(omega) > 0.0).all()):
        raise ValueError("wave spectrum: frequencies must be positive and rising [rad/s]")
    if not (np.isfinite(density).all() and (density >= 0.0).all()):
        raise ValueError("wave spectrum: densities must be finite and not negative [m2 s]")
    if not np.isfinite(system.direction):
        raise ValueError(f"wave spectrum: the direction is {system.direction} rad, expected a finite angle")
    return float(np.trapezoid(density, omega))

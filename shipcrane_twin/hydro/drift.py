"""Mean wave drift loads from the waves that a body sends away (far field)."""

import numpy as np

from shipcrane_twin.hydro.database import Complex
from shipcrane_twin.physics.arrays import Array

ANGLES = 144
"""Directions of the far field; a body of length L needs more than about 4 k L of them, here k L up to 57."""


def far_field(
    centres: Array,
    normals: Array,
    areas: Array,
    potential: Complex,
    normal_velocity: Complex,
    omega: float,
    gravity: float,
) -> Complex:
    """Return the amplitudes A(theta), shape (j, ANGLES), of the waves that leave a body in deep water.

    Parameters
    ----------
    centres, normals : float64, shape (p, 3)
        Panels, z up from still water, normals into the water.
    areas : float64, shape (p,)
    potential, normal_velocity : complex128, shape (j, p)
        Of j flows that radiate outwards, time factor ``e^{-iwt}`` [m2/s, m/s].
    omega, gravity : float
        [rad/s], [m/s2].

    Returns
    -------
    complex128, shape (j, ANGLES)
        The wave at distance R and angle theta, anticlockwise from x, is ``A e^{ikR} / sqrt(R)`` [m^1.5].

    Notes
    -----
    Green's second identity with the far field of a pulsating source, ``phi = -(ik/2) sqrt(2/(pi k R))
    e^{kz + ikR - i pi/4} S``, where ``S = int (phi_n - phi d/dn) e^{k z - ik (x cos + y sin)} dS``
    (Newman 1967; Wehausen and Laitone 1960, section 13). Elevation is ``i w / g phi``.
    """
    number = omega**2 / gravity
    theta = np.arange(ANGLES) * (2.0 * np.pi / ANGLES)
    along = np.stack([np.cos(theta), np.sin(theta)])
    wave = np.exp(number * centres[:, 2:] - 1j * number * (centres[:, :2] @ along)) * areas[:, None]
    slope = number * (normals[:, 2:] - 1j * (normals[:, :2] @ along)) * wave
    strength = normal_velocity @ wave - potential @ slope
    return omega / gravity * np.sqrt(number / (2.0 * np.pi)) * np.exp(-0.25j * np.pi) * strength


def mean_drift(
    amplitudes: Complex, direction: float, number: float, absorbed: float, water_density: float, gravity: float
) -> tuple[Array, float]:
    """Return the mean load in a wave of unit amplitude, and how well the energy closes.

    Parameters
    ----------
    amplitudes : complex128, shape (n,)
        Of the waves that leave the body, at equidistant angles from x: ``A e^{ikR} / sqrt(R)``, time factor
        ``e^{-iwt}``, the incident wave being ``e^{ik (x cos + y sin)}`` [m^0.5 per m].
    direction : float
        Where the incident wave goes [rad].
    number : float
        Wave number k, deep water [1/m].
    absorbed : float
        Mean power that the body takes up, over ``w / k`` [N per squared amplitude].
    water_density, gravity : float

    Returns
    -------
    load : float64, shape (3,)
        Surge force, sway force [N/m2], yaw moment about the origin [N/m].
    closure : float
        Power taken from the incident wave over power sent away and absorbed; 1 if energy is conserved.

    Notes
    -----
    Momentum: Maruo (1960), ``F = rho g / 4 int |A|^2 (e_wave - e_theta) dtheta + P k / w e_wave``; waves of deep
    water carry ``rho g |A|^2 / 4`` each way. Moment: Newman (1967), the angular momentum of the same waves,
    ``-(rho g / 4k) Im int A* A' dtheta``, and of what is taken from the incident wave,
    ``-(rho g / 2k) sqrt(2 pi / k) Im(A'(direction) e^{i pi/4})``. Here the momentum in the wave's direction is
    taken as positive energy, not as the small difference of large numbers that the Kochin function gives.
    """
    n = len(amplitudes)
    theta = np.arange(n) * (2.0 * np.pi / n)
    step = 2.0 * np.pi / n
    orders = np.fft.fftfreq(n, 1.0 / n)
    spectrum = np.fft.fft(amplitudes) / n
    slopes = np.fft.ifft(1j * orders * spectrum) * n
    forward = np.exp(1j * orders * direction)
    unit = 0.25 * water_density * gravity
    flux = unit * np.abs(amplitudes) ** 2 * step
    taken = flux.sum() + absorbed
    stationary = np.sqrt(2.0 * np.pi / number) * np.exp(0.25j * np.pi)
    force = taken * np.array([np.cos(direction), np.sin(direction)])
    force -= np.array([flux @ np.cos(theta), flux @ np.sin(theta)])
    angular = unit / number * step * (amplitudes.conj() * slopes).imag.sum()
    shadow = 2.0 * unit / number * ((1j * orders * spectrum) @ forward * stationary).imag
    closure = -2.0 * unit * ((spectrum @ forward) * stationary).real / taken
    return np.array([force[0], force[1], -angular - shadow]), float(closure)

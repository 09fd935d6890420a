import numpy as np
from imported_ships import radiation

from shipcrane_twin.hydro.memory import infinite_added_mass, retardation


def test_retardation_of_a_damped_oscillation():
    # K(s) = s / (s^2 + 2 d s + w0^2) has K(t) = e^{-d t} (cos(p t) - d/p sin(p t)), p^2 = w0^2 - d^2
    d, w0 = 0.4, 1.1
    p = np.sqrt(w0**2 - d**2)
    omega = np.linspace(0.02, 40.0, 4000)
    s = 1j * omega
    time = np.linspace(0.1, 12.0, 40)
    found = retardation(omega, (s / (s**2 + 2 * d * s + w0**2)).real, time)
    expected = np.exp(-d * time) * (np.cos(p * time) - d / p * np.sin(p * time))
    np.testing.assert_allclose(found, expected, atol=0.02)


def test_infinite_added_mass_follows_from_the_table():
    omega = np.linspace(0.05, 8.0, 160)
    infinite, added, damping = radiation(omega)
    found = infinite_added_mass(omega, added, damping)
    scale = np.sqrt(np.diag(infinite))
    np.testing.assert_allclose(found / np.outer(scale, scale), infinite / np.outer(scale, scale), atol=0.02)


def test_damping_beyond_the_table_falls_with_the_third_power():
    omega = np.linspace(0.01, 3.0, 300)
    damping = np.where(omega < 1.0, omega, omega**-3.0)
    found = retardation(omega, damping, np.array([0.0]))
    # (2/pi) (1/2 below w = 1, (1 - 12^-2)/2 from there to the grid's end)
    np.testing.assert_allclose(found, 2.0 / np.pi * (0.5 + 0.5 * (1.0 - 12.0**-2)), rtol=2e-3)

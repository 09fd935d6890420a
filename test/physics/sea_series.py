"""Time series of a realised sea, and seas to take them of."""

import numpy as np
from numba import njit

from shipcrane_twin.physics.sea.components import Irregular, realise
from shipcrane_twin.physics.sea.spectra import grid, jonswap
from shipcrane_twin.physics.sea.trig import sincos

GRAVITY = 9.80665
HEIGHT, PERIOD, GAMMA = 2.0, 8.0, 3.3
OMEGA = grid(PERIOD)
DENSITY = jonswap(OMEGA, HEIGHT, PERIOD, GAMMA)


def jonswap_sea(seed, error=0.025, direction=0.3, spreading=np.inf, depth=np.inf, ramp=0.0):
    system = Irregular(OMEGA, DENSITY, direction, spreading)
    return realise([system], np.random.default_rng(seed), gravity=GRAVITY, depth=depth, ramp=ramp, error=error)


@njit
def harmonic_series(amplitude, omega, phase, t):
    total = np.zeros(t.shape[0])
    for i in range(amplitude.shape[0]):
        for j in range(t.shape[0]):
            total[j] += amplitude[i] * sincos(omega[i] * t[j] + phase[i])[1]
    return total


def series(waves, t):
    """Elevation at the origin at many times."""
    return harmonic_series(waves.amplitude, waves.omega, waves.phase, t)

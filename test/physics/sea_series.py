"""Seas to take time series of."""

import numpy as np

from shipcrane_twin.physics.sea.components import Irregular, realise
from shipcrane_twin.validation.sea import DENSITY, GAMMA, GRAVITY, HEIGHT, OMEGA, PERIOD, harmonic_series, series

__all__ = ["DENSITY", "GAMMA", "GRAVITY", "HEIGHT", "OMEGA", "PERIOD", "harmonic_series", "jonswap_sea", "series"]


def jonswap_sea(seed, error=0.025, direction=0.3, spreading=np.inf, depth=np.inf, ramp=0.0):
    system = Irregular(OMEGA, DENSITY, direction, spreading)
    return realise([system], np.random.default_rng(seed), gravity=GRAVITY, depth=depth, ramp=ramp, error=error)

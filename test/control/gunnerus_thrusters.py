"""Gunnerus' thrusters as the allocation sees them."""

import numpy as np

from shipcrane_twin.control.allocation_setup import allocation_params, opposing_bias

POSITION = np.array([[-14.0, 2.0, -3.6], [-14.0, -2.0, -3.6], [14.5, 0.0, -3.6]])
AZIMUTHING = np.array([1.0, 1.0, 0.0])
THRUST = np.array([54e3, 54e3, 20e3])
WHOLE = np.ones(3)
ZONE = np.deg2rad(20.0)
"""Half of the sector in which the jet of one azimuth would hit the other."""


def thrusters(method="qp", yaw_first=True, bias=0.0, hold=0.0, zones=True):
    across = [[(np.pi / 2, ZONE)], [(-np.pi / 2, ZONE)], []]
    return allocation_params(
        position=POSITION,
        azimuthing=AZIMUTHING,
        axis=np.array([0.0, 0.0, np.pi / 2]),
        thrust_max=THRUST,
        power_max=np.array([500e3, 500e3, 200e3]),
        azimuth_rate_max=np.deg2rad([12.0, 12.0, 12.0]),
        azimuth_lag=np.full(3, 0.4),
        thrust_rate_max=THRUST / 5.0,
        period=0.1,
        forbidden=across if zones else [[], [], []],
        bias=opposing_bias(POSITION, AZIMUTHING, bias),
        hold_thrust=np.full(3, hold),
        yaw_first=yaw_first,
        method=method,
    )


def load_of(thrust):
    """Surge, sway, yaw of thrust components (.., 3, 2) [N]."""
    x, y = POSITION[:, 0], POSITION[:, 1]
    forward, port = thrust[..., 0], thrust[..., 1]
    return np.stack((forward.sum(-1), port.sum(-1), (x * port - y * forward).sum(-1)), axis=-1)


def random_thrust(rng, count):
    """Thrust components (count, 3, 2) [N] within all limits and zones, of the inscribed polygon too."""
    azimuth = rng.uniform(np.pi / 2 + ZONE, 5.0 * np.pi / 2 - ZONE, (count, 2)) * np.array([1.0, -1.0])
    size = 54e3 * np.cos(np.pi / 32) * np.sqrt(rng.uniform(size=(count, 2)))
    thrust = np.zeros((count, 3, 2))
    thrust[:, :2, 0], thrust[:, :2, 1] = size * np.cos(azimuth), size * np.sin(azimuth)
    thrust[:, 2, 1] = rng.uniform(-20e3, 20e3, count)
    return thrust


def in_zone(azimuth, slack=1e-6):
    """Whether azimuths (.., >= 2) of the two stern thrusters point into their forbidden zones."""
    off = (azimuth[..., :2] - np.array([np.pi / 2, -np.pi / 2]) + np.pi) % (2.0 * np.pi) - np.pi
    return np.abs(off) < ZONE - slack

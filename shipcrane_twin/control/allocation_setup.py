"""Constants of the thrust allocation, from what a ship's data sheet gives."""

from typing import NamedTuple

import numpy as np

from shipcrane_twin.control.azimuth_sectors import Zones, allowed_arcs, convex_pieces, padded
from shipcrane_twin.physics.arrays import Array

METHODS = {"qp": 0, "pseudo_inverse": 1}


class AllocationParams(NamedTuple):
    """Constants of the allocation; float64, shape (n,), unless noted.

    Attributes
    ----------
    effect : float64, shape (3, 2 n)
        Load of each thruster's full thrust, columns (forward, port), over ``load_scale``; a tunnel's first column
        is its thrust along its axis, its second is zero.
    load_scale : float64, shape (3,)
        [N, N, N m].
    azimuthing, axis : float64
        1 turns, 0 is a tunnel thruster; azimuth of a tunnel [rad].
    thrust_max : float64
        [N].
    power_share : float64
        Power at full thrust over that of all thrusters; power is taken as its quadratic approximation, exact at
        none and full thrust and between them below ``T^1.5``, by 11 % of the full power at most.
    azimuth_step, thrust_step : float64
        Largest change over one period [rad], [N].
    lead_max : float64
        By which an azimuth's command may lead the measured azimuth and still move on [rad].
    arcs, pieces : float64, shape (n, k, 2)
        See `azimuth_sectors`.
    bias : float64, shape (2 n,)
        Thrust components over full thrust that cost nothing: thrusters that push against each other keep turning.
    hold_thrust : float64
        Below it an azimuth stays where it points [N].
    along_weight, across_weight, yaw_weight : float
        Of what is missing of the load, over that of power: force along the asked direction, force across it, yaw.
    method : int
        Of `METHODS`.
    """

    effect: Array
    load_scale: Array
    azimuthing: Array
    axis: Array
    thrust_max: Array
    power_share: Array
    azimuth_step: Array
    thrust_step: Array
    lead_max: Array
    arcs: Array
    pieces: Array
    bias: Array
    hold_thrust: Array
    along_weight: float
    across_weight: float
    yaw_weight: float
    method: int


LOAD_WEIGHT, PRIORITY = 3e7, 1e3
"""Weight of missing load over power, with which a load that can be given is given to 1e-6 of the full load; of what
comes first over what comes next: yaw, force across the asked direction, force along it, or yaw after the two."""


def allocation_params(
    *,
    position: Array,
    azimuthing: Array,
    axis: Array,
    thrust_max: Array,
    power_max: Array,
    azimuth_rate_max: Array,
    azimuth_lag: Array,
    thrust_rate_max: Array,
    period: float,
    forbidden: Zones,
    bias: Array,
    hold_thrust: Array,
    yaw_first: bool,
    method: str,
) -> AllocationParams:
    """Return the constants of the allocation.

    Parameters
    ----------
    position : float64, shape (n, 2 or 3)
        Thrusters seen from the CoG, body axes [m].
    azimuthing, axis, thrust_max, power_max : float64, shape (n,)
        1 or 0; azimuth of tunnels [rad]; [N]; [W].
    azimuth_rate_max, azimuth_lag : float64, shape (n,)
        [rad/s]; lag of the servo [s], behind which the command leads by ``rate * lag`` while it turns.
    thrust_rate_max : float64, shape (n,)
        [N/s].
    period : float
        Time between two allocations [s].
    forbidden : sequence of n sequences of (centre, half width)
        Azimuths of thrust that a thruster must not take [rad]; its jet goes the other way.
    bias : float64, shape (n, 2)
        Forward and port thrust at rest [N]; should add up to no load.
    hold_thrust : float64, shape (n,)
        [N].
    yaw_first : bool
        Which of yaw and position is kept when not both can be.
    method : str
        "qp" or "pseudo_inverse".

    Raises
    ------
    ValueError
        For an unknown method, zones that overlap, or a limit that is not positive.
    """
    if method not in METHODS:
        raise ValueError(f"allocation: method {method!r} is unknown; use one of {sorted(METHODS)}")
    for name, limit in (("thrust_max", thrust_max), ("power_max", power_max), ("azimuth_rate_max", azimuth_rate_max)):
        if not np.all(np.asarray(limit) > 0.0):
            raise ValueError(f"allocation: {name} is {limit}; every thruster needs a value above 0")
    steers = azimuthing != 0.0
    cos = np.where(steers, 1.0, np.cos(axis))
    sin = np.where(steers, 0.0, np.sin(axis))
    x, y = position[:, 0], position[:, 1]
    effect = np.zeros((3, 2 * len(x)))
    effect[:, 0::2] = cos, sin, x * sin - y * cos
    effect[:, 1::2] = 0.0 * steers, 1.0 * steers, x * steers
    force = thrust_max.sum()
    scale = np.array([force, force, force * max(np.hypot(x, y).max(), 1.0)])
    arcs = [allowed_arcs(zones) for zones in forbidden]
    low, middle, high = LOAD_WEIGHT, LOAD_WEIGHT * PRIORITY, LOAD_WEIGHT * PRIORITY**2
    along, across, yaw = (low, middle, high) if yaw_first else (middle, high, low)
    return AllocationParams(
        effect=effect * np.repeat(thrust_max, 2) / scale[:, None],
        load_scale=scale,
        azimuthing=1.0 * steers,
        axis=np.asarray(axis, dtype=float),
        thrust_max=np.asarray(thrust_max, dtype=float),
        power_share=power_max / power_max.sum(),
        azimuth_step=azimuth_rate_max * period,
        thrust_step=thrust_rate_max * period,
        lead_max=azimuth_rate_max * (2.0 * azimuth_lag + 2.0 * period),
        arcs=padded(arcs),
        pieces=padded([convex_pieces(each) for each in arcs]),
        bias=(bias * steers[:, None] / thrust_max[:, None]).ravel(),
        hold_thrust=np.maximum(hold_thrust, 1e-9 * thrust_max),
        along_weight=along,
        across_weight=across,
        yaw_weight=yaw,
        method=METHODS[method],
    )


def opposing_bias(position: Array, azimuthing: Array, thrust: float) -> Array:
    """Return thrust (n, 2) [N] of the azimuths towards their midst: two of them push against each other, jets outward.

    With more than two the sum may be a load; the allocation takes it back with the least power.
    """
    steers = azimuthing != 0.0
    inward = position[steers, :2].mean(axis=0) - position[:, :2]
    size = np.linalg.norm(inward, axis=1, keepdims=True)
    return np.where(steers[:, None] & (size > 0.0), thrust * inward / np.where(size > 0.0, size, 1.0), 0.0)

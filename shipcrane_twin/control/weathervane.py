"""Weather-optimal heading: the heading set-point turns slowly until the mean sway demand vanishes, bow to the weather.

State, float64 (2,): low-passed horizontal load asked of the thrusters (east, north) [N].
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import wrap_angle


class WeathervaneParams(NamedTuple):
    """Constants of the weather-optimal heading.

    Attributes
    ----------
    rate_max : float
        Largest turn rate of the set-point [rad/s].
    full_load : float
        Mean sway demand from which it turns that fast [N]; below it the rate is in proportion.
    cutoff_period : float
        Of the low-pass on the demand [s]: well above the periods of waves and of the DP itself.
    period : float
        Time between two updates [s].
    """

    rate_max: float
    full_load: float
    cutoff_period: float
    period: float


@njit(cache=True)
def weathervane_step(
    params: WeathervaneParams, state: Array, demand_b: Array, yaw: float, heading: float
) -> tuple[Array, float]:
    """Return state (2,) and heading set-point [rad] one period later.

    Parameters
    ----------
    params : WeathervaneParams
    state : float64, shape (2,)
        Zeros at the start.
    demand_b : float64, shape (3,)
        Load asked of the thrusters, body axes [N, N, N m], feed-forward included.
    yaw : float
        Of the ship [rad].
    heading : float
        Yaw set-point so far [rad].

    Notes
    -----
    Fossen and Strand (2001) let the ship be a pendulum in the field of the weather. Here the set-point's rate is in
    proportion to the mean sway demand: thrust to port holds against weather from port, so the bow goes to port.
    With a sway load of slope Y [N/rad] by heading about the bow-on heading it converges with the time constant
    ``full_load / (rate_max Y)``, which has to be long against the heading control. Where thrust has to go astern, the
    weather comes from behind: the whole load counts then, so that the ship does not linger stern on, where the sway
    demand vanishes as well. The demand is low-passed in the world, where a turn of the ship leaves it unchanged.
    A demand or yaw that is not finite changes nothing.
    """
    if not (np.isfinite(demand_b[0]) and np.isfinite(demand_b[1]) and np.isfinite(yaw)):
        return state.copy(), heading
    cos, sin = np.cos(yaw), np.sin(yaw)
    share = 1.0 - np.exp(-2.0 * np.pi * params.period / params.cutoff_period)
    new = np.empty(2)
    new[0] = state[0] + share * (cos * demand_b[0] - sin * demand_b[1] - state[0])
    new[1] = state[1] + share * (sin * demand_b[0] + cos * demand_b[1] - state[1])
    surge, sway = cos * new[0] + sin * new[1], -sin * new[0] + cos * new[1]
    if surge < 0.0:
        size = np.sqrt(surge * surge + sway * sway)
        sway = size if sway >= 0.0 else -size
    rate = params.rate_max * min(1.0, max(-1.0, sway / params.full_load))
    return new, wrap_angle(heading + rate * params.period)

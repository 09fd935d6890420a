"""Overload limiter of a crane: hook load against the load chart, warning, and a cut-out for motions outward.

The chart gives the safe working load over the radius, the tip's horizontal distance from the slew axis in the crane's
own axes. Utilisation is hook load over safe working load, which at one radius is load moment over rated
moment as well. Above the cut-out level the limiter latches until the utilisation is back below the release level;
meanwhile motions that make the radius longer, and hoisting, are refused, others not. A refused joint is told to stand
still, so that it stops as softly as at any other command.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_chain import ChainParams, forward_kinematics, tip_jacobian
from shipcrane_twin.physics.crane_reference import POSITION, VELOCITY

LOAD, UTILISATION, CUT_OUT = 0, 1, 2
"""Columns of the limiter's state: smoothed hook load [kg], its utilisation, 1 while cut out."""

UTILISATION_MOST = 1e3
"""What is told where the chart ends and any load is too much."""

OUTWARD = 1e-6
"""Gain of radius per unit of a joint [m/rad, m/m] from which a motion counts as outward."""


class LoadLimiterParams(NamedTuple):
    """Chart and levels; see `make_limiter`.

    Attributes
    ----------
    radius, load : float64, shape (m,)
        Radius [m] and safe working load there [kg].
    warning, cut_out, release : float
        Levels of the utilisation.
    share : float
        Share of the way to the present hook load that the smoothed one goes in a step.
    """

    radius: Array
    load: Array
    warning: float
    cut_out: float
    release: float
    share: float


def make_limiter(
    chart: ArrayLike, *, warning: float, cut_out: float, release: float, filter_s: float, step_s: float
) -> LoadLimiterParams:
    """Check and pack a limiter.

    Parameters
    ----------
    chart : array_like, shape (m, 2)
        Radius [m], rising, and safe working load [kg], falling.
    warning, cut_out, release : float
    filter_s, step_s : float
        Time constant of the hook load's low-pass and step [s].

    Raises
    ------
    ValueError
        If the chart's radii do not rise, or its loads rise.
    """
    rows = np.array(chart, dtype=np.float64)
    if np.any(np.diff(rows[:, 0]) <= 0.0):
        raise ValueError(f"load chart: radii are {rows[:, 0].tolist()} m, expected each greater than the one before")
    if np.any(np.diff(rows[:, 1]) > 0.0):
        raise ValueError(f"load chart: loads are {rows[:, 1].tolist()} kg, expected none greater than the one before")
    share = -float(np.expm1(-step_s / filter_s))
    return LoadLimiterParams(rows[:, 0].copy(), rows[:, 1].copy(), warning, cut_out, release, share)


@njit(cache=True)
def safe_working_load(params: LoadLimiterParams, radius: float) -> float:
    """Return the safe working load [kg] at a radius [m]: linear in the chart, its first row inside, 0 beyond it."""
    if radius > params.radius[-1]:
        return 0.0
    return float(np.interp(radius, params.radius, params.load))


@njit(cache=True)
def utilisation(params: LoadLimiterParams, hook_load: float, radius: float) -> float:
    """Return hook load [kg] over safe working load at a radius [m]; infinite for a load beyond the chart."""
    if hook_load <= 0.0:
        return 0.0
    safe = safe_working_load(params, radius)
    return hook_load / safe if safe > 0.0 else np.inf


@njit(cache=True)
def radius_and_slopes(chain: ChainParams, q: Array) -> tuple[float, Array]:
    """Return the tip's radius [m] and its derivative over the joints (n,) [m/rad, m/m] at q (n,)."""
    n = chain.kind.shape[0]
    tip = forward_kinematics(chain, q)[0][n]
    jacobian = tip_jacobian(chain, q)
    radius = np.sqrt(tip[0] ** 2 + tip[1] ** 2)
    slopes = np.zeros(n)
    if radius > 0.0:
        for i in range(n):
            slopes[i] = (tip[0] * jacobian[0, i] + tip[1] * jacobian[1, i]) / radius
    return radius, slopes


@njit(cache=True)
def limiter_step(params: LoadLimiterParams, state: Array, hook_load: float, radius: float) -> Array:
    """Return the state (3,) of the limiter a step later, for the present hook load [kg] and radius [m]."""
    new = state.copy()
    new[LOAD] += params.share * (hook_load - state[LOAD])
    new[UTILISATION] = utilisation(params, new[LOAD], radius)
    if new[UTILISATION] >= params.cut_out:
        new[CUT_OUT] = 1.0
    elif new[UTILISATION] < params.release:
        new[CUT_OUT] = 0.0
    return new


@njit(cache=True)
def allowed_commands(
    state: Array, slopes: Array, q: Array, mode: Ints, command: Array
) -> tuple[Ints, Array]:
    """Return modes and commands (n,) without what would lengthen the radius while the limiter is cut out.

    Parameters
    ----------
    state : float64, shape (3,)
    slopes : float64, shape (n,)
        See `radius_and_slopes`.
    q : float64, shape (n,)
        Joint values, to tell the direction of a position command.
    mode, command : int64 and float64, shape (n,)
        See `crane_reference.advance_path`.
    """
    modes, out = mode.copy(), command.copy()
    if state[CUT_OUT] > 0.0:
        for i in range(out.shape[0]):
            way = out[i] - q[i] if modes[i] == POSITION else out[i]
            if (way > 0.0 and slopes[i] > OUTWARD) or (way < 0.0 and slopes[i] < -OUTWARD):
                modes[i], out[i] = VELOCITY, 0.0
    return modes, out


@njit(cache=True)
def limit_load(
    params: LoadLimiterParams, chain: ChainParams, state: Array, hook_load: float, q: Array, mode: Ints, command: Array
) -> tuple[Array, Ints, Array]:
    """Return the limiter's state (3,) a step later, and what it leaves of modes and commands (n,)."""
    radius, slopes = radius_and_slopes(chain, q)
    new = limiter_step(params, state, hook_load, radius)
    modes, out = allowed_commands(new, slopes, q, mode, command)
    return new, modes, out


@njit(cache=True)
def load_state(params: LoadLimiterParams, state: Array, radius: float) -> Array:
    """Return what is told of the load at a radius [m].

    Returns
    -------
    float64, shape (5,)
        Radius [m], safe working load there [kg], smoothed hook load [kg], its utilisation, at most
        `UTILISATION_MOST`, and 1 while the limiter is cut out.
    """
    out = np.empty(5)
    out[0], out[1], out[2] = radius, safe_working_load(params, radius), state[LOAD]
    out[3], out[4] = min(state[UTILISATION], UTILISATION_MOST), state[CUT_OUT]
    return out


def hoisting_allowed(state: Array) -> bool:
    """Return whether the winch may hoist, by the limiter's state (3,) or by what is told of it, `load_state` (5,)."""
    return not state[-1] > 0.0


def warned(params: LoadLimiterParams, state: Array) -> bool:
    """Return whether the operator is to be warned."""
    return bool(state[UTILISATION] >= params.warning)

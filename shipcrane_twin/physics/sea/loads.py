"""Wave loads on a ship: first order from excitation transfer functions, mean and slow drift after Newman."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.sea.components import Waves
from shipcrane_twin.physics.sea.kinematics import ramp_factor
from shipcrane_twin.physics.sea.trig import sincos

ROWS = 181
"""Wave directions from 0 to pi in the tables of the components, one per degree."""

COLUMNS = 15
"""Real and imaginary parts of six first-order loads, three drift loads."""


MIRROR = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
"""Signs of a load (6,) when the wave comes from the other side."""


class WaveLoadParams(NamedTuple):
    """Transfer functions of a ship at the frequencies of a realised sea.

    Attributes
    ----------
    table : float64, shape (n, ROWS, COLUMNS)
        For each component and direction, multiplied by the amplitude: real parts (6) and imaginary parts (6) of
        the first-order load [N, N m]; multiplied by its square: the drift (3) [N, N m].
    first_order, drift : float
        1 to have these loads, 0 to leave them out.
    """

    table: Array
    first_order: float
    drift: float


def wave_load_params(
    waves: Waves,
    omega: Array,
    direction: Array,
    excitation: NDArray[np.complex128],
    drift: Array,
    *,
    first_order: bool = True,
    slow_drift: bool = True,
) -> WaveLoadParams:
    """Resample a ship's transfer functions for a realised sea.

    Parameters
    ----------
    waves : Waves
    omega : float64, shape (n,)
        Frequencies of the tables, rising [rad/s].
    direction : float64, shape (m,)
        Where the wave goes, anticlockwise from the bow, rising from 0 to pi [rad].
    excitation : complex128, shape (n, m, 6)
        First-order load per amplitude, FLU, time factor e^{+i w t} [N/m, N].
    drift : float64, shape (n, m, 3)
        Mean surge, sway and yaw load per squared amplitude [N/m2, N/m].
    first_order, slow_drift : bool
        Which loads `wave_load` has.

    Raises
    ------
    ValueError
        If shapes do not fit, or frequencies or directions are out of order or missing.

    Notes
    -----
    Real and imaginary parts are interpolated over frequency and direction by `local_cubic`, never the phase,
    which jumps. The hull is the same on both sides, so the load of a wave from the other side has surge, heave and
    pitch alike and sway, roll and yaw reversed. Drift is linear over frequency, where it peaks at resonances.

    Below the lowest frequency all values are held. Above the highest one the first-order load falls with
    ``w^-2``, as the pressure on a hull that is large against the wave does, and the drift is held: short waves are
    reflected whatever their length. `outside_shares` says how much of the sea that concerns.
    """
    check_tables(omega, direction, excitation, drift)
    own = np.clip(waves.omega, omega[0], omega[-1])
    beyond = np.minimum(1.0, omega[-1] / waves.omega) ** 2
    tables = (
        local_cubic(omega, excitation.real, own) * (beyond * waves.amplitude)[:, None, None],
        local_cubic(omega, excitation.imag, own) * (beyond * waves.amplitude)[:, None, None],
        linear(omega, drift, own) * (waves.amplitude**2)[:, None, None],
    )
    table = np.concatenate([around_the_ship(direction, values) for values in tables], axis=2)
    return WaveLoadParams(table=table, first_order=float(first_order), drift=float(slow_drift))


def outside_shares(waves: Waves, omega: Array) -> tuple[float, float]:
    """Return the shares of the sea's energy below and above the frequencies (n,) of a table [rad/s]."""
    energy = waves.amplitude**2
    total = max(float(energy.sum()), np.finfo(float).tiny)
    below, above = waves.omega < omega[0], waves.omega > omega[-1]
    return float(energy[below].sum()) / total, float(energy[above].sum()) / total


@njit(cache=True)
def wave_load(params: WaveLoadParams, waves: Waves, t: float, x: float, y: float, yaw: float) -> tuple[Array, Array]:
    """Return first-order (6,) and drift load (3,) of the waves on a ship [N, N m].

    Parameters
    ----------
    params : WaveLoadParams
    waves : Waves
        The sea for which they were made.
    t : float
        [s].
    x, y : float
        East and north of the point that the transfer functions refer to [m].
    yaw : float
        Anticlockwise from east [rad].

    Returns
    -------
    first_order : float64, shape (6,)
        About that point, in the ship's horizontal axes forward, port, up.
    drift : float64, shape (3,)
        Surge, sway, yaw.

    Notes
    -----
    First order: ``Re sum a X(w, d - yaw) e^{i phi}`` with phi the phase of the component at the ship's place.
    Drift: Newman's (1974) approximation ``T_ij = sgn sqrt(T_i T_j)`` in the O(n) form
    ``|sum a sqrt(T+) e^{i phi}|^2 - |sum a sqrt(T-) e^{i phi}|^2``, with T+ and T- the positive and negative parts
    of the mean drift. The squared envelope has no sum frequencies, its mean is the sum of the mean drifts, and one
    component gives ``a^2 T``. It holds for horizontal motions with long natural periods.
    Values are linear between the rows of the table.
    First order carries the factor of the growing sea, drift its square.
    """
    n = waves.amplitude.shape[0]
    sines, cosines = np.empty(n), np.empty(n)
    for i in range(n):  # apart from the loop below, so that it compiles to vector instructions
        angle = waves.omega[i] * t - (waves.number_x[i] * x + waves.number_y[i] * y) + waves.phase[i]
        sines[i], cosines[i] = sincos(angle)
    first, drift, envelope = np.zeros(6), np.empty(3), np.zeros((4, 3))
    for i in range(n):
        relative = (waves.direction[i] - yaw) * (0.5 / np.pi)
        turn = relative - np.floor(relative + 0.5)  # -1/2 to 1/2; the remainder of a division would take longer
        side = 1.0 if turn >= 0.0 else -1.0
        place = abs(turn) * (2.0 * (ROWS - 1))
        row = min(int(place), ROWS - 2)
        share = place - row
        cosine, sine = cosines[i], sines[i]
        low, high = params.table[i, row], params.table[i, row + 1]
        for k in range(6):
            real = low[k] + share * (high[k] - low[k])
            imag = low[k + 6] + share * (high[k + 6] - low[k + 6])
            first[k] += (1.0 if k % 2 == 0 else side) * (real * cosine - imag * sine)
        for k in range(3):
            mean = (1.0 if k == 0 else side) * (low[k + 12] + share * (high[k + 12] - low[k + 12]))
            root = np.sqrt(abs(mean))
            plus = root if mean > 0.0 else 0.0
            minus = root - plus
            envelope[0, k] += plus * cosine
            envelope[1, k] += plus * sine
            envelope[2, k] += minus * cosine
            envelope[3, k] += minus * sine
    factor = ramp_factor(waves.ramp, t)
    for k in range(6):
        first[k] *= params.first_order * factor
    for k in range(3):
        drift[k] = envelope[0, k] ** 2 + envelope[1, k] ** 2 - envelope[2, k] ** 2 - envelope[3, k] ** 2
        drift[k] *= params.drift * factor * factor
    return first, drift


def around_the_ship(direction: Array, values: Array) -> Array:
    """Return loads (n, ROWS, k) at the rows of the table from those (n, m, k) at directions (m,).

    Notes
    -----
    k is 6, or 3 for surge, sway and yaw. Beyond 0 and pi the table goes on with its mirror image.
    """
    signs = MIRROR if values.shape[2] == 6 else MIRROR[[0, 1, 5]]
    angle = np.concatenate([-direction[2:0:-1], direction, 2.0 * np.pi - direction[-2:-4:-1]])
    around = np.concatenate([values[:, 2:0:-1] * signs, values, values[:, -2:-4:-1] * signs], axis=1)
    rows = np.linspace(0.0, np.pi, ROWS)
    return np.swapaxes(local_cubic(angle, np.swapaxes(around, 0, 1), rows), 0, 1)


def local_cubic(place: Array, values: Array, wanted: Array) -> Array:
    """Return values (k, ...) at places (k,) within a table of rising places (n,), values (n, ...).

    Notes
    -----
    Cubic Hermite polynomials; the slopes are those of the parabola through three neighbours (Bessel's). The error
    falls with the third power of the spacing or faster, a disturbed value affects its neighbours only, and no solver is
    involved whose rounding could differ between machines.
    """
    shape = (-1,) + (1,) * (values.ndim - 1)
    width = np.diff(place).reshape(shape)
    chord = np.diff(values, axis=0) / width
    inner = (width[:-1] * chord[1:] + width[1:] * chord[:-1]) / (width[:-1] + width[1:])
    slope = np.concatenate([2.0 * chord[:1] - inner[:1], inner, 2.0 * chord[-1:] - inner[-1:]])
    low = np.clip(np.searchsorted(place, wanted, side="right") - 1, 0, len(place) - 2)
    step = width[low]
    s = (wanted - place[low]).reshape(shape) / step
    return (
        (1.0 + 2.0 * s) * (1.0 - s) ** 2 * values[low]
        + s * (1.0 - s) ** 2 * step * slope[low]
        + s * s * (3.0 - 2.0 * s) * values[low + 1]
        + s * s * (s - 1.0) * step * slope[low + 1]
    )


def linear(place: Array, values: Array, wanted: Array) -> Array:
    """Return values (k, ...) at places (k,) of a table, places (n,) and values (n, ...), on straight lines."""
    low = np.clip(np.searchsorted(place, wanted, side="right") - 1, 0, len(place) - 2)
    share = ((wanted - place[low]) / (place[low + 1] - place[low])).reshape((-1,) + (1,) * (values.ndim - 1))
    return (1.0 - share) * values[low] + share * values[low + 1]


def check_tables(omega: Array, direction: Array, excitation: NDArray[np.complex128], drift: Array) -> None:
    """Refuse transfer functions that cannot be resampled."""
    n, m = len(omega), len(direction)
    if excitation.shape != (n, m, 6) or drift.shape != (n, m, 3):
        raise ValueError(
            f"wave loads: {n} frequencies, {m} directions, excitation {excitation.shape}, drift {drift.shape}; "
            f"expected {(n, m, 6)} and {(n, m, 3)}"
        )
    if n < 3 or not (omega[0] > 0.0 and (np.diff(omega) > 0.0).all()):
        raise ValueError("wave loads: frequencies must be positive and rising, at least 3 [rad/s]")
    covered = m >= 4 and abs(direction[0]) < 1e-6 and abs(direction[-1] - np.pi) < 1e-6
    if not (covered and (np.diff(direction) > 0.0).all()):
        raise ValueError("wave loads: directions must rise from 0 to pi, at least 4 [rad]")
    if not (np.isfinite(excitation).all() and np.isfinite(drift).all()):
        raise ValueError("wave loads: the transfer functions hold numbers that are not finite")

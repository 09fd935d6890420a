"""The DP loop, linearised about a ship at rest on its set-point: eigenvalues and margins.

Ship in the horizontal plane, thrusters with a first-order lag, measurement with a delay, observer or none, PID. With
the heading at zero, body and world axes are the same.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shipcrane_twin.control.controller import ControllerParams
from shipcrane_twin.physics.arrays import Array

HORIZONTAL = (0, 1, 5)
"""Surge, sway and yaw of six degrees of freedom."""

OMEGA = np.geomspace(1e-4, 10.0, 2001)
"""Frequencies of the loop transfer functions [rad/s]."""


class LinearObserver(NamedTuple):
    """An observer ``x' = a x + b_measured y + b_load tau``, ``(pose, velocity) = c x``.

    Attributes
    ----------
    a : float64, shape (n, n)
    b_measured, b_load : float64, shape (n, 3)
        For the measured pose, and for the load of the thrusters.
    c : float64, shape (6, n)
    """

    a: Array
    b_measured: Array
    b_load: Array
    c: Array


class LoopReport(NamedTuple):
    """What the linearised loop does; arrays of shape (3,) are for surge, sway, yaw, the other two axes closed.

    Attributes
    ----------
    eigenvalues : complex128, shape (n,)
        Of the closed loop, the slowest first [1/s].
    slowest_s : float
        Time constant of the slowest of them [s]; infinite if the loop is not stable.
    crossover : float64, shape (3,)
        Highest frequency at which the loop gain is one [rad/s]; nan if there is none.
    phase_margin_deg : float64, shape (3,)
        The smallest of all crossovers; negative beyond instability.
    gain_up_db, gain_down_db : float64, shape (3,)
        By how much the loop gain may rise or has to fall before it is unstable; infinite if it never is.
    sensitivity_peak : float64, shape (3,)
        Largest amplification of a disturbance, ``max |1 / (1 + L)|``.
    loop : complex128, shape (3, len(OMEGA))
        Loop transfer functions L at `OMEGA`.
    """

    eigenvalues: NDArray[np.complex128]
    slowest_s: float
    crossover: Array
    phase_margin_deg: Array
    gain_up_db: Array
    gain_down_db: Array
    sensitivity_peak: Array
    loop: NDArray[np.complex128]


def horizontal(matrix6: Array) -> Array:
    """Return the surge, sway and yaw part (3, 3) of a matrix (6, 6)."""
    return np.asarray(matrix6)[np.ix_(HORIZONTAL, HORIZONTAL)]


def passive_observer(
    inertia: Array,
    damping: Array,
    gains: Array,
    wave_frequency: Array,
    wave_damping: Array,
    bias_time_constant: Array,
) -> LinearObserver:
    """Return the passive observer of `control.observer` with gains and heading frozen.

    Parameters
    ----------
    inertia, damping : float64, shape (3, 3)
    gains : float64, shape (3, 5)
        For each axis K1 of the wave model's integral state [1] and of the wave motion [1/s], K2 of the pose [1/s],
        K3 of the bias [N/(m s)] and K4 of the velocity [N/m].
    wave_frequency, wave_damping : float64, shape (3,)
        [rad/s], relative damping of the wave model.
    bias_time_constant : float64, shape (3,)
        [s]; infinite for an integrator.

    Notes
    -----
    States: xi_1, xi_2 (wave motion), pose, bias, velocity, three each. ``xi_1' = xi_2 + K1a e``,
    ``xi_2' = -w^2 xi_1 - 2 lambda w xi_2 + K1b e``, ``eta' = nu + K2 e``, ``b' = -b / T + K3 e``,
    ``M nu' = -D nu + b + tau + K4 e`` with ``e = y - eta - xi_2``.
    """
    one, none = np.eye(3), np.zeros((3, 3))
    inverse = np.linalg.inv(inertia)
    gain = np.vstack([*(np.diag(gains[:, k]) for k in range(4)), inverse @ np.diag(gains[:, 4])])
    model = np.block(
        [
            [none, one, none, none, none],
            [-np.diag(wave_frequency**2), -np.diag(2.0 * wave_damping * wave_frequency), none, none, none],
            [none, none, none, none, one],
            [none, none, none, -np.diag(1.0 / bias_time_constant), none],
            [none, none, none, inverse, -inverse @ damping],
        ]
    )
    seen = np.hstack([none, one, one, none, none])
    load = np.vstack([none, none, none, none, inverse])
    pose_velocity = np.block([[none, none, one, none, none], [none, none, none, none, one]])
    return LinearObserver(model - gain @ seen, gain, load, pose_velocity)


def closed_loop(
    inertia: Array,
    damping: Array,
    controller: ControllerParams,
    thruster_lag: float,
    delay: float = 0.0,
    observer: LinearObserver | None = None,
) -> LoopReport:
    """Analyse the loop.

    Parameters
    ----------
    inertia, damping : float64, shape (3, 3)
        Of the ship, added mass at low frequency included [kg, kg m, kg m2], [N s/m, ...].
    controller : ControllerParams
        Its PID gains.
    thruster_lag : float
        Time constant from demand to thrust [s].
    delay : float
        Age of the measurements, with half the DP's period for its hold [s].
    observer : LinearObserver, optional
        None feeds the measured pose and velocity back.

    Raises
    ------
    ValueError
        If the lag is not positive or the delay negative.

    Notes
    -----
    The delay is a first-order Pade approximant, within 0.1 degree for a delay below a tenth of the crossover's period.
    The loop of one axis is cut at the force on the ship, behind where the observer learns of it: the margins are those
    against thrust that is lost or a ship that is heavier than the DP believes.
    """
    if not thruster_lag > 0.0 or delay < 0.0:
        raise ValueError(f"DP loop: lag {thruster_lag:g} s, delay {delay:g} s; expected a positive lag, delay >= 0")
    a, b, c = open_loop(inertia, damping, controller, thruster_lag, delay, observer)
    eigenvalues = np.linalg.eigvals(a + b @ c).astype(np.complex128)
    eigenvalues = eigenvalues[np.argsort(-eigenvalues.real, kind="stable")]
    slowest = -float(eigenvalues[0].real)
    loops, margins = np.empty((3, len(OMEGA)), np.complex128), []
    for axis in range(3):
        others = np.eye(3)
        others[axis, axis] = 0.0
        pencil = 1j * OMEGA[:, None, None] * np.eye(len(a)) - (a + b @ others @ c)
        column = np.broadcast_to(b[:, axis].astype(complex)[:, None], (len(OMEGA), len(a), 1))
        loops[axis] = -(np.linalg.solve(pencil, column)[..., 0] @ c[axis])
        margins.append(loop_margins(loops[axis]))
    crossover, phase_margin, up, down, peak = np.array(margins).T
    return LoopReport(
        eigenvalues=eigenvalues,
        slowest_s=1.0 / slowest if slowest > 0.0 else np.inf,
        crossover=crossover,
        phase_margin_deg=phase_margin,
        gain_up_db=up,
        gain_down_db=down,
        sensitivity_peak=peak,
        loop=loops,
    )


def open_loop(
    inertia: Array,
    damping: Array,
    controller: ControllerParams,
    thruster_lag: float,
    delay: float,
    observer: LinearObserver | None,
) -> tuple[Array, Array, Array]:
    """Return A, B and C of the loop cut between thrusters and ship: from the load on the ship to the thrusters' load.

    States: pose, velocity, thrust, load of the integrator (3 each), delay (6, if there is one), observer.
    """
    pose, velocity, thrust, integral = (slice(3 * i, 3 * i + 3) for i in range(4))
    delayed = slice(12, 12 + (6 if delay > 0.0 else 0))
    estimated = slice(delayed.stop, delayed.stop + (0 if observer is None else len(observer.a)))
    count = estimated.stop
    a, b = np.zeros((count, count)), np.zeros((count, 3))
    inverse = np.linalg.inv(inertia)
    a[pose, velocity] = np.eye(3)
    a[velocity, velocity] = -inverse @ damping
    b[velocity] = inverse
    a[thrust, thrust] = -np.eye(3) / thruster_lag

    estimate = np.eye(6, count)
    if delay > 0.0:
        a[delayed, :6] = 4.0 / delay * np.eye(6)
        a[delayed, delayed] = -2.0 / delay * np.eye(6)
        estimate = -estimate
        estimate[:, delayed] = np.eye(6)
    if observer is not None:
        a[estimated] = observer.b_measured @ estimate[:3]
        a[estimated, thrust] += observer.b_load
        a[estimated, estimated] += observer.a
        estimate = np.zeros((6, count))
        estimate[:, estimated] = observer.c
    demand = -np.diag(controller.stiffness) @ estimate[:3] - np.diag(controller.damping) @ estimate[3:]
    demand[:, integral] += np.eye(3)
    a[integral] = -np.diag(controller.integral) @ estimate[:3]
    a[thrust] += demand / thruster_lag
    c = np.zeros((3, count))
    c[:, thrust] = np.eye(3)
    return a, b, c


def loop_margins(loop: NDArray[np.complex128]) -> tuple[float, float, float, float, float]:
    """Return crossover, phase margin [deg], gain margins up and down [dB] and sensitivity peak of L (n,) at `OMEGA`."""
    log_gain = np.log(np.abs(loop))
    at, share = crossings(log_gain)
    omega = np.exp(between(np.log(OMEGA), at, share))
    phase = between(np.unwrap(np.angle(loop)), at, share)
    margin = np.rad2deg((phase + 2.0 * np.pi) % (2.0 * np.pi) - np.pi)
    at, share = crossings(loop.imag)
    behind = between(loop.real, at, share) < 0.0
    db = -20.0 / np.log(10.0) * between(log_gain, at, share)[behind]
    return (
        float(omega.max()) if len(omega) else np.nan,
        float(margin[np.argmin(np.abs(margin))]) if len(margin) else np.inf,
        float(db[db > 0.0].min(initial=np.inf)),
        float(db[db < 0.0].max(initial=-np.inf)),
        float((1.0 / np.abs(1.0 + loop)).max()),
    )


def crossings(values: Array) -> tuple[NDArray[np.intp], Array]:
    """Return the places before a change of sign, and the share of the way to the next one where the line is zero."""
    at = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    return at, values[at] / (values[at] - values[at + 1])


def between(values: Array, at: NDArray[np.intp], share: Array) -> Array:
    """Return values on the way from places to the next ones."""
    return (1.0 - share) * values[at] + share * values[at + 1]

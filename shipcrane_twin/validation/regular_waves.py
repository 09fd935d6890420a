"""The ship alone in regular waves: what the time domain makes of a wave, beside the frequency domain."""

import math

import numpy as np
from numba import njit

from shipcrane_twin.hydro.database import Complex, HydroDatabase
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.frames import euler_from_matrix, matrix_from_quat
from shipcrane_twin.physics.radiation import radiation_count
from shipcrane_twin.physics.sea.components import Waves, make_waves
from shipcrane_twin.physics.sea.loads import WaveLoadParams, wave_load, wave_load_params
from shipcrane_twin.physics.vessel import VesselParams, carried_inertia, vessel_step

RAMP_S, SETTLE_S = 40.0, 160.0
"""Growth of the wave, and time for what it set going to die out."""

CYCLES = 6
NOTHING = np.zeros(10)


@njit(cache=True)
def ride(params: VesselParams, loads: WaveLoadParams, waves: Waves, step_s: float, count: int) -> Array:
    """Return surge, sway, heave, roll, pitch, yaw (count + 1, 6) of the free ship, heading along x at the origin.

    Water loads act along the momentary heading here: there is no slow one without a past.

    The wave load runs linearly over each step, as between the macro steps of a run.
    """
    state = np.zeros(13 + radiation_count(params.radiation))
    state[2] = params.hull.design_height
    state[6] = 1.0
    still, no_load = np.zeros(3), np.zeros(6)
    out = np.zeros((count + 1, 6))
    load_to = np.zeros(6)
    mass6 = carried_inertia(params, NOTHING)
    for k in range(count):
        load_from = load_to
        yaw = out[k, 5]
        first_order, drift = wave_load(loads, waves, (k + 1) * step_s, state[0], state[1], yaw)
        load_to = first_order.copy()
        load_to[:2] += drift[:2]
        load_to[5] += drift[2]
        heading = (np.cos(yaw), np.sin(yaw), 0.0)
        state = vessel_step(params, mass6, state, no_load, load_from, load_to, still, NOTHING, heading, step_s)
        roll, pitch, yaw = euler_from_matrix(matrix_from_quat(state[3:7]))
        out[k + 1] = np.array([state[0], state[1], state[2] - params.hull.design_height, roll, pitch, yaw])
    return out


def motion_per_amplitude(
    params: VesselParams, data: HydroDatabase, omega: float, direction: float, *, amplitude: float, step_s: float
) -> Complex:
    """Return the complex motions (6,) per wave amplitude of the ship in a regular wave, from a time series.

    Parameters
    ----------
    params : VesselParams
    data : HydroDatabase
    omega, direction : float
        Frequency [rad/s] and where the wave goes, anticlockwise from the bow [rad].
    amplitude, step_s : float
        Of the wave [m]; of the integration [s].

    Notes
    -----
    Least squares of ``c cos(w t) + s sin(w t)`` and a slow parabola over the last cycles; the motion is ``c - i s``.
    """
    waves = make_waves(
        np.array([amplitude]),
        np.array([omega]),
        np.array([direction]),
        np.zeros(1),
        gravity=data.gravity,
        depth=data.depth,
        ramp=RAMP_S,
    )
    loads = wave_load_params(waves, data.omega, data.direction, data.excitation, data.drift, slow_drift=False)
    span_s = CYCLES * 2.0 * math.pi / omega
    count = math.ceil((RAMP_S + SETTLE_S + span_s) / step_s)
    motions = ride(params, loads, waves, step_s, count)
    last = math.ceil(span_s / step_s)
    time = step_s * np.arange(count + 1)[-last:]
    slow = (time - time[0]) / span_s
    columns = [np.cos(omega * time), np.sin(omega * time), np.ones_like(time), slow, slow**2]
    found = np.linalg.lstsq(np.column_stack(columns), motions[-last:], rcond=None)[0]
    return np.asarray((found[0] - 1j * found[1]) / amplitude)

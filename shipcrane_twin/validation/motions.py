"""Motions in regular waves: the run's own kernels against the frequency domain."""

from typing import NamedTuple

import numpy as np

from shipcrane_twin.hydro.compare import MODES, Row
from shipcrane_twin.hydro.database import Complex, HydroDatabase
from shipcrane_twin.hydro.rao import raos
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.vessel import VesselParams
from shipcrane_twin.validation.regular_waves import motion_per_amplitude

OMEGA = (0.5, 0.8, 1.05, 1.4, 1.9)
"""Long waves, below, at and above the roll resonance, near those of heave and pitch [rad/s]."""
DIRECTION_STEP_DEG = 20
AMPLITUDE_M, STEP_S = 0.01, 0.05
"""A small wave: linear theory has no drag, and no drifting away."""
BAR = 0.03


class Motions(NamedTuple):
    """Motions per amplitude of both ways, complex128 (n, m, 6), at omega (n,) and directions (m,)."""

    omega: Array
    direction: Array
    time_domain: Complex
    frequency_domain: Complex


def regular_wave_motions(params: VesselParams, data: HydroDatabase, wanted: tuple[float, ...] = OMEGA) -> Motions:
    """Return motions at the table's frequencies nearest to the wanted ones, waves going to 0, 20 ... 180 degrees."""
    rows = np.array([int(np.argmin(np.abs(data.omega - omega))) for omega in wanted])
    columns = np.array(
        [int(np.argmin(np.abs(np.rad2deg(data.direction) - angle))) for angle in range(0, 181, DIRECTION_STEP_DEG)]
    )
    linear = raos(data, params.rigid_mass, params.hull.damping)[np.ix_(rows, columns)]
    found = np.array(
        [
            [
                motion_per_amplitude(
                    params, data, data.omega[i], data.direction[j], amplitude=AMPLITUDE_M, step_s=STEP_S
                )
                for j in columns
            ]
            for i in rows
        ]
    )
    return Motions(data.omega[rows], data.direction[columns], found, linear)


def motion_rows(motions: Motions) -> list[Row]:
    """Compare both ways: the largest complex difference as a share of the largest motion over directions.

    The free ship starts from rest in a wave of 0.01 m that grows over 40 s; after another 160 s six cycles are
    fitted. State-space memory, Runge-Kutta steps and interpolated loads stand against the panel method's tables and the
    linear equations, amplitude and phase together.
    """
    size = np.abs(motions.frequency_domain).max(axis=1)
    error = np.abs(motions.time_domain - motions.frequency_domain) / size[:, None, :]
    rows = []
    cases = error.shape[0] * error.shape[1]
    for mode, name in enumerate(MODES):
        i, j = np.unravel_index(int(error[..., mode].argmax()), error.shape[:2])
        note = f"{cases} cases, worst at {motions.omega[i]:.3g} rad/s to {np.rad2deg(motions.direction[j]):.0f} deg"
        rows.append(Row(f"{name}, time against frequency domain", float(error[i, j, mode]), BAR, "", note))
    return rows

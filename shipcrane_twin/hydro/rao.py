"""Motions in the frequency domain, and natural periods."""

from __future__ import annotations

import numpy as np

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import LATERAL, LONGITUDINAL, Complex, HydroDatabase
from shipcrane_twin.physics.arrays import Array

RESTORED = {"heave": 2, "roll": 3, "pitch": 4}


def mass_matrix(mass: float, ixx: float, iyy: float, izz: float) -> Array:
    """Return the rigid-body mass matrix (6, 6) about the CoG, principal axes [kg, kg m2]."""
    return np.diag([mass, mass, mass, ixx, iyy, izz])


def usual_mass(data: HydroDatabase) -> Array:
    """Return a rigid-body mass matrix (6, 6) from usual radii of gyration, where nothing better is known.

    Notes
    -----
    Roll 0.35 breadths, pitch and yaw 0.25 lengths (Faltinsen 1990, section 3.2, gives 0.35 B and 0.25 L for ships). The
    breadth is that of a waterplane that fills 0.82 of its rectangle.
    """
    breadth = data.restoring[2, 2] / (data.water_density * data.gravity * 0.82 * data.length)
    return mass_matrix(
        data.mass, *(data.mass * np.array([0.35 * breadth, 0.25 * data.length, 0.25 * data.length]) ** 2)
    )


def own_mass(mass6: Array, data: HydroDatabase) -> Array:
    """Return a mass matrix (6, 6) with the mass that the database displaces, and the same moments of inertia."""
    out = mass6.copy()
    out[:3, :3] = np.eye(3) * data.mass
    return out


def roll_damping(data: HydroDatabase, mass6: Array, share: float = 0.05) -> Array:
    """Return a linear roll damping (6, 6) beside radiation, a share of critical."""
    out = np.zeros((6, 6))
    out[3, 3] = 2.0 * share * np.sqrt(data.restoring[3, 3] * (mass6[3, 3] + data.added_mass_inf[3, 3]))
    return out


def raos(
    data: HydroDatabase,
    mass6: Array,
    extra_damping: Array | None = None,
    extra_stiffness: Array | None = None,
    *,
    from_fit: bool = False,
) -> Complex:
    """Return motions per wave amplitude at the database's frequencies and directions.

    Parameters
    ----------
    data : HydroDatabase
    mass6 : float64, shape (6, 6)
        Rigid-body mass about the CoG.
    extra_damping, extra_stiffness : float64, shape (6, 6), optional
        Linear damping beside radiation, such as viscous roll damping; stiffness such as position keeping.
    from_fit : bool
        Radiation from the state-space model instead of the tables.

    Returns
    -------
    complex128, shape (n, m, 6)
        [m/m, rad/m], of the CoG.

    Raises
    ------
    ConfigError
        If the equations have no solution, which takes a mass matrix with a zero on its diagonal.

    Notes
    -----
    ``(-w^2 (M + A) + i w (B + B_extra) + C + C_extra) X = F`` (Newman 1977, section 6.20).
    """
    omega = data.omega[:, None, None]
    if from_fit:
        radiation = data.fit.response(data.omega) + 1j * omega * data.added_mass_inf
    else:
        radiation = data.damping + 1j * omega * data.added_mass
    damping = np.zeros((6, 6)) if extra_damping is None else extra_damping
    stiffness = data.restoring if extra_stiffness is None else data.restoring + extra_stiffness
    impedance = stiffness - omega**2 * mass6 + 1j * omega * (radiation + damping)
    try:
        solved = np.linalg.solve(impedance, np.swapaxes(data.excitation, 1, 2))
    except np.linalg.LinAlgError:
        raise ConfigError(f"the mass matrix has the diagonal {np.diag(mass6)}, expected positive values") from None
    return np.asarray(np.swapaxes(solved, 1, 2))


def added_mass_at(data: HydroDatabase, omega: float) -> Array:
    """Return the added mass (6, 6) at a frequency [rad/s], linear between those of the table, constant beyond."""
    return np.array([[np.interp(omega, data.omega, data.added_mass[:, i, j]) for j in range(6)] for i in range(6)])


def natural_periods(data: HydroDatabase, mass6: Array) -> dict[str, float]:
    """Return the undamped natural periods of heave, roll and pitch [s], each mode by itself.

    Parameters
    ----------
    data : HydroDatabase
    mass6 : float64, shape (6, 6)

    Raises
    ------
    ConfigError
        If a mode has no positive stiffness.

    Notes
    -----
    ``T = 2 pi sqrt((M_ii + A_ii(2 pi / T)) / C_ii)``, the crossing of both sides found on a fine grid.
    """
    periods = {}
    omega = np.linspace(data.omega[0], data.omega[-1], 20001)
    for name, mode in RESTORED.items():
        stiffness = data.restoring[mode, mode]
        if stiffness <= 0.0:
            raise ConfigError(f"{name}: stiffness {stiffness:.4g}, expected a positive one; lower the CoG")
        inertia = mass6[mode, mode] + np.interp(omega, data.omega, data.added_mass[:, mode, mode])
        gap = stiffness - omega**2 * inertia
        at = int(np.argmax(gap < 0.0))  # the first crossing; the table's last frequency if there is none
        periods[name] = float(2.0 * np.pi / omega[at]) if gap[-1] < 0.0 else float(2.0 * np.pi / omega[-1])
    return periods


def coupled_periods(data: HydroDatabase, mass6: Array) -> dict[str, float]:
    """Return the undamped natural periods of heave, roll and pitch [s] with the coupling of their block.

    Parameters
    ----------
    data : HydroDatabase
    mass6 : float64, shape (6, 6)

    Notes
    -----
    Eigenvalues of ``(M + A(w))^-1 C`` of heave-pitch and of sway-roll-yaw, with A at the frequency of the mode itself,
    iterated. The mode that moves most in the named freedom, amplitudes scaled by the inertia, carries its name.
    """
    start = natural_periods(data, mass6)
    periods = {}
    for name, mode in RESTORED.items():
        modes = np.array(LATERAL if mode in LATERAL else LONGITUDINAL[1:])
        block, here = np.ix_(modes, modes), int(np.flatnonzero(modes == mode)[0])
        omega = 2.0 * np.pi / start[name]
        for _ in range(60):
            inertia = (mass6 + added_mass_at(data, omega))[block]
            values, vectors = np.linalg.eig(np.linalg.solve(inertia, data.restoring[block]))
            size = np.abs(vectors) * np.sqrt(np.abs(np.diag(inertia)))[:, None]
            share = size[here] / np.linalg.norm(size, axis=0)
            share[values.real <= 1e-9 * np.abs(values).max()] = 0.0  # sway and yaw are free
            omega = 0.5 * (omega + float(np.sqrt(values.real[int(np.argmax(share))])))
        periods[name] = 2.0 * np.pi / omega
    return periods

"""A ship known exactly, files of other codes written from it, and the reference folder of VERES files."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from shipcrane_twin.hydro.database import HydroDatabase
from shipcrane_twin.hydro.importing import no_fit

SHIPX = Path(__file__).resolve().parents[2] / "../shared/reference/gunnerus_shipx/ShipModel.zip"

RHO, G = 1025.0, 9.81
LENGTH, BEAM, DRAUGHT = 40.0, 10.0, 3.0
COG = np.array([19.0, 0.0, 4.0])
BOX_X = np.linspace(-19.0, 21.0, 101)  # from the CoG; off centre, so that heave and pitch couple
OMEGA = np.linspace(0.15, 3.0, 40)
DIRECTION = np.deg2rad(np.arange(0.0, 181.0, 15.0))


def without_fit(*_table):
    return no_fit()


def shipx_folder(tmp_path_factory):
    """Unpack the reference files, or skip."""
    if not SHIPX.is_file():
        pytest.skip(f"the reference data are not here: {SHIPX}")
    folder = tmp_path_factory.mktemp("shipx")
    with zipfile.ZipFile(SHIPX) as archive:
        for member in archive.namelist():
            if not member.endswith("/"):
                (folder / Path(member).name).write_bytes(archive.read(member))
    return folder


def box_loads(omega, direction):
    """Froude-Krylov loads of a box about the CoG: pressure times normal, by quadrature along the length."""
    k = omega**2 / G
    c, s = k * np.cos(direction), k * np.sin(direction)
    y = np.linspace(-BEAM / 2, BEAM / 2, 21)
    z = np.linspace(-DRAUGHT, 0.0, 13)
    up = z - (COG[2] - DRAUGHT)  # height above the CoG

    def wave(x, y, z):
        return RHO * G * np.exp(k * z - 1j * (c * x + s * y))

    def over(values, *axes):
        for axis in reversed(axes):
            values = np.trapezoid(values, axis, axis=-1)
        return values

    x3, y3 = BOX_X[:, None], y[None, :]
    bottom = wave(x3, y3, -DRAUGHT)
    heave, roll, pitch = (over(bottom * arm, BOX_X, y) for arm in (1.0, y3, -x3))
    surge = sway = yaw = 0.0
    for end, sign in ((BOX_X[-1], -1.0), (BOX_X[0], 1.0)):  # load along -normal
        p = wave(end, y[:, None], z[None, :]) * sign
        surge, pitch, yaw = surge + over(p, y, z), pitch + over(p * up, y, z), yaw - over(p * y[:, None], y, z)
    for side, sign in ((BEAM / 2, -1.0), (-BEAM / 2, 1.0)):
        p = wave(BOX_X[:, None], side, z[None, :]) * sign
        sway, roll, yaw = sway + over(p, BOX_X, z), roll - over(p * up, BOX_X, z), yaw + over(p * x3, BOX_X, z)
    return np.array([surge, sway, heave, roll, pitch, yaw])


def radiation(omega):
    """A_inf, A(w) and B(w) of a passive memory with K(0) = 0, not diagonal."""
    seed = np.random.default_rng(3)
    mass = RHO * LENGTH * BEAM * DRAUGHT
    scale = np.sqrt(mass * np.array([0.05, 0.4, 1.0, 4.0, 100.0, 60.0]))
    response = np.zeros((len(omega), 6, 6), complex)
    infinite = np.zeros((6, 6))
    for modes in ((0, 2, 4), (1, 3, 5)):
        at = np.ix_(modes, modes)
        mix = 0.15 * seed.standard_normal((3, 3)) + np.eye(3)
        infinite[at] = 0.8 * mix @ mix.T
        for peak, decay in ((0.9, 0.8), (1.6, 1.2)):
            mix = 0.15 * seed.standard_normal((3, 3)) + np.eye(3)
            s = 1j * omega[:, None, None]
            response[(slice(None), *at)] += 0.8 * s / (s**2 + decay * s + peak**2) * (mix @ mix.T)
    response *= np.outer(scale, scale)
    infinite *= np.outer(scale, scale)
    return infinite, infinite + response.imag / omega[:, None, None], response.real


def a_ship(omega=OMEGA, direction=DIRECTION):
    """A box with a passive memory: not a real hull's radiation, but every law of signs and places holds."""
    volume = LENGTH * BEAM * DRAUGHT
    x_mid = 0.5 * (BOX_X[0] + BOX_X[-1])
    weight = RHO * G
    restoring = np.zeros((6, 6))
    restoring[2, 2] = weight * LENGTH * BEAM
    restoring[2, 4] = restoring[4, 2] = -restoring[2, 2] * x_mid
    lever = DRAUGHT / 2 - COG[2]
    restoring[3, 3] = weight * (LENGTH * BEAM**3 / 12 + volume * lever)
    restoring[4, 4] = weight * (BEAM * LENGTH**3 / 12 + LENGTH * BEAM * x_mid**2 + volume * lever)
    infinite, added, damping = radiation(omega)
    loads = np.array([[box_loads(w, d) for d in direction] for w in omega])
    drift = np.zeros((len(omega), len(direction), 3))
    drift[...] = np.array([3e4, 2e4, 5e4]) * (omega[:, None, None] / omega[-1]) ** 3
    drift[..., 0] *= np.cos(direction)
    drift[..., 1] *= np.sin(direction)
    drift[..., 2] *= np.sin(2.0 * direction)
    return HydroDatabase(
        name="box", source="test", cog=COG, draught=DRAUGHT, length=LENGTH, water_density=RHO, gravity=G, depth=np.inf,
        volume=volume, centre_of_buoyancy=np.array([COG[0] + x_mid, 0.0, DRAUGHT / 2]), restoring=restoring,
        omega=omega, added_mass=added, damping=damping, added_mass_inf=infinite, direction=direction,
        excitation=loads, drift=drift, fit=no_fit(),
    )  # fmt: skip


def mass_of(data):
    """A mass matrix for the box."""
    return data.mass * np.diag([1.0, 1.0, 1.0, 14.0, 100.0, 100.0])

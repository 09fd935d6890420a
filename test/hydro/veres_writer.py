"""VERES files of a known ship, written by the conventions that their readers must undo."""

import numpy as np

from shipcrane_twin.hydro.database import moved
from shipcrane_twin.physics.dispersion import wave_numbers

HALF_TURN = np.array([-1.0, -1.0, 1.0, -1.0, -1.0, 1.0])  # x aft, y starboard, z up
TITLES = " Run name:\n Ship name: Box\n Loading condition description: Any\n\n ShipX exported data\n"
XMTN, ZMTN = -0.2, 3.0  # motion origin: aft of midship, above the baseline [m]


def row(*values):
    return " " + " ".join(f"{value:.12E}" for value in values) + "\n"


def head(title, data, *, cog=True):
    text = f" {title} - VERES Version 4\n{TITLES}" + row(data.water_density, data.gravity)
    text += row(data.length, 10.0, data.draught)
    return text + row(data.length / 2 - data.cog[0], data.cog[2]) if cog else text


def origin(data):
    return np.array([data.length / 2 - XMTN, 0.0, ZMTN])


def at_origin(data):
    """The ship about the motion origin, its weight still at the CoG."""
    there = moved(data, origin(data))
    z = origin(data)[2] - data.cog[2]
    there.restoring[3, 3] += data.mass * data.gravity * z
    there.restoring[4, 4] += data.mass * data.gravity * z
    return there


def motions_at_origin(data, motions):
    arm = origin(data) - data.cog
    out = motions.astype(complex)
    out[..., :3] += np.cross(motions[..., 3:], arm)
    k = wave_numbers(data.omega, data.gravity, np.inf)
    return out * np.exp(1j * k[:, None] * np.cos(data.direction) * arm[0])[..., None]


def transfer_file(title, data, values, *, speeds=(0.0,), headings=None):
    """re1 or re8; heading 0 is head sea, and the wave goes from x aft towards y starboard."""
    headings = np.arange(0.0, 360.0, 15.0) if headings is None else headings
    text = head(title, data) + f" {len(speeds)} {len(headings)} {len(data.omega)} 6\n"
    mirror = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    for speed in speeds:
        text += row(speed, 0.0, 0.0, XMTN, ZMTN)
        for heading in headings:
            toward = (heading + 180.0) % 360.0
            m = round((toward if toward <= 180.0 else 360.0 - toward) / 15.0)
            text += f"  {heading:.2f}\n"
            for n, omega in enumerate(data.omega):
                text += f" {omega:.10f}\n"
                turned = values[n, m] * HALF_TURN * (mirror if toward > 180.0 else 1.0) * (1.0 if speed == 0.0 else 7.0)
                text += "".join(f" {i + 1} {v.real:.12E} {v.imag:.12E}\n" for i, v in enumerate(turned))
    return text


def drift_file(data):
    headings = np.arange(0.0, 181.0, 15.0)
    text = head("ADDED RESISTANCE ", data, cog=False) + f" 1 {len(headings)} {len(data.omega)}\n"
    unit = data.water_density * data.gravity * 100.0 / np.array([data.length, data.length, 1.0])
    for heading in headings:
        text += f" 0.0 {heading:.2f}\n"
        # 0 to 180 in the file are waves to starboard
        values = data.drift[:, round((180.0 - heading) / 15.0)] * [1.0, -1.0, -1.0] * [-1.0, -1.0, 1.0] / unit
        text += "".join(f" {w:.4f}" + row(*v) for w, v in zip(data.omega, values, strict=True))
    return text


def re7_file(data, mass, version=2):
    """Coefficients about the motion origin; half of each matrix stands in the second set of version 2."""
    there = at_origin(data)
    arm = data.cog - origin(data)
    skew = np.array([[0.0, -arm[2], arm[1]], [arm[2], 0.0, -arm[0]], [-arm[1], arm[0], 0.0]])
    shift = np.block([[np.eye(3), -skew], [np.zeros((3, 3)), np.eye(3)]])  # velocity of the CoG from the origin's
    flip = np.outer(HALF_TURN, HALF_TURN)

    def matrix(values):
        return "".join(row(*line) for line in values * flip)

    text = head("HYDRODYNAMIC COEFFICIENTS", data) + (" -1 2\n" if version == 2 else "") + f" 1 2 {len(data.omega)} 6\n"
    text += matrix(shift.T @ mass @ shift) + row(0.0, 0.0, 0.0, XMTN, ZMTN)
    for heading in (0.0, 90.0):
        text += f" {heading:.2f}\n"
        for n, omega in enumerate(data.omega):
            text += f" {omega:.10f}\n"
            for values in (there.added_mass[n], there.damping[n], there.restoring):
                text += matrix(0.5 * values) * 2 if version == 2 else matrix(values)
            text += row(1.0, 2.5e5, 3.0)
    return text


def folder_of(path, data, mass, motions, version=2):
    """Write a whole folder."""
    loads = at_origin(data).excitation
    (path / "input.re8").write_text(transfer_file("WAVE EXCITATION FORCE", data, loads, speeds=(2.0, 0.0)))
    (path / "input.re1").write_text(transfer_file("MOTION TRANSFER FUNCTIONS", data, motions_at_origin(data, motions)))
    (path / "input.re2").write_text(drift_file(data))
    (path / "input.re7").write_text(re7_file(data, mass, version))
    return path

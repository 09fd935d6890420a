"""Text files of ShipX/VERES: transfer functions (re1, re8, swy) and drift (re2), as they stand.

Nothing is converted here but text to numbers; conventions are in `veres`.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import Complex
from shipcrane_twin.physics.arrays import Array

TITLE_LINES = 6


class Header(NamedTuple):
    """Particulars that every VERES file repeats, x aft from midship, z up from the baseline [m]."""

    title: str
    ship: str
    water_density: float
    gravity: float
    length: float
    breadth: float
    draught: float
    lcg: float
    vcg: float


class Transfer(NamedTuple):
    """Transfer functions at zero speed, in the file's own axes.

    Attributes
    ----------
    header : Header
    origin : float64, shape (2,)
        Origin of the motion coordinates: x aft of midship, z above the baseline [m].
    heading : float64, shape (m,)
        0 is head sea [deg].
    omega : float64, shape (n,)
        [rad/s]
    values : complex128, shape (n, m, 6)
        Loads per amplitude, or motions per amplitude.
    """

    header: Header
    origin: Array
    heading: Array
    omega: Array
    values: Complex


class Text(NamedTuple):
    """Lines of a file that begins with VERES's six lines of titles."""

    path: Path
    lines: list[str]

    def numbers(self, line: int, count: int | None = None) -> list[float]:
        """Return the numbers of one line, counted from 0."""
        if line >= len(self.lines):
            raise ConfigError(f"{self.path}: ends after line {len(self.lines)}, expected more; export it again")
        try:
            found = [float(word) for word in self.lines[line].split()]
        except ValueError:
            raise ConfigError(
                f"{self.path}:{line + 1}: {self.lines[line].strip()[:60]!r} is not a line of numbers; export it again"
            ) from None
        if count is not None and len(found) != count:
            raise ConfigError(f"{self.path}:{line + 1}: {len(found)} numbers, expected {count}; export it again")
        return found

    def table(self, line: int) -> Array:
        """Return all numbers from a line to the end, in one row."""
        try:
            values = np.array(" ".join(self.lines[line:]).split(), dtype=np.float64)
        except ValueError:
            for row in range(line, len(self.lines)):
                self.numbers(row)  # names the line
            raise
        bad = np.flatnonzero(~np.isfinite(values))
        if len(bad):
            raise ConfigError(f"{self.path}: number {bad[0] + 1} of the table is not finite; export it again")
        return values


def read_text(path: Path, title: str) -> Text:
    """Return the lines of a VERES file whose first line holds a title.

    Raises
    ------
    ConfigError
        If the file is missing or of another kind.
    """
    try:
        lines = path.read_text(encoding="latin-1").splitlines()
    except OSError as err:
        raise ConfigError(f"{path}: cannot be read ({err.strerror}); export it from ShipX") from None
    first = lines[0].strip() if lines else ""
    if title not in first.upper():
        raise ConfigError(f"{path}:1: the first line is {first[:60]!r}, expected {title!r}: a file of ShipX/VERES")
    return Text(path, lines)


def header(text: Text, *, with_cog: bool = True) -> Header:
    """Return the particulars after the titles."""
    density, gravity = text.numbers(TITLE_LINES, 2)
    length, breadth, draught = text.numbers(TITLE_LINES + 1, 3)
    lcg, vcg = text.numbers(TITLE_LINES + 2, 2) if with_cog else (0.0, 0.0)
    if not 900.0 < density < 1100.0 or not 9.7 < gravity < 9.9:
        raise ConfigError(
            f"{text.path}:{TITLE_LINES + 1}: density {density:g} and gravity {gravity:g}, expected about 1025 kg/m3 "
            "and 9.81 m/s2: export in SI units"
        )
    ship = text.lines[2].split(":", 1)[-1].strip()
    return Header(text.lines[0].strip(), ship, density, gravity, length, breadth, draught, lcg, vcg)


def counts(text: Text, line: int) -> tuple[int, int, int]:
    """Return how many speeds, headings and frequencies follow."""
    found = [int(value) for value in text.numbers(line)]
    if len(found) < 3 or min(found[:3]) < 1 or (len(found) > 3 and found[3] != 6):
        raise ConfigError(
            f"{text.path}:{line + 1}: {found}, expected the counts of speeds, headings and frequencies, and 6 degrees "
            "of freedom; export without generalised modes"
        )
    return found[0], found[1], found[2]


def zero_speed(path: Path, speeds: Array) -> int:
    """Return which of the speeds [m/s] is zero."""
    still = np.flatnonzero(np.abs(speeds) < 1e-3)
    if not len(still):
        raise ConfigError(f"{path}: speeds are {np.round(speeds, 2).tolist()} m/s, expected one of 0; run VERES at 0")
    return int(still[0])


def read_transfer(path: Path, title: str, *, seaway: bool = False) -> Transfer:
    """Read transfer functions: wave loads (re8), motions (re1), or the motions for SEAWAY (swy).

    Parameters
    ----------
    path : Path
    title : str
        What the first line says.
    seaway : bool
        A .swy file: two more lines of particulars, two numbers of added resistance before each block, and
        motions of the point above or below the CoG that lies in the waterline.

    Raises
    ------
    ConfigError
        With file, line and what was expected.
    """
    text = read_text(path, title)
    head = header(text)
    line = TITLE_LINES + (5 if seaway else 3)
    speeds, headings, frequencies = counts(text, line)
    start, per_speed, skip = line + 1, 3 if seaway else 5, 1 if seaway else 0
    width = len(text.numbers(start + 3 + skip))
    if width < 3 or width % 2 == 0:
        raise ConfigError(
            f"{path}:{start + 4 + skip}: {width} numbers, expected a mode and pairs of real and imaginary part; "
            "export it again"
        )
    block = 1 + 2 * skip + 6 * width
    rows = per_speed + headings * (1 + frequencies * block)
    table = text.table(start)
    if len(table) != speeds * rows:
        raise ConfigError(
            f"{path}: {len(table)} numbers after line {start}, expected {speeds * rows} for {speeds} speeds, "
            f"{headings} headings and {frequencies} frequencies; the file is cut off or of another version"
        )
    table = table.reshape(speeds, rows)
    still = table[zero_speed(path, table[:, 0])]
    by_heading = still[per_speed:].reshape(headings, 1 + frequencies * block)
    by_frequency = by_heading[:, 1:].reshape(headings, frequencies, block)
    omega = by_frequency[0, :, 0]
    modes = by_frequency[..., 1 + 2 * skip :].reshape(headings, frequencies, 6, width)
    if np.ptp(by_frequency[..., 0], axis=0).max(initial=0.0) > 1e-6 or (modes[..., 0] != np.arange(1.0, 7.0)).any():
        raise ConfigError(f"{path}: frequencies or modes differ between headings; the file is of another version")
    origin = still[3:5]
    if seaway:  # counts heights from the waterline
        head = head._replace(vcg=head.vcg + head.draught)
        origin = np.array([head.lcg, head.draught])
    values = np.moveaxis(modes[..., 1] + 1j * modes[..., 2], 0, 1)
    return Transfer(head, origin, by_heading[:, 0], omega, values)


def read_drift(path: Path) -> Transfer:
    """Read mean second-order loads (re2): surge, sway, yaw in columns 0, 1, 5 [N/m2, N/m]; the rest is zero.

    Notes
    -----
    The file divides forces by ``rho g B^2 / L`` and the moment by ``rho g B^2``, both per squared amplitude.
    """
    text = read_text(path, "ADDED RESISTANCE")
    head = header(text, with_cog=False)
    line = TITLE_LINES + 2
    speeds, headings, frequencies = counts(text, line)
    width = len(text.numbers(line + 2))
    rows = headings * (2 + frequencies * width)
    table = text.table(line + 1)
    if width < 4 or len(table) != speeds * rows:
        raise ConfigError(
            f"{path}: {len(table)} numbers after line {line + 1}, expected {speeds * rows}; the file is cut off or of "
            "another version"
        )
    by_heading = table.reshape(speeds, headings, 2 + frequencies * width)
    still = by_heading[zero_speed(path, by_heading[:, 0, 0])]
    by_frequency = still[:, 2:].reshape(headings, frequencies, width)
    unit = head.water_density * head.gravity * head.breadth**2 / np.array([head.length, head.length, 1.0])
    values = np.zeros((frequencies, headings, 6), complex)
    values[..., [0, 1, 5]] = np.moveaxis(by_frequency[..., 1:4], 0, 1) * unit
    return Transfer(head, np.zeros(2), still[:, 1], by_frequency[0, :, 0], values)

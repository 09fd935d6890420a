"""Added mass, damping and restoring from ShipX/VERES: retfun.re10 or input.re7.

re10 has x forward, y starboard, z down, about the CoG. re7 has x aft, y starboard, z up, about the origin of
the motion coordinates, as re8 has. Both come out in this project's axes (x forward, y port, z up), about the CoG.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import Complex
from shipcrane_twin.hydro.importing import transfer
from shipcrane_twin.hydro.memory import infinite_added_mass
from shipcrane_twin.hydro.veres_files import TITLE_LINES, Text, counts, header, read_text, zero_speed
from shipcrane_twin.physics.arrays import Array

FROM_AFT = np.array([-1.0, -1.0, 1.0, -1.0, -1.0, 1.0])
"""From x aft, y starboard, z up: half a turn about z."""

FROM_DOWN = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
"""From x forward, y starboard, z down: half a turn about x."""


class Coefficients(NamedTuple):
    """What re7 or re10 says of a ship at zero speed, x forward, y port, z up, about the CoG.

    Attributes
    ----------
    mass, restoring, added_mass_inf : float64, shape (6, 6)
    omega : float64, shape (n,)
        [rad/s]
    added_mass, damping : float64, shape (n, 6, 6)
    damping_correction : float64, shape (6, 6)
        re10's "correction terms independent on forward speed"; zero from re7.
    quadratic_roll : float64, shape (k, 2)
        Speed [m/s] and quadratic viscous roll damping [N m s2/rad2].
    source : str
    """

    mass: Array
    restoring: Array
    added_mass_inf: Array
    omega: Array
    added_mass: Array
    damping: Array
    damping_correction: Array
    quadratic_roll: Array
    source: str


def turn(matrices: Array, signs: Array) -> Array:
    """Return matrices (..., 6, 6) in axes that differ by half a turn."""
    return matrices * np.outer(signs, signs)


def read_re10(path: Path, omega: Array) -> Coefficients:
    """Read retfun.re10: retardation functions as sums of complex exponentials.

    Parameters
    ----------
    path : Path
    omega : float64, shape (n,)
        Where to evaluate added mass and damping [rad/s].

    Notes
    -----
    ``K_ij(t) = Re sum_k c_k e^{l_k t}``: some poles stand without their conjugate, so the real part must be
    taken; with it the imaginary part of K(0) vanishes for every entry. Then
    ``K(iw) = (sum c/(iw - l) + c*/(iw - l*))/2 = B(w) + iw (A(w) - A_inf)`` (Ogilvie 1964).
    The correction terms are a damping that VERES adds beside K, not part of the potential flow.
    """
    text = read_text(path, "MOTION RETARDATION FUNCTIONS")
    line = TITLE_LINES + 1  # after a line with the file's version
    for expected, row in ((2, line), (3, line + 1)):
        text.numbers(row, expected)
    memory = memory_terms(text)
    response = np.zeros((len(omega), 6, 6), complex)
    for (i, j), (factors, poles) in memory.items():
        response[:, i, j] = evaluate(factors, poles, omega)
    response = response * np.outer(FROM_DOWN, FROM_DOWN)
    infinite = turn(matrix_below(text, "Asymptotic high-frequency added mass matrix"), FROM_DOWN)
    return Coefficients(
        mass=turn(matrix_below(text, "Mass matrix"), FROM_DOWN),
        restoring=turn(matrix_below(text, "Restoring matrix"), FROM_DOWN),
        added_mass_inf=infinite,
        omega=omega,
        added_mass=infinite + response.imag / omega[:, None, None],
        damping=response.real,
        damping_correction=turn(matrix_below(text, "Correction terms independent on forward speed"), FROM_DOWN),
        quadratic_roll=quadratic_roll(text),
        source=f"{path.name} (x forward, y starboard, z down, about the CoG), {text.lines[0].strip()}",
    )


def evaluate(factors: Complex, poles: Complex, omega: Array) -> Complex:
    """Return the Fourier transform (n,) of ``Re sum c e^{l t}``, t > 0."""
    s = 1j * omega[:, None]
    both = factors / (s - poles) + factors.conj() / (s - poles.conj())
    return np.asarray(0.5 * both.sum(axis=1), complex)


def find(text: Text, title: str) -> int:
    """Return the line after a title that begins with %."""
    for line, content in enumerate(text.lines):
        if content.strip().strip("%").strip() == title:
            return line + 1
    raise ConfigError(f"{text.path}: no line '% {title}'; export the file again with ShipX 4 or later")


def matrix_below(text: Text, title: str) -> Array:
    """Return the matrix (6, 6) below a title."""
    line = find(text, title)
    return np.array([text.numbers(row, 6) for row in range(line, line + 6)])


def quadratic_roll(text: Text) -> Array:
    """Return speeds and quadratic roll damping (k, 2)."""
    line = find(text, "Quadratic viscous roll damping") + 1
    count = int(text.numbers(line, 1)[0])
    return np.array([text.numbers(row, 2) for row in range(line + 1, line + 1 + count)]).reshape(count, 2)


def memory_terms(text: Text) -> dict[tuple[int, int], tuple[Complex, Complex]]:
    """Return factors and poles of each entry of the retardation functions at zero speed."""
    line = find(text, "Retardation functions")
    terms: dict[tuple[int, int], tuple[Complex, Complex]] = {}
    while line < len(text.lines) and text.lines[line].strip() and not text.lines[line].lstrip().startswith("%"):
        i, j = (int(value) for value in text.numbers(line, 2))
        if not (1 <= i <= 6 and 1 <= j <= 6):
            raise ConfigError(f"{text.path}:{line + 1}: entry {i},{j}, expected 1 to 6; the file is of another version")
        count = int(text.numbers(line + 1, 1)[0])
        rows = np.array([text.numbers(line + 2 + k, 4) for k in range(count)]).reshape(count, 4)
        line += 2 + count
        line += 1 + int(text.numbers(line, 1)[0])  # terms that grow with speed
        factors, poles = rows[:, 0] + 1j * rows[:, 1], rows[:, 2] + 1j * rows[:, 3]
        if (poles.real >= 0.0).any():
            raise ConfigError(f"{text.path}:{line}: a pole of entry {i},{j} does not decay; run VERES's fit again")
        terms[i - 1, j - 1] = (factors, poles)
    if len(terms) != 36:
        raise ConfigError(f"{text.path}:{line}: {len(terms)} retardation functions, expected 36; the file is cut off")
    return terms


def read_re7(path: Path, omega: Array) -> Coefficients:
    """Read input.re7: added mass, damping and restoring per frequency, version 1 or 2.

    Parameters
    ----------
    path : Path
    omega : float64, shape (n,)
        The frequencies of re8, which the file must have [rad/s].

    Notes
    -----
    Version 2 has a second set of each matrix, the user's additions, which are added. The last line of a block holds
    linear, quadratic and linearised viscous roll damping; the quadratic one is kept, apart from the potential damping.
    The infinite frequency is missing and follows from the table (`memory.infinite_added_mass`).
    """
    text = read_text(path, "HYDRODYNAMIC COEFFICIENTS")
    head = header(text)
    line = TITLE_LINES + 3
    sets = 1
    if len(text.numbers(line)) == 2:  # version 2
        sets, line = 2, line + 1
    speeds, headings, frequencies = counts(text, line)
    mass = np.array([text.numbers(row, 6) for row in range(line + 1, line + 7)])
    block = 1 + 3 * sets * 36 + 3
    rows = 5 + headings * (1 + frequencies * block)
    table = text.table(line + 7)
    if len(table) != speeds * rows:
        raise ConfigError(
            f"{path}: {len(table)} numbers after line {line + 7}, expected {speeds * rows}; the file is cut off or of "
            "another version"
        )
    table = table.reshape(speeds, rows)
    still = table[zero_speed(path, table[:, 0])]
    first = still[6 : 6 + frequencies * block].reshape(frequencies, block)  # at zero speed all headings are equal
    if len(omega) != frequencies or np.abs(first[:, 0] - omega).max() > 1e-3:
        raise ConfigError(f"{path}: its frequencies are not those of re8; export both from the same run")
    added, damping, restoring = first[:, 1:-3].reshape(frequencies, 3, sets, 6, 6).sum(axis=2).swapaxes(0, 1)
    origin = np.array([-still[3], 0.0, still[4]])
    arm = np.array([-head.lcg, 0.0, head.vcg]) - origin
    shift = transfer(arm)

    def about_cog(matrices: Array) -> Array:
        return shift.T @ turn(matrices, FROM_AFT) @ shift

    added, damping = about_cog(added), about_cog(damping)
    return Coefficients(
        mass=about_cog(mass),
        restoring=about_cog(restoring.mean(axis=0)),
        added_mass_inf=infinite_added_mass(omega, added, damping),
        omega=omega,
        added_mass=added,
        damping=damping,
        damping_correction=np.zeros((6, 6)),
        quadratic_roll=np.array([[0.0, first[:, -2].max()]]),
        source=f"{path.name} (x aft, y starboard, z up, about its motion origin), {text.lines[0].strip()}",
    )

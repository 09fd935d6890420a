"""Pictures of a database: hull, added mass, damping, memory, wave loads, motions, drift; one ship or two."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from shipcrane_twin.hydro.compare import MODES
from shipcrane_twin.hydro.database import LATERAL, LONGITUDINAL, Complex, HydroDatabase, RadiationFit
from shipcrane_twin.hydro.figure_style import COLOURS, DPI, INK, TINY, blank, finish, grid, legend_below
from shipcrane_twin.hydro.memory import retardation
from shipcrane_twin.hydro.rao import natural_periods, own_mass, raos, roll_damping, usual_mass
from shipcrane_twin.physics.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TOWARD = "wave goes to (0° following sea, 90° to port, 180° head sea)"
DIRECTIONS_DEG = (0.0, 45.0, 90.0, 135.0, 180.0)


class Ships(NamedTuple):
    """What a figure draws: one ship, and another one beside it or not."""

    data: HydroDatabase
    other: HydroDatabase | None
    mass6: Array
    extra_damping: Array

    def titled(self, title: str) -> str:
        """Return a title with the names of the ships."""
        if self.other is None:
            return f"{title}: {self.data.name}"
        return f"{title}: {self.data.name} (solid), {self.other.name} (dashed)"

    def each(self) -> Iterator[tuple[HydroDatabase, str]]:
        """Yield database and line style: solid, then dashed."""
        yield self.data, "-"
        if self.other is not None:
            yield self.other, "--"


def draw(
    data: HydroDatabase,
    folder: Path,
    *,
    other: HydroDatabase | None = None,
    mass6: Array | None = None,
    extra_damping: Array | None = None,
    mesh: tuple[Array, NDArray[np.integer[Any]]] | None = None,
) -> list[Path]:
    """Draw a database into PNG files.

    Parameters
    ----------
    data : HydroDatabase
        Solid lines.
    folder : Path
        Made if absent.
    other : HydroDatabase, optional
        Dashed lines.
    mass6 : float64, shape (6, 6), optional
        Moments of inertia about the CoG, for motions and natural periods; each ship keeps its own mass. By usual radii
        of gyration if absent.
    extra_damping : float64, shape (6, 6), optional
        Linear damping beside radiation, for the motions; 5 % of critical in roll if absent.
    mesh : tuple of float64, shape (k, 3), and int, shape (j, 4), optional
        Points and panels of the hull, one side or both.

    Returns
    -------
    list of Path
        In the order in which one reads them.
    """
    mass = usual_mass(data) if mass6 is None else mass6
    ships = Ships(data, other, mass, roll_damping(data, mass) if extra_damping is None else extra_damping)
    makers: dict[str, Callable[[Ships], Figure]] = {
        "added_mass": added_mass,
        "damping": damping,
        "coupling": coupling,
        "memory": memory,
        "excitation": excitation,
        "drift": drift,
        "motions": motions,
    }
    figures = {} if mesh is None else {"hull": hull(*mesh)}
    figures |= {name: make(ships) for name, make in makers.items()}
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for name, figure in figures.items():
        path = folder / f"{name}.png"
        figure.savefig(path, dpi=DPI, metadata={"Software": None})
        paths.append(path)
    return paths


def last(ships: Ships) -> float:
    """Return where frequency axes end [rad/s]."""
    return float(ships.data.omega[-1])


def line_and_dots(
    axes: Axes, table: tuple[Array, Array], fitted: tuple[Array, Array], style: str, colour: str, label: str
) -> None:
    """Draw what the database holds as a line and what its state-space model makes of it as dots, in thousands."""
    axes.plot(table[0], table[1] / 1e3, style, color=colour, linewidth=1.5, label=label)
    if np.any(fitted[1]):
        axes.plot(fitted[0], fitted[1] / 1e3, ".", color=colour, markersize=3.5, label="its state space")


def radiation(ships: Ships, title: str, letter: str, pairs: list[tuple[int, int]]) -> Figure:
    """Draw entries of the added mass (A) or damping (B) matrix: tables as lines, state space as dots."""
    figure, all_axes = grid(ships.titled(title))
    for axes, (i, j) in zip(all_axes, pairs, strict=True):
        for (data, style), colour in zip(ships.each(), COLOURS, strict=False):
            table = data.added_mass if letter == "A" else data.damping
            fine = np.linspace(data.omega[0], data.omega[-1], 45)
            response = data.fit.response(fine)[:, i, j]
            fitted = data.added_mass_inf[i, j] + response.imag / fine if letter == "A" else response.real
            axes.plot(data.omega, table[:, i, j] / 1e3, style, color=colour, linewidth=1.5, label=f"{data.name}: table")
            if data.fit.c.any():
                axes.plot(fine, fitted / 1e3, ".", color=colour, markersize=3.5, label="its state space")
            if letter == "A":
                axes.plot(
                    last(ships), data.added_mass_inf[i, j] / 1e3, "<", color=colour, label="at infinite frequency"
                )
        power = (i > 2) + (j > 2)
        unit = (("t", "t m", "t m²") if letter == "A" else ("kN s/m", "kN s", "kN m s"))[power]
        name = f"{MODES[i]}" if i == j else f"{MODES[i]} by {MODES[j]}"
        finish(axes, f"{letter}{i + 1}{j + 1}  {name}", f"[{unit}]", "frequency [rad/s]", to=last(ships))
    legend_below(figure, all_axes[0])
    return figure


def added_mass(ships: Ships) -> Figure:
    """Draw the diagonal of the added mass."""
    return radiation(ships, "Added mass", "A", [(i, i) for i in range(6)])


def damping(ships: Ships) -> Figure:
    """Draw the diagonal of the radiation damping."""
    return radiation(ships, "Radiation damping", "B", [(i, i) for i in range(6)])


def coupling(ships: Ships) -> Figure:
    """Draw the coupling terms of the added mass."""
    return radiation(ships, "Added mass, coupling", "A", [(0, 2), (0, 4), (2, 4), (1, 3), (1, 5), (3, 5)])


def impulse(fit: RadiationFit, time: Array) -> Array:
    """Return the retardation functions (k, 6, 6) of a state-space model at times on an even grid from 0 [s]."""
    out = np.zeros((len(time), 6, 6))
    for block, modes in enumerate((LONGITUDINAL, LATERAL)):
        turn = np.stack([expm(section * (time[1] - time[0])) for section in fit.a[block]])
        state = fit.b[block]
        for k in range(len(time)):
            out[k][np.ix_(modes, modes)] = np.einsum("ijkm,km->ij", fit.c[block], state)
            state = np.einsum("kmn,kn->km", turn, state)
    return out


def memory(ships: Ships) -> Figure:
    """Draw retardation functions from the damping (lines) and of the state-space model (dots)."""
    figure, all_axes = grid(ships.titled("Retardation functions K(t), damping beyond the table taken to fall as w⁻³"))
    time = np.linspace(0.0, 15.0, 301)
    for (data, style), colour in zip(ships.each(), COLOURS, strict=False):
        integral, model = retardation(data.omega, data.damping, time), impulse(data.fit, time)
        for mode, axes in enumerate(all_axes):
            table, fitted = (time, integral[:, mode, mode]), (time[::4], model[::4, mode, mode])
            line_and_dots(axes, table, fitted, style, colour, f"{data.name}: from damping")
    for mode, axes in enumerate(all_axes):
        unit = "kN/m" if mode < 3 else "kN m"
        finish(axes, f"K{mode + 1}{mode + 1}  {MODES[mode]}", f"[{unit}]", "time [s]")
        axes.set_xlim(0.0, time[-1])
    legend_below(figure, all_axes[0])
    return figure


def by_direction(axes: Axes, data: HydroDatabase, values: Complex | Array, style: str) -> None:
    """Draw one line per direction of a table (n, m)."""
    for wanted, colour in zip(DIRECTIONS_DEG, COLOURS, strict=True):
        at = int(np.argmin(np.abs(np.rad2deg(data.direction) - wanted)))
        label = f"{np.rad2deg(data.direction[at]):.0f}°" if style == "-" else None
        axes.plot(data.omega, values[:, at], style, color=colour, linewidth=1.3, label=label)


def excitation(ships: Ships) -> Figure:
    """Draw amplitudes of the wave loads."""
    figure, all_axes = grid(ships.titled("Wave loads per wave amplitude"))
    for mode, axes in enumerate(all_axes):
        for data, style in ships.each():
            by_direction(axes, data, np.abs(data.excitation[..., mode]) / 1e3, style)
        unit = "kN/m" if mode < 3 else "kN m/m"
        finish(axes, f"F{mode + 1}  {MODES[mode]}", f"[{unit}]", "frequency [rad/s]", to=last(ships))
    legend_below(figure, all_axes[0], TOWARD)
    return figure


def drift(ships: Ships) -> Figure:
    """Draw the mean second-order loads."""
    figure, all_axes = grid(ships.titled("Mean drift per squared wave amplitude"), rows=1)
    for column, (axes, name) in enumerate(zip(all_axes, ("surge", "sway", "yaw"), strict=True)):
        for data, style in ships.each():
            by_direction(axes, data, data.drift[..., column] / 1e3, style)
        finish(axes, name, "[kN/m²]" if column < 2 else "[kN m/m²]", "frequency [rad/s]", to=last(ships))
    legend_below(figure, all_axes[0], TOWARD)
    return figure


def assumed(ships: Ships) -> str:
    """Return a line that tells the inertia and the roll damping of the motions."""
    radii = np.sqrt(np.diag(ships.mass6)[3:] / ships.mass6[0, 0])
    inertia = ships.mass6[3, 3] + ships.data.added_mass_inf[3, 3]
    share = 50.0 * ships.extra_damping[3, 3] / np.sqrt(ships.data.restoring[3, 3] * inertia)
    text = ", ".join(f"{radius:.2f}" for radius in radii)
    return f"\nradii of gyration {text} m, roll damping beside radiation {share:.1f} % of critical"


def motions(ships: Ships) -> Figure:
    """Draw amplitudes of the motions, with natural periods marked."""
    figure, all_axes = grid(ships.titled("Motions of the CoG per wave amplitude") + assumed(ships))
    for data, style in ships.each():
        table = np.abs(raos(data, own_mass(ships.mass6, data), ships.extra_damping))
        for mode, axes in enumerate(all_axes):
            by_direction(axes, data, table[..., mode] if mode < 3 else np.rad2deg(table[..., mode]), style)
    periods = natural_periods(ships.data, own_mass(ships.mass6, ships.data))
    for mode, axes in enumerate(all_axes):
        finish(axes, MODES[mode], "[m/m]" if mode < 3 else "[deg/m]", "frequency [rad/s]", to=last(ships))
        top = 1.5 if mode < 3 else axes.get_ylim()[1]
        axes.set_ylim(0.0, min(top, axes.get_ylim()[1]))
        if MODES[mode] in periods:
            at = 2.0 * np.pi / periods[MODES[mode]]
            axes.axvline(at, color=INK, linewidth=0.9, linestyle=":")
            late = at > 0.55 * last(ships)
            axes.annotate(
                f"natural period {periods[MODES[mode]]:.2f} s", (at, 0.98), xycoords=("data", "axes fraction"),
                xytext=(-3 if late else 3, 0), textcoords="offset points", fontsize=TINY, color=INK, va="top",
                ha="right" if late else "left",
            )  # fmt: skip
    legend_below(figure, all_axes[0], TOWARD)
    return figure


def hull(points: Array, panels: NDArray[np.integer[Any]]) -> Figure:
    """Draw the panels from the side, from below and along the ship."""
    from matplotlib.collections import PolyCollection

    figure = blank(f"Hull: {len(panels)} panels", 4.6)
    all_axes = figure.subplot_mosaic([["xz", "yz"], ["xy", "yz"]], width_ratios=(1.7, 1.0))
    corners = np.asarray(points)[np.asarray(panels)]
    for (names, axes), title in zip(all_axes.items(), ("from the side", "sections", "from below"), strict=True):
        flat = corners[:, :, ["xyz".index(name) for name in names]]
        axes.add_collection(PolyCollection(list(flat), facecolors="none", edgecolors=COLOURS[0], linewidths=0.4))
        axes.set_aspect("equal")
        axes.autoscale_view()
        finish(axes, title, f"{names[1]} [m]", f"{names[0]} [m]")
    return figure

"""Capability plot: the largest wind, by direction, in which the thrusters hold the ship, intact and with one lost.

Static balance, without allowance for gusts and control. Wind, the sea that goes with it and the current come from one
direction; thrust reaches every point of a convex set of horizontal loads, the sum of what each thruster gives.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim.build import hull_params, hydro_database, wind_params
from shipcrane_twin.hydro.database import HydroDatabase
from shipcrane_twin.hydro.figure_style import COLOURS, INK, SMALL, blank
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.hull import HullParams, current_load
from shipcrane_twin.physics.sea import spectra
from shipcrane_twin.physics.wind import WindParams, wind_load

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Beaufort's numbers 0 to 11 in DNV-ST-0111: wind [m/s], Hs [m], Tp [s], current [m/s]. The period of
# number 0, which has no waves, is that of number 1.
WIND_SPEED = np.array([0.0, 1.5, 3.4, 5.4, 7.9, 10.7, 13.8, 17.1, 20.7, 24.4, 28.4, 32.6])
WAVE_HEIGHT = np.array([0.0, 0.1, 0.4, 0.8, 1.3, 2.1, 3.1, 4.2, 5.7, 7.4, 9.5, 12.1])
PEAK_PERIOD = np.array([3.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5, 9.0, 10.0, 10.5, 11.5, 12.0])
CURRENT_SPEED = np.array([0.0, 0.25, 0.5, 0.75, 0.75, 0.75, 0.75, 0.75, 0.75, 0.75, 0.75, 0.75])

PEAK_ENHANCEMENT = 3.3
PERIODS = np.linspace(PEAK_PERIOD[0], PEAK_PERIOD[-1], 86)
"""Peak periods at which the drift of a sea is tabulated [s]."""

STEP_DEG = 10
CORNERS = 48
"""Of the polygon inscribed in an azimuth's circle: at most 0.22 % of its thrust is left out."""

SCAN_M_S = 1.0
TOLERANCE_M_S = 0.01


class Thruster(NamedTuple):
    """A thruster: name, place forward of and to port of the CoG [m], largest thrust [N], whether it turns."""

    name: str
    forward: float
    port: float
    thrust_max: float
    azimuthing: bool


class Ship(NamedTuple):
    """What the balance needs.

    Attributes
    ----------
    hull : HullParams
    wind : WindParams
    length : float
        [m].
    direction : float64, shape (m,)
        Where the waves go, anticlockwise from the bow, 0 to pi [rad].
    drift : float64, shape (len(PERIODS), m, 3)
        See `sea_drift`.
    thrusters : tuple of Thruster
    """

    hull: HullParams
    wind: WindParams
    length: float
    direction: Array
    drift: Array
    thrusters: tuple[Thruster, ...]


def ship_of(scenario: Scenario) -> Ship:
    """Return the ship of a scenario."""
    data = hydro_database(scenario)
    x, y, _ = scenario.vessel.cog_m
    thrusters = tuple(
        Thruster(t.name, t.position_m[0] - x, t.position_m[1] - y, t.thrust_max_n, t.azimuthing)
        for t in scenario.vessel.thrusters
    )
    drift = np.array([sea_drift(data, period) for period in PERIODS])
    return Ship(hull_params(scenario, data), wind_params(scenario), data.length, data.direction, drift, thrusters)


def thrust_facets(thrusters: Sequence[Thruster], length: float) -> Array | None:
    """Return the half-spaces whose common part is the set of attainable loads.

    Parameters
    ----------
    thrusters : sequence of Thruster
    length : float
        What makes the moment comparable with the forces [m].

    Returns
    -------
    float64, shape (k, 4), or None
        Rows (n, b): ``n @ (surge, sway, yaw / length) <= b``, n a unit vector, b in N; None for thrusters that do not
        control all three axes.
    """
    corners = np.zeros((1, 3))
    angle = np.arange(CORNERS) * (2.0 * np.pi / CORNERS)
    for thruster in thrusters:
        if thruster.azimuthing:
            force = thruster.thrust_max * np.column_stack([np.cos(angle), np.sin(angle)])
        else:
            force = thruster.thrust_max * np.array([[0.0, 1.0], [0.0, -1.0]])
        moment = thruster.forward * force[:, 1] - thruster.port * force[:, 0]
        own = np.column_stack([force, moment / length])
        corners = (corners[:, None] + own[None]).reshape(-1, 3)
        if np.linalg.matrix_rank(corners) == 3:  # keeps the number of corners small when there are many thrusters
            corners = corners[ConvexHull(corners).vertices]
    if np.linalg.matrix_rank(corners) < 3:
        return None
    facets = ConvexHull(corners).equations
    return np.column_stack([facets[:, :3], -facets[:, 3]])


def sea_drift(data: HydroDatabase, period: float) -> Array:
    """Return the mean drift load (m, 3) of long-crested JONSWAP seas to the table's directions, over Hs squared.

    Surge, sway [N/m2], yaw about the CoG [N/m]; `period` is that of the peak [s].

    Notes
    -----
    ``2 int S(w) T(w) dw`` with T the drift per squared amplitude (Faltinsen 1990, section 5), linear over frequency;
    beyond the table's frequencies T is held, as in `physics.sea.loads`.
    """
    omega = spectra.grid(period)
    density = spectra.jonswap(omega, 1.0, period, PEAK_ENHANCEMENT)
    place = np.interp(omega, data.omega, np.arange(len(data.omega)))
    row = np.minimum(place.astype(np.intp), len(data.omega) - 2)
    part = (place - row)[:, None, None]
    transfer = (1.0 - part) * data.drift[row] + part * data.drift[row + 1]
    return np.asarray(np.trapezoid(2.0 * density[:, None, None] * transfer, omega, axis=0))


def wave_drift(ship: Ship, height: float, period: float, direction: float) -> Array:
    """Return the mean drift load (3,) of a sea: surge, sway [N], yaw about the CoG [N m]; linear in the tables.

    Parameters
    ----------
    ship : Ship
    height, period : float
        Significant height [m] and peak period [s].
    direction : float
        Where the waves go, anticlockwise from the bow [rad].
    """
    turn = (direction + np.pi) % (2.0 * np.pi) - np.pi
    side = -1.0 if turn < 0.0 else 1.0
    at = float(np.interp(period, PERIODS, np.arange(len(PERIODS))))
    place = float(np.interp(abs(turn), ship.direction, np.arange(len(ship.direction))))
    i, j = min(int(at), len(PERIODS) - 2), min(int(place), len(ship.direction) - 2)
    rows = (i + 1 - at) * ship.drift[i, j : j + 2] + (at - i) * ship.drift[i + 1, j : j + 2]
    return height**2 * np.array([1.0, side, side]) * ((j + 1 - place) * rows[0] + (place - j) * rows[1])


def weather_load(ship: Ship, wind_speed: float, from_deg: float, current_speed: float | None = None) -> Array:
    """Return the mean load (3,) of wind, waves and current on the ship: surge, sway [N], yaw [N m], FLU.

    Parameters
    ----------
    ship : Ship
    wind_speed : float
        [m/s], up to the table's end.
    from_deg : float
        Where all three come from, clockwise from the bow [deg].
    current_speed : float, optional
        [m/s]; the table's if absent.

    Notes
    -----
    Waves by DNV-ST-0111's relation of wind and sea, linear between Beaufort's numbers.
    """
    towards = np.pi - np.deg2rad(from_deg)
    cos, sin = np.cos(towards), np.sin(towards)
    height = float(np.interp(wind_speed, WIND_SPEED, WAVE_HEIGHT))
    period = float(np.interp(wind_speed, WIND_SPEED, PEAK_PERIOD))
    current = float(np.interp(wind_speed, WIND_SPEED, CURRENT_SPEED)) if current_speed is None else current_speed
    blown = wind_load(ship.wind, wind_speed * cos, wind_speed * sin)[[0, 1, 5]]
    flow = np.array(current_load(ship.hull, current * cos, current * sin))
    return np.asarray(blown + flow + wave_drift(ship, height, period, towards))


def largest_wind(ship: Ship, facets: Array, from_deg: float, current_speed: float | None = None) -> float:
    """Return the wind speed up to which the ship is held in every wind from a direction [m/s].

    Parameters
    ----------
    ship : Ship
    facets : float64, shape (k, 4)
        Attainable set, see `thrust_facets`.
    from_deg : float
        Where the weather comes from, clockwise from the bow [deg].
    current_speed : float, optional
        See `weather_load`.

    Notes
    -----
    The first wind that is too strong is sought in steps of 1 m/s and then by bisection. It ends where the table does,
    at 32.6 m/s; 0 where the current alone is too much. Losing a thruster makes the attainable set smaller, so that
    never more wind is held than before.
    """
    normals, offset = facets[:, :3] / [1.0, 1.0, ship.length], facets[:, 3]

    def holds(speed: float) -> bool:
        return bool((normals @ -weather_load(ship, speed, from_deg, current_speed) <= offset).all())

    low, top = 0.0, float(WIND_SPEED[-1])
    if not holds(low):
        return 0.0
    while low < top and holds(min(low + SCAN_M_S, top)):
        low = min(low + SCAN_M_S, top)
    high = min(low + SCAN_M_S, top)
    while high - low > TOLERANCE_M_S:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def remaining(ship: Ship, lost: Sequence[str]) -> list[Thruster]:
    """Return the thrusters that work.

    Raises
    ------
    ValueError
        If a lost one is none of the ship's.
    """
    names = [thruster.name for thruster in ship.thrusters]
    for name in lost:
        if name not in names:
            raise ValueError(f"capability: {name} is no thruster of the ship, expected one of {', '.join(names)}")
    return [thruster for thruster in ship.thrusters if thruster.name not in lost]


def capability(ship: Ship, lost: Sequence[str] = (), current_speed: float | None = None) -> Array:
    """Return the winds held (36,) [m/s] in weather from every tenth degree clockwise from the bow.

    Parameters
    ----------
    ship : Ship
    lost : sequence of str
        Names of the thrusters that give nothing.
    current_speed : float, optional
        See `weather_load`.
    """
    from_deg = np.arange(0.0, 360.0, STEP_DEG)
    facets = thrust_facets(remaining(ship, lost), ship.length)
    if facets is None:
        return np.zeros_like(from_deg)
    return np.array([largest_wind(ship, facets, angle, current_speed) for angle in from_deg])


def capabilities(ship: Ship, current_speed: float | None = None) -> dict[str, Array]:
    """Return the winds held (n,) [m/s] of the intact ship and of the ship without each of its thrusters, by case."""
    cases = {"intact": capability(ship, (), current_speed)}
    for thruster in ship.thrusters:
        cases[f"without {thruster.name}"] = capability(ship, (thruster.name,), current_speed)
    return cases


def capability_figure(name: str, cases: Mapping[str, Array], title: str = "Wind held") -> Figure:
    """Draw the winds held of several cases around the ship, bow up.

    Parameters
    ----------
    name : str
        Of the ship.
    cases : mapping of str to float64, shape (n,)
        Winds [m/s] at equal steps of direction from the bow, clockwise.
    title : str
    """
    figure = blank(f"{title}: {name}", 7.4)
    axes: Any = figure.add_subplot(projection="polar")
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    for (case, winds), colour in zip(cases.items(), COLOURS, strict=False):
        angle = np.linspace(0.0, 2.0 * np.pi, len(winds) + 1)
        axes.plot(angle, np.append(winds, winds[0]), color=colour, linewidth=1.6, label=case.replace("_", " "))
    end = float(WIND_SPEED[-1])
    if any(np.max(winds) >= end for winds in cases.values()):
        axes.plot(np.linspace(0.0, 2.0 * np.pi, 181), np.full(181, end), color=INK, linewidth=0.8, linestyle=":",
                  label="end of the wind table")  # fmt: skip
    axes.set_rlim(0.0, 1.05 * max(float(np.max(winds)) for winds in cases.values()) + 0.5)
    axes.set_thetagrids(range(0, 360, 30))
    axes.tick_params(labelsize=SMALL, colors=INK)
    axes.set_rlabel_position(15.0)
    label = "wind speed [m/s] by the direction wind, waves and current come from, bow up"
    axes.set_xlabel(label, fontsize=SMALL, color=INK)
    axes.legend(loc="center left", bbox_to_anchor=(1.08, 0.5), fontsize=SMALL, frameon=False)
    return figure

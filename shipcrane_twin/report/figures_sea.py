"""The sea at the ship and what it does to it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shipcrane_twin.physics.sea.kinematics import ramp_factor
from shipcrane_twin.record.read import Signals
from shipcrane_twin.report.motions import Array, ship_motion
from shipcrane_twin.report.style import (
    BLUE,
    GREEN,
    VERMILLION,
    Plot,
    finish,
    legend,
    line,
    mark_operations,
    operations_of,
    time_axes,
)

SAMPLES_MAX = 6000
"""Times at which the elevation is computed: each costs all components."""


def elevation_at(columns: Mapping[str, Array], time_s: Array, east_m: Array, north_m: Array, ramp_s: float) -> Array:
    """Return the elevation (n,) [m] of a recorded sea at times and places (n,), see ``/environment/sea_state``."""
    angle = np.outer(time_s, columns["omega"]) + columns["phase"]
    angle -= np.outer(east_m, columns["number_x"]) + np.outer(north_m, columns["number_y"])
    ramp = np.array([ramp_factor(ramp_s, float(moment)) for moment in time_s])
    found: NDArray[np.float64] = ramp * (np.cos(angle) @ columns["amplitude"])
    return found


def sea(signals: Signals, scenario: Mapping[str, Any]) -> Plot | None:
    """Draw elevation at the ship with its heave, and wave loads on it."""
    columns = signals.clouds.get("/environment/sea_state")
    odom = signals.series.get("/vessel/odom")
    load = signals.series.get("/environment/wave_wrench")
    if not columns or not columns["amplitude"].any() or odom is None or load is None or not len(odom.time_s):
        return None
    motion = ship_motion(odom, scenario["vessel"]["cog_m"], scenario["vessel"]["draught_m"])
    every = max(1, len(motion.time_s) // SAMPLES_MAX)
    time_s = motion.time_s[::every]
    ramp_s = float(scenario["environment"]["waves"]["ramp_s"])
    elevation = elevation_at(columns, time_s, motion.east_m[::every], motion.north_m[::every], ramp_s)

    figure, rows = time_axes(3)
    stack = [row[0] for row in rows]
    line(stack[0], time_s, elevation, BLUE, "sea")
    line(stack[0], motion.time_s, motion.heave_m, VERMILLION, "heave")
    legend(stack[0])
    line(stack[1], load.time_s, load.values[:, 2] / 1e3, GREEN)
    line(stack[2], load.time_s, load.values[:, 3] / 1e3, GREEN)
    labels = ("above still water [m]", "wave force\nupward [kN]", "wave moment\nstarboard down [kN m]")
    for axes, label, span in zip(stack, labels, (0.2, 10.0, 10.0), strict=True):
        finish(axes, label, span)
    mark_operations([stack], operations_of(scenario))
    height = 4.0 * np.sqrt(0.5 * np.sum(columns["amplitude"] ** 2))
    count = len(columns["amplitude"])
    caption = (
        f"Undisturbed sea at the ship (Hs {height:.2f} m of {count} components) "
        "and the ship's heave in it; below, the waves' vertical force and roll moment."
    )
    return Plot("sea", "Waves at the ship", caption, figure)

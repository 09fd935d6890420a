"""Moves: the box manoeuvre, and a heavy load slewed from side to side."""

from itertools import pairwise

import numpy as np

from shipcrane_twin.config.scenario import NS_PER_MS
from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.validation.positioning import Ride, during, off_setpoint, rms, slow, wrapped

BOX, LIFT = "dp_box", "dp_slew_lift"
EVERY_STEP = ("telemetry_period_ms=20.0",)
"""Every macro step of the scenarios here, so that no turn of a thruster goes unseen."""

FEED_FORWARD = {"without": ("dp.controller.crane_share=0.0",), "with": ("dp.controller.crane_share=1.0",)}
OVERSHOOT_BAR, CLOSE = 0.05, 1e-9
LIFT_STARTS_S = 195.0
"""A little before the first slewing."""


def legs(run: Ride) -> list[tuple[slice, Array]]:
    """Return the rows of each leg that the run has begun, and the way (3,) from the last set-point to its own."""
    starts = [point.at_s for point in run.scenario.dp.setpoints if point.at_s < run.time_s[-1]]
    points = [run.setpoint[during(run, at_s)][0] for at_s in (0.0, *starts)]
    spans = pairwise([*starts, np.inf])
    return [(during(run, *span), after - before) for span, (before, after) in zip(spans, pairwise(points), strict=True)]


def overshoots(run: Ride) -> tuple[Array, Array]:
    """Return how far slow position and heading go beyond each leg's set-point, as shares of the way to it (n,)."""
    pose = slow(run.pose, run.step_s)
    place, heading = [], []
    for rows, way in legs(run):
        off = pose[rows] - run.setpoint[rows]
        length = np.hypot(*way[:2])
        place.append((off[:, :2] @ way[:2]).max() / length**2)
        heading.append((wrapped(off[:, 2]) / way[2]).max())
    return np.maximum(place, 0.0), np.maximum(heading, 0.0)


def azimuth_rates(run: Ride) -> Array:
    """Return the rates (n,) of the thrusters that steer, the fastest at each macro step [deg/s]."""
    assert run.scenario.telemetry_period_ms * NS_PER_MS == run.scenario.step_ns
    steers = np.array([thruster.azimuthing for thruster in run.scenario.vessel.thrusters])
    turn = np.diff(run.azimuth[:, steers], axis=0)
    turn -= 2.0 * np.pi * np.round(turn / (2.0 * np.pi))
    return np.rad2deg(np.abs(turn)).max(axis=1) / run.step_s


def box_rows(run: Ride) -> list[Row]:
    """Return overshoots, how well each leg ends, and the fastest turn of an azimuth."""
    place, heading = overshoots(run)
    distance, _ = off_setpoint(run)
    ends = [distance[rows][-1] for rows, _ in legs(run)]
    fastest = float(azimuth_rates(run).max())
    limit = min(t.azimuth_rate_max_deg_s for t in run.scenario.vessel.thrusters if t.azimuthing)

    def each(shares: Array) -> str:
        return "legs: " + ", ".join(f"{100.0 * share:.1f}" for share in shares) + " %"

    return [
        Row("box: overshoot along the leg, of 10 m", float(place.max()), OVERSHOOT_BAR, "", each(place)),
        Row("box: overshoot of the heading, of 45 deg", float(heading.max()), OVERSHOOT_BAR, "", each(heading)),
        Row("box: off the set-point at the end of a leg", float(max(ends)), 0.5, "m"),
        Row(
            "box: fastest turn of an azimuth, at every macro step", fastest, limit * (1.0 + CLOSE), "deg/s",
            f"limit {limit:g} deg/s",
        ),
    ]  # fmt: skip


def lift_rows(runs: dict[str, Ride]) -> list[Row]:
    """Compare how far the slewing load takes the ship with and without feed-forward of the crane's wrench."""
    rows = []
    for unit, k in (("m", 0), ("deg", 1)):
        name = ("position", "heading")[k]
        off = {case: np.abs(off_setpoint(run)[k][during(run, LIFT_STARTS_S)]) for case, run in runs.items()}
        largest = {case: float(values.max()) for case, values in off.items()}
        note = f"{largest['with'] / largest['without']:.2f} of it; RMS {rms(off['with']):.3f} {unit}"
        rows.append(Row(f"5 t slewed: {name} off, without feed-forward", largest["without"], None, unit))
        rows.append(Row(f"5 t slewed: {name} off, with feed-forward", largest["with"], largest["without"], unit, note))
    return rows

"""Short inline runs of the whole twin with dynamic positioning, and what an operator may say in between."""

import json

import numpy as np

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.inline import InlineRun
from shipcrane_twin.physics.frames import euler_from_matrix, matrix_from_quat

STEP_S = 0.02
CALM = ("operations=[]", "events=[]", "environment.wind_direction_to_deg=90.0", "environment.wind_speed_m_s=8.0")
"""Wind to the east on a ship that heads north: from port abeam."""

SEA = (
    "environment.waves.systems=[{spectrum: jonswap, direction_to_deg: 60.0, significant_wave_height_m: 1.0, "
    "peak_period_s: 7.0, peak_enhancement: 2.0, spreading_exponent: 8.0}]"
)


def event(at_s, kind, **keys):
    return {"label": kind, "at_s": at_s, "event": kind, **keys}


def dp_scenario(duration_s, *changes, events=(), setpoints=()):
    """Return a scenario of wind alone, with changes by key and lists of events and set-points."""
    lists = [f"events={json.dumps(list(events))}", f"dp.setpoints={json.dumps(list(setpoints))}"]
    return load_scenario("case2", [*CALM, f"duration_s={duration_s}", "dp.enabled_at_s=2.0", *lists, *changes])


class DpRun:
    """A whole run: every published number is finite, or it fails.

    Parameters
    ----------
    scenario : Scenario
    orders : dict
        By time of a step's start [s]: what is called with the vessel's DP then.
    """

    def __init__(self, scenario, orders=None):
        self.times, self.values, self.warnings, self.on = {}, {}, {}, {}
        orders = {round(at_s / STEP_S): order for at_s, order in (orders or {}).items()}
        run = InlineRun(scenario, self._keep)
        self.dp = next(part.subsystem for part in run._participants if part.name == "vessel").positioning
        for k in run.steps():
            if k % 5 == 0:
                self.warnings[k], self.on[k] = self.dp.warnings(), self.dp.on
            if k in orders:
                orders[k](self.dp)
        self.digest = run.digest

    def _keep(self, time_ns, topic, values):
        assert np.isfinite(values).all(), f"{topic} at {time_ns / 1e9} s: {values}"
        self.times.setdefault(topic, []).append(time_ns / 1e9)
        self.values.setdefault(topic, []).append(values)

    def series(self, topic):
        """Return times (n,) and values (n, width) of a topic."""
        return np.array(self.times[topic]), np.array(self.values[topic])

    def told(self, from_s, to_s):
        """Return all warnings of a time span, as one text per look."""
        return ["; ".join(told) for k, told in self.warnings.items() if from_s <= k * STEP_S <= to_s]

    def cog(self):
        """Return times and east, north, yaw (n, 3) of the CoG every 0.1 s."""
        times, odom = self.series("/vessel/odom")
        rows = []
        for row in odom[::5]:
            rot = matrix_from_quat(row[3:7])
            place = row[:3] + rot @ self.dp._cog
            rows.append([place[0], place[1], euler_from_matrix(rot)[2]])
        return times[::5], np.array(rows)

    def excursion(self, from_s, to_s):
        """Return the largest distance of the CoG from the origin in a time span [m]."""
        times, pose = self.cog()
        here = (times >= from_s) & (times <= to_s)
        return np.hypot(pose[here, 0], pose[here, 1]).max()


def poses(values):
    """Return east, north, yaw (n, 3) of columns that start with a pose."""
    yaw = [euler_from_matrix(matrix_from_quat(row[3:7]))[2] for row in values]
    return np.column_stack((values[:, :2], yaw))

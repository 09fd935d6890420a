"""Numbers of one run: motions, position keeping, wire and load, and whether any message is missing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shipcrane_twin.cosim.topics import TOPICS, Topic
from shipcrane_twin.record.read import Signals
from shipcrane_twin.report.motions import (
    Array,
    ShipMotion,
    payload_offset,
    position_error_m,
    ship_motion,
    sway_angle_deg,
)

Stats = dict[str, float] | None


@dataclass(frozen=True, slots=True)
class Gap:
    """A topic whose messages are not exactly one per due time.

    Attributes
    ----------
    expected, found : int
        Number of messages.
    first_s : float or None
        First due time without its message [s]; None if only superfluous messages were found.
    """

    topic: str
    expected: int
    found: int
    first_s: float | None

    def __str__(self) -> str:
        """One line for people."""
        where = (
            "messages nobody expects" if self.first_s is None else f"first missing at t = {self.first_s:g} s"
        )
        return f"{self.topic}: {self.found} messages instead of {self.expected}, {where}"


def summarise(signals: Signals, scenario: Mapping[str, Any]) -> dict[str, Any]:
    """Return the statistics of a run, ready for summary.json.

    Parameters
    ----------
    signals : Signals
        The bag.
    scenario : mapping
        Resolved scenario; read are ``vessel.cog_m``, ``vessel.draught_m`` and ``dp``.

    Returns
    -------
    dict
        roll_deg, pitch_deg, heave_m {mean, std, min, max}; position_error_m {rms, max} from
        ``dp.enabled_at_s + dp.settled_after_s`` on; wire_tension_kn {mean, max, min}; payload_sway_deg
        {rms, max}; messages (number per topic). None instead of {...} where the bag has no such data.
        Sway counts only while the load hangs on the wire (tension above zero).
    """
    motion = motion_of(signals, scenario)
    tension = wire_tension_kn(signals)
    return {
        "roll_deg": _stats(motion.roll_deg if motion else None, "mean", "std", "min", "max"),
        "pitch_deg": _stats(motion.pitch_deg if motion else None, "mean", "std", "min", "max"),
        "heave_m": _stats(motion.heave_m if motion else None, "mean", "std", "min", "max"),
        "position_error_m": _stats(_settled_error(motion, scenario), "rms", "max"),
        "wire_tension_kn": _stats(None if tension is None else tension[1], "mean", "max", "min"),
        "payload_sway_deg": _stats(_hanging_sway(signals), "rms", "max"),
        "messages": dict(sorted(signals.counts.items())),
    }


def motion_of(signals: Signals, scenario: Mapping[str, Any]) -> ShipMotion | None:
    """Return the ship's motion, or None without ``/vessel/odom``."""
    odom = signals.series.get("/vessel/odom")
    if odom is None or not len(odom.stamp_ns):
        return None
    vessel = scenario["vessel"]
    return ship_motion(odom, vessel["cog_m"], vessel["draught_m"])


def wire_tension_kn(signals: Signals) -> tuple[Array, Array] | None:
    """Return times [s] and the norm of the wire's force on the tip [kN], each shape (n,)."""
    wrench = signals.series.get("/payload/wire_wrench")
    if wrench is None or not len(wrench.stamp_ns):
        return None
    return wrench.time_s, np.linalg.norm(wrench.values[:, :3], axis=1) / 1000.0


def settled_at_s(scenario: Mapping[str, Any]) -> float:
    """Return the time from which the position error counts [s]."""
    return float(scenario["dp"]["enabled_at_s"]) + float(scenario["dp"]["settled_after_s"])


def _settled_error(motion: ShipMotion | None, scenario: Mapping[str, Any]) -> Array | None:
    if motion is None:
        return None
    goal = scenario["dp"]["setpoint"]
    error = position_error_m(motion, goal["north_m"], goal["east_m"])
    return error[motion.time_s >= settled_at_s(scenario)]


def _hanging_sway(signals: Signals) -> Array | None:
    tip, payload = signals.series.get("/crane/tip"), signals.series.get("/payload/odom")
    if tip is None or payload is None:
        return None
    time_s, offset = payload_offset(tip, payload)
    sway = sway_angle_deg(offset)
    tension = wire_tension_kn(signals)
    if tension is None:
        return sway
    taut_s = tension[0][tension[1] > 0.0]
    return sway[np.isin(time_s, taut_s)]


def _stats(values: Array | None, *names: str) -> Stats:
    if values is None or not len(values):
        return None
    numbers = {
        "mean": values.mean(),
        "std": values.std(),
        "min": values.min(),
        "max": values.max(),
        "rms": np.sqrt(np.mean(values**2)),
    }
    return {name: float(numbers[name]) for name in names}


def find_gaps(
    signals: Signals,
    *,
    end_s: float,
    macro_step_ms: float,
    telemetry_period_ms: float,
    topics: Sequence[Topic] = TOPICS,
) -> list[Gap]:
    """Check that every topic has exactly one message per due time, from t = 0 to the end.

    Parameters
    ----------
    signals : Signals
        The bag.
    end_s : float
        Simulated time that the run reached [s].
    macro_step_ms, telemetry_period_ms : float
        Periods of the topics with the rates ``step`` and ``telemetry`` [ms].
    topics : sequence of Topic
        What should be in the bag; irregular topics are not checked.

    Returns
    -------
    list of Gap
        Empty if the bag is complete.
    """
    periods_ms = {"step": macro_step_ms, "telemetry": telemetry_period_ms}
    gaps = []
    for topic in topics:
        if topic.rate == "once" and (found := signals.counts.get(topic.name, 0)) != 1:
            gaps.append(Gap(topic.name, 1, found, 0.0 if not found else None))
        if topic.rate not in periods_ms:
            continue
        due_ns = np.arange(0, round(end_s * 1e9) + 1, round(periods_ms[topic.rate] * 1e6), dtype=np.int64)
        stamps = _stamps(signals, topic.name)
        missing = np.setdiff1d(due_ns, stamps)
        if len(missing) or len(stamps) != len(due_ns):
            first_s = float(missing[0]) * 1e-9 if len(missing) else None
            gaps.append(Gap(topic.name, len(due_ns), len(stamps), first_s))
    return gaps


def _stamps(signals: Signals, name: str) -> NDArray[np.int64]:
    if name in signals.series:
        return signals.series[name].stamp_ns
    if name in signals.joints:
        return signals.joints[name].stamp_ns
    return np.empty(0, dtype=np.int64)

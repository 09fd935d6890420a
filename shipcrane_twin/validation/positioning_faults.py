"""Faults under way in the rougher weather: what DP holds, what it cannot, and what an operator is told."""

import numpy as np

from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.validation.positioning import Ride, during, off_setpoint, rms

WEATHER = "case3_e2"
FAULT_S, RETURN_S = 300.0, 360.0
"""The fault happens, and the position reference comes back [s]."""

SETTLED_S = 380.0
HELD_BAR_M = 2.0


def event(at_s: float, kind: str, more: str = "") -> str:
    """Return an event as it stands in a scenario."""
    return f"{{label: {kind.replace('_', ' ')}, at_s: {at_s}, event: {kind}{more}}}"


CASES = {
    "starboard azimuth lost": [event(FAULT_S, "thruster_fault", ", which: azimuth_starboard, fault: failed")],
    "half the power": [event(FAULT_S, "power_limit", ", share: 0.5")],
    "position lost": [
        event(FAULT_S, "sensor_fault", ", which: position, fault: drop_out"),
        event(RETURN_S, "sensor_fault", ", which: position, fault: none"),
    ],
    "port azimuth lost": [event(FAULT_S, "thruster_fault", ", which: azimuth_port, fault: failed")],
    "drive-off": [event(FAULT_S, "thruster_fault", ", which: azimuth_port, fault: runaway")],
    "drift-off": [event(FAULT_S, "power_limit", ", share: 0.0")],
}
HELD = ("starboard azimuth lost", "port azimuth lost", "half the power")
AWAY = ("drift-off",)
"""Those that a bar judges, and those that end in drifting away."""


def changes(case: str) -> tuple[str, ...]:
    """Return what to change in the scenario for a case."""
    return (f"events=[{', '.join(CASES[case])}]",)


def finite(run: Ride) -> bool:
    """Return whether all that a run showed are numbers."""
    return all(np.isfinite(values).all() for values in run if isinstance(values, np.ndarray))


def fault_rows(runs: dict[str, Ride]) -> list[Row]:
    """Return excursions after each fault, and how many runs broke down or stayed silent."""
    rows = []
    for case, run in runs.items():
        after = off_setpoint(run)[0][during(run, FAULT_S)]
        minute = float(off_setpoint(run)[0][during(run, FAULT_S, FAULT_S + 60.0)].max())
        if case in HELD:
            held = off_setpoint(run)[0][during(run, SETTLED_S)]
            what = f"{case}: position, RMS from {SETTLED_S:.0f} s on"
            rows.append(Row(what, rms(held), HELD_BAR_M, "m", f"{after.max():.1f} m at most after the fault"))
        elif case == "position lost":
            error = np.hypot(*(run.estimate - run.pose)[:, :2].T)
            lost = float(error[during(run, FAULT_S, RETURN_S)].max())
            rows.append(Row(f"{case}: estimated against true position, 60 s of dead reckoning", lost, None, "m"))
            rows.append(Row(f"{case}: position off, largest within 60 s", minute, None, "m"))
        else:
            rows.append(Row(f"{case}: position off, largest within 60 s", minute, None, "m"))
    silent = [case for case, run in runs.items() if not run.warnings]
    broken = [case for case, run in runs.items() if not finite(run)]
    rows.append(Row("faults without a warning", float(len(silent)), 0.0, f"of {len(runs)}", ", ".join(silent)))
    rows.append(Row("faults with a number that is none", float(len(broken)), 0.0, f"of {len(runs)}", ", ".join(broken)))
    return rows


def warnings_text(runs: dict[str, Ride]) -> str:
    """Return the warnings of each case as a list."""
    return "\n".join(f"- {case}: {'; '.join(run.warnings) or 'none'}" for case, run in runs.items())

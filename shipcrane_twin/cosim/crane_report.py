"""What a crane tells its operator: which limits its joints met of late, how much it carries, what holds it."""

from collections.abc import Sequence

import numpy as np

from shipcrane_twin.cosim.time import NS_PER_S
from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_reference import FLAG_COMMAND, FLAG_EFFORT, FLAG_REFUSED, FLAG_SPEED

TOLD_FOR_S = 2.0
"""For how long after a step a limit met in it is told [s of simulated time]."""

LIMITS = {
    FLAG_REFUSED: "at its end",
    FLAG_SPEED: "told to go faster than its drive",
    FLAG_EFFORT: "at the greatest force of its drive",
    FLAG_COMMAND: "told no finite number",
}


class SeenFlags:
    """When each joint last met each limit.

    Parameters
    ----------
    joints : sequence of str
    step_ns : int
    """

    def __init__(self, joints: Sequence[str], step_ns: int) -> None:
        self._joints = tuple(joints)
        self._keep = round(TOLD_FOR_S * NS_PER_S) // step_ns
        self._last: dict[tuple[int, int], int] = {}
        self._step = 0

    def note(self, step: int, flags: Ints) -> None:
        """Take the flags (n,) of a step."""
        self._step = step
        for joint in np.flatnonzero(flags).tolist():
            for flag in LIMITS:
                if flags[joint] & flag:
                    self._last[joint, flag] = step

    def told(self) -> list[str]:
        """Return the limits met of late, in words."""
        return [
            f"{name} {words}"
            for joint, name in enumerate(self._joints)
            for flag, words in LIMITS.items()
            if self._step - self._last.get((joint, flag), -self._keep - 1) <= self._keep
        ]


def limiter_warnings(load: Array, warned: bool) -> list[str]:
    """Return what the load limiter has to say.

    Parameters
    ----------
    load : float64, shape (5,)
        See `control.load_limiter.load_state`.
    warned : bool
        Whether the warning level is reached.
    """
    radius, safe, hook, share, cut_out = load
    at = f"{hook:.0f} kg on the hook at {radius:.1f} m, where {safe:.0f} kg are safe ({100.0 * share:.0f} %)"
    if cut_out:
        return [f"overload cut-out, outward and hoisting refused: {at}"]
    return [f"overload warning: {at}"] if warned else []


def condition_of(load: Array, joints: Sequence[str], brakes: Array, powered: bool) -> dict[str, str]:
    """Return how crane and load do, values by name with their unit; brakes (n,) are 1 where shut."""
    radius, safe, hook, share, cut_out = load
    return {
        "power": "on" if powered else "off",
        "radius_m": f"{radius:.2f}",
        "hook_load_kg": f"{hook:.0f}",
        "safe_working_load_kg": f"{safe:.0f}",
        "utilisation_percent": f"{100.0 * share:.0f}",
        "cut_out": "yes" if cut_out else "no",
        "braked": ", ".join(name for name, shut in zip(joints, brakes, strict=True) if shut) or "none",
    }

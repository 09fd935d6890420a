"""Coupling schemes: which value of a neighbour a subsystem uses, and who carries whose inertia.

A macro step is a chain environment, vessel, crane, payload. In it a subsystem may use the value of a
subsystem before it at the end of the step (motion, interpolated over the step), and of one behind it
the value of the step before (feedback: forces as means over the interval, never extrapolated).
Controllers that a scenario lists come behind all of them, see `cosim.controllers`.
"""

from dataclasses import dataclass

CHAIN = ("environment", "vessel", "crane", "payload")
"""The subsystems in the order in which a step runs through them."""

INPUTS: dict[str, tuple[str, ...]] = {
    "environment": ("/vessel/odom",),
    "vessel": (
        "/environment/current",
        "/environment/wind",
        "/environment/wave_wrench",
        "/environment/wind_wrench",
        "/crane/base_wrench",
        "/crane/base_inertia",
    ),
    "crane": ("/vessel/odom", "/vessel/accel", "/payload/wire_wrench", "/payload/felt_inertia"),
    "payload": ("/crane/tip", "/crane/load_state"),
}
"""The topics that each subsystem waits for in every step."""

FEEDBACK: dict[tuple[str, str], str] = {
    ("vessel", "environment"): "ship motion to wave and wind loads",
    ("crane", "vessel"): "crane wrench and inertia to ship",
    ("payload", "crane"): "wire force and felt mass to crane tip",
}
"""Every link (from, to) against the direction of the chain, with its name."""


@dataclass(frozen=True, slots=True)
class Scheme:
    """A coupling scheme.

    Attributes
    ----------
    name : str
        As in the scenario's ``coupling``.
    carries_inertia : bool
        Each part carries the inertia of what hangs on it in its own equations: the ship the crane's
        (joints frozen) with its weight, the crane that of the load along the wire. The wrench and the
        force that come back a step late count without these parts. The immediate reaction of one part
        to the other is then never late.
    about : str
        For people.
    """

    name: str
    carries_inertia: bool
    about: str

    def lag(self, consumer: str, publisher: str) -> int:
        """Return how many steps old the publisher's value is that the consumer uses: 0 or 1."""
        return 0 if place_of(publisher) < place_of(consumer) else 1


def place_of(name: str) -> int:
    """Return where a participant stands in a step; controllers share the place behind the chain."""
    return CHAIN.index(name) if name in CHAIN else len(CHAIN)


SCHEMES = {
    scheme.name: scheme
    for scheme in (
        Scheme("in_turn", False, "in turn, motion interpolated, mean forces fed back"),
        Scheme("in_turn+inertia", True, "in_turn, and each part carries the inertia of what hangs on it"),
    )
}

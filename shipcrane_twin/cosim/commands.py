"""Commands of joints and tip: the scenario's operations, and what an operator says over them."""

from collections.abc import Collection, Sequence

import numpy as np

from shipcrane_twin.config.scenario import OperationConfig
from shipcrane_twin.cosim.time import NS_PER_S
from shipcrane_twin.physics.arrays import Array, Ints
from shipcrane_twin.physics.crane_reference import POSITION, VELOCITY

TIP_FRAMES = ("crane_base", "map")
"""Axes in which an operator may ask for a velocity of the tip."""


def wrong_command(
    names: Sequence[str], velocities: Sequence[float], positions: Sequence[float] = (), by_speed: Collection[str] = ()
) -> str | None:
    """Return why a command must be refused, or None.

    Parameters
    ----------
    names : sequence of str
    velocities, positions : sequence of float
        One of the two is filled, with one number for each name.
    by_speed : collection of str
        Joints that a controller steers, which takes no positions.
    """
    if len(velocities) and len(positions):
        return f"{len(velocities)} velocities and {len(positions)} positions; expected one of the two arrays filled"
    what, values = ("position", positions) if len(positions) else ("velocity", velocities)
    plural = what[:-1] + "ies" if what == "velocity" else what + "s"
    if len(names) != len(values):
        return f"{len(names)} names but {len(values)} {plural}; expected one {what} per name"
    if len(set(names)) < len(names):
        return f"the names {', '.join(names)}; expected every joint once"
    if not np.isfinite(values).all():
        return f"{plural} {list(values)}; expected finite numbers"
    steered = [name for name in names if name in by_speed]
    if len(positions) and steered:
        return f"a position for {steered[0]}, which a controller steers; expected a velocity"
    return None


class JointCommands:
    """Commands of some joints: an operator's word counts until the next one, else the operations.

    Parameters
    ----------
    joints : sequence of str
        The joints served, in the order of the command array.
    operations : sequence of OperationConfig
        Timed velocities and positions; those of other joints are left out.
    by_speed : collection of str
        Joints, of anybody, that take no positions.
    tip_timeout_s : float
        How long a word for the tip counts [s].
    """

    def __init__(
        self,
        joints: Sequence[str],
        operations: Sequence[OperationConfig],
        by_speed: Collection[str] = (),
        tip_timeout_s: float = 0.0,
    ) -> None:
        self._index = {name: i for i, name in enumerate(joints)}
        self._by_speed = frozenset(by_speed)
        self._moves = [
            (round(move.from_s * NS_PER_S), round(move.to_s * NS_PER_S), self._index[move.joint], order_of(move))
            for move in operations
            if move.joint in self._index
        ]
        self._said: dict[int, tuple[int, float]] = {}
        self._timeout_ns = round(tip_timeout_s * NS_PER_S)
        self._tip: tuple[str, Array] | None = None
        self._tip_until: int | None = None

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints served."""
        return tuple(self._index)

    def say(
        self, names: Sequence[str], velocities: Sequence[float] = (), positions: Sequence[float] = ()
    ) -> str | None:
        """Take an operator's message; return why it was refused, or None.

        Joints that belong to others are passed over; a message with anything wrong changes nothing.
        """
        wrong = wrong_command(names, velocities, positions, self._by_speed)
        if wrong:
            return wrong
        mode, values = (POSITION, positions) if len(positions) else (VELOCITY, velocities)
        own = {
            self._index[name]: (mode, float(value))
            for name, value in zip(names, values, strict=True)
            if name in self._index
        }
        if own:
            self._tip = None
        self._said.update(own)
        return None

    def say_tip(self, frame: str, velocity: Sequence[float]) -> str | None:
        """Take an operator's word for the tip [m/s]; return why it was refused, or None.

        It is a word to all joints at once, and ends their last; once it has run out they stand.
        """
        if frame not in TIP_FRAMES:
            return f"its frame is {frame!r}, expected {' or '.join(TIP_FRAMES)}"
        if not np.isfinite(velocity).all():
            return f"the velocity is {list(velocity)}, expected finite numbers"
        self._said = dict.fromkeys(self._index.values(), (VELOCITY, 0.0))
        self._tip, self._tip_until = (frame, np.array(velocity, dtype=np.float64)), None
        return None

    def at(self, time_ns: int) -> tuple[Ints, Array]:
        """Return modes (n,) and commands (n,) for the step that starts at this time, see `crane_reference`."""
        mode = np.full(len(self._index), VELOCITY, dtype=np.int64)
        out = np.zeros(len(self._index))
        for start, end, index, order in self._moves:
            if start <= time_ns < end:
                mode[index], out[index] = order
        for index, order in self._said.items():
            mode[index], out[index] = order
        return mode, out

    def tip_at(self, time_ns: int) -> tuple[str, Array] | None:
        """Return frame and velocity (3,) wanted of the tip in the step that starts at this time, if any [m/s]."""
        if self._tip is None:
            return None
        if self._tip_until is None:
            self._tip_until = time_ns + self._timeout_ns
        if time_ns >= self._tip_until:
            self._tip = None
        return self._tip


def order_of(move: OperationConfig) -> tuple[int, float]:
    """Return mode and value of an operation, which has just one of its four values."""
    for mode, values in (
        (VELOCITY, (move.velocity_rad_s, move.velocity_m_s)),
        (POSITION, (move.position_rad, move.position_m)),
    ):
        for value in values:
            if value is not None:
                return mode, float(value)
    raise ValueError(f"the operation {move.label!r} has neither velocity nor position; expected one")


def applied(mode: Ints, command: Array, places: Array) -> Array:
    """Return what joints were told as positions (n,) and velocities (n,) in one array.

    A joint told a velocity has its own place as position, one told a position the velocity zero.
    """
    by_position = mode == POSITION
    return np.concatenate((np.where(by_position, command, places), np.where(by_position, 0.0, command)))

"""Joint commands: the scenario's operations, and what an operator says over them."""

from collections.abc import Sequence

import numpy as np

from shipcrane_twin.config.scenario import OperationConfig
from shipcrane_twin.cosim.time import NS_PER_S
from shipcrane_twin.physics.arrays import Array


class JointCommands:
    """Velocity commands of some joints: an operator's word counts until the next one, else the operations.

    Parameters
    ----------
    joints : sequence of str
        The joints served, in the order of the command array.
    operations : sequence of OperationConfig
        Timed velocities; those of other joints are left out.
    """

    def __init__(self, joints: Sequence[str], operations: Sequence[OperationConfig]) -> None:
        self._index = {name: i for i, name in enumerate(joints)}
        self._moves = [
            (
                round(move.from_s * NS_PER_S),
                round(move.to_s * NS_PER_S),
                self._index[move.joint],
                float(move.velocity_m_s if move.velocity_rad_s is None else move.velocity_rad_s),  # type: ignore[arg-type]
            )
            for move in operations
            if move.joint in self._index
        ]
        self._said: dict[int, float] = {}

    def say(self, names: Sequence[str], velocities: Sequence[float]) -> str | None:
        """Take an operator's message; return why it was refused, or None.

        Joints that belong to others are passed over; a message with anything wrong changes nothing.
        """
        if len(names) != len(velocities):
            return f"{len(names)} names but {len(velocities)} velocities; expected one velocity per name"
        if not np.isfinite(velocities).all():
            return f"velocities {list(velocities)}; expected finite numbers"
        self._said.update(
            {self._index[name]: float(v) for name, v in zip(names, velocities, strict=True) if name in self._index}
        )
        return None

    def at(self, time_ns: int) -> Array:
        """Return the velocities for the step that starts at this time [rad/s, m/s]."""
        out = np.zeros(len(self._index))
        for start, end, index, velocity in self._moves:
            if start <= time_ns < end:
                out[index] = velocity
        for index, velocity in self._said.items():
            out[index] = velocity
        return out

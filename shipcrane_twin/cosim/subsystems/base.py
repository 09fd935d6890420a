"""What every subsystem offers."""

from collections.abc import Mapping
from typing import Protocol

from shipcrane_twin.physics.arrays import Array

Signals = Mapping[str, Array]
"""Topic name to flat array, in the layout of `cosim.topics`."""


class Subsystem(Protocol):
    """One part of the twin.

    Attributes
    ----------
    name : str
        As in `cosim.coupling.CHAIN`.
    """

    name: str

    def start(self) -> Signals:
        """Return all outputs at t = 0."""

    def step(self, k: int, inputs: Signals) -> Signals:
        """Compute macro step k, from t_k-1 to t_k, and return the outputs at t_k.

        Telemetry is among them when it is due at t_k.
        """

"""A subsystem under way: it counts its steps and keeps the digest of all it has published."""

import hashlib
import struct

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim.subsystems import Signals, make_subsystem


class Participant:
    """A subsystem with its step count and digest; what both the inline runner and a node step.

    Parameters
    ----------
    name : str
        Subsystem of the chain.
    scenario : Scenario
    """

    def __init__(self, name: str, scenario: Scenario) -> None:
        self.name = name
        self.subsystem = make_subsystem(name, scenario)
        self.step = -1
        self._hash = hashlib.sha256()

    def advance(self, inputs: Signals) -> Signals:
        """Compute the next step (the first call gives t = 0 and needs no inputs) and return its outputs."""
        self.step += 1
        out = self.subsystem.step(self.step, inputs) if self.step else self.subsystem.start()
        self._hash.update(struct.pack("<q", self.step))
        for values in out.values():
            self._hash.update(values.tobytes())
        return out

    @property
    def digest(self) -> str:
        """sha256 over step numbers and values of all outputs so far, hexadecimal."""
        return self._hash.hexdigest()


def state_digest(digests: dict[str, str]) -> str:
    """Return one sha256 over the digests of all participants, by name, whatever their order."""
    text = "\n".join(f"{name} {digests[name]}" for name in sorted(digests))
    return hashlib.sha256(text.encode()).hexdigest()

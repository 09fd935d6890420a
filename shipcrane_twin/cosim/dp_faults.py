"""What is broken of thrusters, sensors and power."""

from collections.abc import Sequence

import numpy as np

from shipcrane_twin.config.scenario import THRUSTER_FAULTS, EventConfig
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.propulsion import FAILED, FROZEN, LIMITED, OK, RUNAWAY

CODES = dict(zip(THRUSTER_FAULTS, (OK, FAILED, FROZEN, LIMITED, RUNAWAY), strict=True))
LOST_TO_DP = (FAILED, FROZEN, RUNAWAY)


class DpFaults:
    """Faults in force.

    Parameters
    ----------
    thrusters : sequence of str
        Names, in the order of the arrays.

    Attributes
    ----------
    thruster : int64, shape (n,)
        Codes of `physics.propulsion`.
    share : float64, shape (n,)
        What a limited thruster may give of its full thrust.
    power_share : float
        Of the total power.
    sensor : dict
        Fault by sensor; those that work are not in it.
    """

    def __init__(self, thrusters: Sequence[str]) -> None:
        self._names = list(thrusters)
        self.thruster = np.zeros(len(self._names), dtype=np.int64)
        self.share = np.ones(len(self._names))
        self.power_share = 1.0
        self.sensor: dict[str, str] = {}

    def happen(self, event: EventConfig) -> None:
        """Put a fault in force; it is one that `config.scenario.wrong_keys` has nothing against."""
        share = 1.0 if event.share is None else event.share
        if event.event == "power_limit":
            self.power_share = share
            return
        assert event.which is not None
        assert event.fault is not None
        if event.event == "thruster_fault":
            i = self._names.index(event.which)
            self.thruster[i], self.share[i] = CODES[event.fault], share
        elif event.fault == "none":
            self.sensor.pop(event.which, None)
        else:
            self.sensor[event.which] = event.fault

    @property
    def available(self) -> Array:
        """Share of its full thrust that each thruster (n,) has for DP."""
        lost = np.isin(self.thruster, LOST_TO_DP)
        share: Array = np.where(lost, 0.0, np.where(self.thruster == LIMITED, self.share, 1.0))
        return share

    @property
    def stopped(self) -> tuple[str, ...]:
        """Names of the thrusters whose propellers do not turn."""
        return tuple(name for name, code in zip(self._names, self.thruster, strict=True) if code == FAILED)

    def told(self) -> list[str]:
        """Return what is broken, for people."""
        names = {code: name for name, code in CODES.items()}
        said = []
        for name, code, share in zip(self._names, self.thruster, self.share, strict=True):
            if code != OK:
                left = f" to {100 * share:.0f} %" if code == LIMITED else ""
                said.append(f"thruster {name}: {names[int(code)]}{left}")
        said += [f"sensor {name}: {fault.replace('_', ' ')}" for name, fault in self.sensor.items()]
        if self.power_share < 1.0:
            said.append(f"power limited to {100 * self.power_share:.0f} %")
        return said

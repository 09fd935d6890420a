"""Ends a node on SIGINT and SIGTERM: at once while it starts, in order once it has something to finish."""

import os
import signal
from types import FrameType

from shipcrane_twin.ros.shared_memory import remove_own


class StopFlag:
    """Becomes true on SIGINT or SIGTERM.

    Until `arm` is called the signal ends the process at once: imports and compilation take seconds in
    which nothing would look at the flag, and all that may have been opened is shared memory.
    """

    def __init__(self) -> None:
        self.raised = False
        self._armed = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._raise)

    def arm(self) -> None:
        """From now on only raise the flag; the node looks at it and ends in order."""
        self._armed = True

    def _raise(self, number: int, frame: FrameType | None) -> None:
        self.raised = True
        if not self._armed:
            remove_own()
            os._exit(0)

    def __bool__(self) -> bool:
        """Whether the node should end."""
        return self.raised

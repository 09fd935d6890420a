"""One executable per module: thin shells around `ros`.

Signals are taken care of here, before the modules' own imports, which take a second.
"""

from shipcrane_twin.ros.stop import StopFlag

STOP = StopFlag()

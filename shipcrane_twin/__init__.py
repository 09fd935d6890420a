"""Digital twin of a ship, its deck crane and the load on the hook, as a graph of ROS 2 nodes."""

from shipcrane_twin.kernel_cache import use_kernel_cache

__version__ = "0.1.0"

use_kernel_cache()

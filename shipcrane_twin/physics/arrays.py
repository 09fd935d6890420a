"""The array types of the kernels."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""A float64 array; each docstring gives its shape."""

Ints = NDArray[np.int64]
"""An int64 array; each docstring gives its shape."""

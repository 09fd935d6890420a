"""The one array type of the kernels."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""A float64 array; each docstring gives its shape."""

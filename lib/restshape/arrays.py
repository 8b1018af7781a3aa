"""Arrays by what they hold, for annotations."""

import numpy as np
import numpy.typing as npt

Reals = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int32]
"""Of nodes, edges or cells, as kernels take them."""
Integers = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]
Complexes = npt.NDArray[np.complex128]
Flags = npt.NDArray[np.bool_]
Records = npt.NDArray[np.void]
"""Rows with named columns."""
AnyArray = npt.NDArray[np.generic]
"""Where the kind of values does not matter."""

"""Arrays by what they hold, for annotations; without numpy's module of types, whose import takes long."""

from typing import Any

import numpy as np

Reals = np.ndarray[Any, np.dtype[np.float64]]
Indices = np.ndarray[Any, np.dtype[np.int32]]
"""Of nodes, edges or cells, as kernels take them."""
Integers = np.ndarray[Any, np.dtype[np.int64]]
Bytes = np.ndarray[Any, np.dtype[np.uint8]]
Complexes = np.ndarray[Any, np.dtype[np.complex128]]
Flags = np.ndarray[Any, np.dtype[np.bool_]]
Records = np.ndarray[Any, np.dtype[np.void]]
"""Rows with named columns."""
AnyArray = np.ndarray[Any, np.dtype[np.generic]]
"""Where the kind of values does not matter."""

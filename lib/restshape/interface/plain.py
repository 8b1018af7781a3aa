"""What a program gives, as the plain values that files hold: numbers, texts, lists and tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path

import numpy as np

from restshape.errors import UserError, quoted


def plain(value: object, where: str = "") -> object:
    """A copy of a value as JSON and TOML know it: arrays and tuples become lists, paths texts.

    Args:
        value: a number, a text, None, or tables, sequences and NumPy arrays of such.
        where: its place, for messages.

    Raises:
        UserError: it is of another kind, or a number is not finite.
    """
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, float):
        if not isfinite(value):
            raise UserError(f"{value} is not a finite number", where, "give a finite number")
        return float(value)
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist(), where)
    if isinstance(value, Mapping):
        return {str(key): plain(one, f"{where}.{key}" if where else str(key)) for key, one in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, bytes):
        return [plain(one, where) for one in value]
    if isinstance(value, Path):
        return str(value)
    what = f"{quoted(repr(value))} is no number, text, list or table"
    raise UserError(what, where, "give a plain Python value, or a NumPy array")

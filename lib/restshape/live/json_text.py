"""Messages of the simulating process as JSON, made by compiled code: a frame has little time for its header."""

from __future__ import annotations

from collections.abc import Mapping
from json.encoder import encode_basestring_ascii

import numpy as np
from pydantic_core import to_json

json_text = encode_basestring_ascii
"""The JSON of a text."""


def json_bytes(message: Mapping[str, object]) -> bytes:
    """The text of a message in UTF-8; numbers that are not finite become null, for JSON has none."""
    return to_json(message, inf_nan_mode="null", fallback=_plain)


def _plain(value: object) -> object:
    """A number of NumPy as Python has it."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} is no value of JSON")

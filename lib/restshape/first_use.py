"""What the first solve makes."""

from typing import TypeVar

T = TypeVar("T")


def made(part: T | None) -> T:
    """What the first solve makes, once it has been made.

    Raises:
        RuntimeError: nothing has been solved yet.
    """
    if part is None:
        raise RuntimeError("nothing has been solved yet")
    return part

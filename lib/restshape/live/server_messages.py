"""What a page may say, as far as the server reads it: the simulating process validates what a message holds."""

from __future__ import annotations

import json
from typing import Any, NoReturn

Table = dict[str, Any]

MOST_BYTES = 1 << 20
"""Of a message; a page that says more is disconnected."""
LARGEST_ID = 2**53
PASSED_ON = ("event", "show", "rates", "strike", "play", "pause", "seek", "take", "record", "save", "run")
"""Messages for the simulating process."""
OWN = ("cancel", "restart", "hand", "shown")
"""Messages for the server."""


class BadMessage(ValueError):
    """A message that is answered and ignored.

    Args:
        what: is wrong.
        number: of the message; 0 where it has none.
    """

    def __init__(self, what: str, number: int = 0) -> None:
        self.what, self.number = what, number
        super().__init__(what)


def checked(text: str) -> Table:
    """A message of a page: an object with a number and a type that there is.

    Raises:
        BadMessage: it is none.
    """
    try:
        message = json.loads(text, parse_constant=_refuse)
    except (ValueError, RecursionError) as error:
        raise BadMessage("this is not JSON") from error
    if not isinstance(message, dict):
        raise BadMessage("a message is an object")
    number, kind, shown = message.get("id"), message.get("type"), message.get("shown", 0)
    if type(number) is not int or not 0 < number < LARGEST_ID:
        raise BadMessage("a message has a number `id`")
    if type(shown) is not int or not 0 <= shown < LARGEST_ID:
        raise BadMessage("`shown` is a number of frames", number)
    if kind not in PASSED_ON and kind not in OWN:
        raise BadMessage("there is no message of this type", number)
    return message


def refused(number: int, message: str, todo: str = "", place: str = "") -> Table:
    """The answer to a message that is ignored."""
    return {"type": "refused", "id": number, "message": message, "place": place, "todo": todo}


def _refuse(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number of JSON")

"""Titles that fit their figure: scenes may have titles of any length."""

from matplotlib.textpath import TextPath

POINTS = 72.0
"""An inch."""
MARGIN = 0.2
"""Beside a title, of both sides together [inch]."""
SIZE = 11.0
"""Of titles [points], as `style` has it."""


def fits(words: str, inches: float, size: float = SIZE) -> bool:
    """Whether a line of letters of a size [points] fits a figure so wide [inch]."""
    return not words or TextPath((0.0, 0.0), words, size=size).get_extents().width <= POINTS * (inches - MARGIN)


def fitted(title: str, inches: float, rest: str = "", size: float = SIZE) -> str:
    """A title cut at a word, with what else its line says, so that both fit a figure.

    Args:
        title: of a scene; its first word stays, however long it is.
        inches: width of the figure.
        rest: of the line, which is kept whole.
        size: of the letters [points].
    """
    if fits(title + rest, inches, size):
        return title + rest
    words = title.split()
    kept = next((n for n in range(len(words) - 1, 0, -1) if fits(" ".join(words[:n]) + " …" + rest, inches, size)), 1)
    return " ".join(words[:kept]) + " …" + rest

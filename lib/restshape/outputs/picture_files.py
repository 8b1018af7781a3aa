"""Pictures: whole or not at all, over no others, and with the hash of the data that they show."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from restshape import __version__
from restshape.outputs.atomic_files import replacing
from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import PICTURE_MARK, PictureFile

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MARKED_BY = {".png": "Software", ".svg": "Creator"}
"""Which of the metadata of a format says who drew it."""

STAMP = "stamp"
"""Key of a JSON file of results that says of which code it is."""

PACKED = 3
"""Effort of zlib for a PNG: smooth colours come out as small as with 6, its own choice, in half the time."""

SOURCE = "Source"
"""Key of a picture's metadata, in PNG and in SVG."""
_source: ContextVar[str] = ContextVar("source", default="")
_count: ContextVar[Callable[[int], None] | None] = ContextVar("count", default=None)


def fingerprint(data: object) -> str:
    """The hash of what a JSON file holds, however it is laid out, but for a stamp that says when it was made."""
    # Keys that are numbers become texts before they are sorted.
    plain = json.loads(json.dumps(data))
    if isinstance(plain, dict):
        plain.pop(STAMP, None)
    return f"sha256:{sha256(json.dumps(plain, sort_keys=True, separators=(',', ':')).encode()).hexdigest()}"


@contextmanager
def counting(count: Callable[[int], None]) -> Iterator[None]:
    """Has each picture that is saved inside it, and each frame of an animation, counted.

    Args:
        count: is given 1 after each.
    """
    before = _count.set(count)
    try:
        yield
    finally:
        _count.reset(before)


def count_picture() -> None:
    """One more picture, or frame of an animation, is done."""
    if (count := _count.get()) is not None:
        count(1)


@contextmanager
def drawn_from(source: str) -> Iterator[None]:
    """Has pictures that are saved inside it say what they show.

    Args:
        source: such as `fingerprint` gives it.
    """
    before = _source.set(source)
    try:
        yield
    finally:
        _source.reset(before)


def save_picture(figure: Figure, path: Path) -> None:
    """Writes a figure, in the format that the path's suffix names.

    Raises:
        UserError: a file is there that restshape has not drawn.
        OSError: it cannot be written.
    """
    refuse_foreign(PictureFile(path), str(path))
    _show_powers(figure)
    with replacing(path) as part:
        write_figure(figure, part, _metadata(path.suffix.lower()))
    count_picture()


def save_pages(figures: Iterable[Figure], path: Path, metadata: Mapping[str, str | None]) -> None:
    """Writes a PDF, a page a figure, which are made one by one; metadata as of `PdfPages`.

    Raises:
        OSError: it cannot be written.
    """
    from matplotlib.backends.backend_pdf import PdfPages

    with replacing(path) as part, PdfPages(part, metadata=dict(metadata)) as pages:
        for figure in figures:
            pages.savefig(figure)


def write_figure(figure: Figure, path: Path, metadata: dict[str, str] | None) -> None:
    """Writes a figure with its metadata, in the format that the path's suffix names."""
    if path.suffix.lower() == ".png":
        # `savefig` would go through all of it once more, to make the layout that drawing makes too.
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        FigureCanvasAgg(figure).print_png(path, metadata=metadata, pil_kwargs={"compress_level": PACKED})
    else:
        figure.savefig(path, metadata=metadata)


def _metadata(suffix: str) -> dict[str, str] | None:
    """What a picture of a format says of itself: who drew it, and what it shows."""
    key = MARKED_BY.get(suffix)
    known = {SOURCE: _source.get()} if _source.get() else {}
    return known | ({key: f"{PICTURE_MARK} {__version__}"} if key else {}) or None


def _show_powers(figure: Figure) -> None:
    """Has the ticks of logarithmic axes drawn as powers of ten; the house's style draws texts as they are."""
    from matplotlib.text import Text

    for axis in [axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) if axis.get_scale() == "log"]:
        for text in axis.findobj(Text):
            text.set_parse_math(text is not axis.label)

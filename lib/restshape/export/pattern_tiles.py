"""A pattern in true size as a PDF: sheets of paper to print, to lay over each other and to glue."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from restshape.arrays import Reals
from restshape.export.paper_tiles import EDGE, OVERLAP, PAPERS, Tile, TileGrid
from restshape.export.pattern_sheet import INK, NAMES, PatternSheet, SheetLine, pattern_sheet
from restshape.outputs.kinds import PATTERN_MARK
from restshape.outputs.picture_files import save_pages
from restshape.shape.patterns.pattern import Pattern
from restshape.shape.patterns.seam_parts import seam_names

INCH = 25.4
SQUARE = 100.0
"""Side of the square that shows whether a printer keeps the scale [mm]."""
CROSS = 4.0
"""Half the length of the lines of a registration mark [mm]."""
FOOT = 6.0
"""Height of the line of text below what is printed [mm]."""
FAINT = "#9a9a9a"
LISTED = 5.0
"""Room for a line of the list of seams [mm]."""
LETTER = 1.4
"""Width of its letters [mm]."""
NAMED = 4.5
"""Distance of a piece's name from a sheet's on the map [mm]."""
STYLE = {"path.simplify": False, "pdf.fonttype": 42, "text.parse_math": False, "text.usetex": False}


class _Page:
    """A page whose axes are in millimetres from its lower left corner; what is drawn is cut off at the border.

    Args:
        paper: key of `PAPERS`.
    """

    def __init__(self, paper: str) -> None:
        self.size = np.array(PAPERS[paper])
        self.figure = Figure(figsize=tuple(self.size / INCH))
        self.axes = self.figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self.axes.set(xlim=(0.0, self.size[0]), ylim=(0.0, self.size[1]))
        self.axes.set_axis_off()

    def lines(self, lines: list[SheetLine], shift: Reals, scale: float = 1.0) -> None:
        """Draws lines, first scaled, then moved by a shift (2,) [mm]."""
        inside = Rectangle((EDGE, EDGE), *(self.size - 2.0 * EDGE), transform=self.axes.transData)
        for line in lines:
            drawn = LineCollection(
                [scale * line.points + shift],
                colors=line.colour,
                linewidths=line.width * min(1.0, scale**0.5),
                linestyles=[(0, line.dashes)] if line.dashes and scale == 1.0 else "solid",
            )
            self.axes.add_collection(drawn, autolim=False)
            drawn.set_clip_path(inside)

    def text(self, place: Reals, text: str, size: float, **look: object) -> None:
        """Writes a text about a place (2,) [mm]."""
        self.axes.text(*place, text, fontsize=size, **{"ha": "center", "va": "center", "color": INK, **look})


def write_tiles(pattern: Pattern, path: Path, paper: str, allowance: float, title: str) -> int:
    """Writes a PDF: a page with a map of all sheets, the seams and a test square, then a page a sheet; how many sheets.

    Sheets overlap by `OVERLAP`. Crosses at their corners lie over those of the sheets beside them.

    Args:
        pattern: to draw; path: of the file; paper: key of `PAPERS`; allowance: [m], or 0; title: of the pages.

    Raises:
        UserError: an allowance cannot be made, or there are too many sheets.
        OSError: it cannot be written.
    """
    sheet = pattern_sheet(pattern, allowance)
    low, high = sheet.box
    grid = TileGrid(paper, low, high)
    tiles = grid.tiles([line.points for line in sheet.lines])
    about = {"Creator": PATTERN_MARK, "Title": title, "CreationDate": None}
    with matplotlib.rc_context(STYLE):
        save_pages(_figures(sheet, grid, tiles, pattern, title), path, about)
    return len(tiles)


def _figures(sheet: PatternSheet, grid: TileGrid, tiles: list[Tile], pattern: Pattern, title: str) -> Iterator[Figure]:
    """The pages in their order: the map, then the sheets."""
    yield _map(sheet, grid, tiles, pattern, f"{title}: {len(tiles)} sheets, {grid.paper}").figure
    for number, tile in enumerate(tiles, 1):
        beside = [("right", Tile(tile.row, tile.column + 1)), ("above", Tile(tile.row + 1, tile.column))]
        there = [f"{where}: {other.name}" for where, other in beside if other in tiles]
        foot = "; ".join([*filter(None, [", ".join(there)]), f"overlap {OVERLAP:g} mm"])
        yield _sheet_page(sheet, grid, tile, f"{title}   {number} of {len(tiles)}", foot).figure


def _sheet_page(sheet: PatternSheet, grid: TileGrid, tile: Tile, title: str, foot: str) -> _Page:
    """The page of a sheet, with a title and what lies beside it at its foot."""
    page = _Page(grid.paper)
    corner = grid.corner(tile)
    shift = EDGE - corner
    near = [line for line in sheet.lines if _near(line.points, corner, corner + grid.printed)]
    page.lines([*near, *_registration(corner, grid.step)], shift)
    # Sheets above and to the right lie over what is beyond these lines.
    (x, y), far = grid.step, grid.printed
    overlap = [np.array([[x, 0.0], [x, far[1]]]), np.array([[0.0, y], [far[0], y]])]
    page.lines([SheetLine(line + corner, 0.4, FAINT, (6.0, 4.0)) for line in overlap], shift)
    for text in sheet.texts:
        if _near(text.place[None], corner, corner + grid.printed):
            look = {"rotation": np.degrees(text.angle), "rotation_mode": "anchor", "color": text.colour}
            page.text(text.place + shift, text.text, text.size, **look)
    page.text(np.array([EDGE, FOOT]), f"{title}   sheet {tile.name}", 8.0, ha="left")
    page.text(np.array([page.size[0] - EDGE, FOOT]), foot, 8.0, ha="right")
    return page


def _near(points: Reals, low: Reals, high: Reals) -> bool:
    return bool((points.max(axis=0) >= low).all() and (points.min(axis=0) <= high).all())


def _registration(corner: Reals, step: Reals) -> list[SheetLine]:
    """Crosses in the middle of the overlaps at the corners of a sheet, where those of the sheets beside it lie, too."""
    found = []
    for x, y in ((0, 0), (1, 0), (0, 1), (1, 1)):
        place = corner + 0.5 * OVERLAP + step * (x, y)
        found += [SheetLine(np.array([place - way, place + way]), 0.6) for way in ((CROSS, 0.0), (0.0, CROSS))]
    return found


def _map(sheet: PatternSheet, grid: TileGrid, tiles: list[Tile], pattern: Pattern, title: str) -> _Page:
    """The first page: where each sheet belongs, which seams there are, and a square to measure."""
    page = _Page(grid.paper)
    width, height = page.size.tolist()
    page.text(np.array([EDGE, height - EDGE - 3.0]), title, 12.0, ha="left")
    rows, columns = grid.count
    reach = grid.step * (columns, rows) + OVERLAP
    room = np.array([width - 2.0 * EDGE, height - 2.0 * EDGE - SQUARE - 25.0])
    scale = float((room / reach).min())
    shift = np.array([EDGE, height - EDGE - 10.0]) - scale * np.array([grid.low[0], grid.low[1] + reach[1]])
    frames = [grid.corner(tile) + grid.printed * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) for tile in tiles]
    page.lines([SheetLine(frame, 0.5, FAINT) for frame in frames] + sheet.lines, shift, scale)
    _name_on_map(page, sheet, {tile.name: grid.corner(tile) + 0.5 * grid.printed for tile in tiles}, shift, scale)
    corner = np.array([EDGE + 1.0, EDGE + 1.0])
    page.lines([SheetLine(SQUARE * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]), 0.8)], corner)
    words = f"{SQUARE:g} × {SQUARE:g} mm\nPrint at 100 %, without fitting to the page."
    page.text(corner + 0.5 * SQUARE, words, 9.0)
    lines = [
        (f"{name}: {', '.join(stitch.first)} – {', '.join(stitch.second)}", sheet.seams[name])
        for name, stitch in zip(seam_names(pattern), pattern.stitches)
    ]
    most = int(SQUARE / LISTED)
    more = [(f"and {len(lines) - most + 1} more", INK)] if len(lines) > most else []
    for k, (words, colour) in enumerate([*lines[: most - len(more)], *more]):
        fits = int((width - EDGE - SQUARE - 16.0) / LETTER)
        words = words if len(words) <= fits else f"{words[: fits - 1]}…"
        place = corner + np.array([SQUARE + 4.0, SQUARE - LISTED * (k + 0.5)])
        page.text(place, words, 7.0, ha="left", color=colour)
    return page


def _name_on_map(page: _Page, sheet: PatternSheet, tiles: Mapping[str, Reals], shift: Reals, scale: float) -> None:
    """Writes the names of sheets at their middles (2,) [mm], and those of pieces, below a sheet's that is near."""
    middles = {name: scale * place + shift for name, place in tiles.items()}
    for name, place in middles.items():
        page.text(place, name, 9.0, color=FAINT)
    for piece in (text for text in sheet.texts if text.size == NAMES):
        place = scale * piece.place + shift
        nearest = min(middles.values(), key=lambda middle: float(np.hypot(*(middle - place))))
        near = (np.abs(nearest - place) < (NAMED * len(piece.text), NAMED)).all()
        page.text(np.array([place[0], nearest[1] - NAMED]) if near else place, piece.text, 9.0)

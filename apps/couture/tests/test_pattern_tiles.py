"""Sheets of paper with a pattern: sizes are read back from the PDF, in points of 1/72 inch."""

import re
import zlib
from itertools import pairwise

import numpy as np
import pytest
from patterns_drawn import written

from restshape.cli.main import main
from restshape.export.paper_tiles import EDGE, OVERLAP, PAPERS, Tile, TileGrid
from restshape.export.pattern_sheet import pattern_sheet
from restshape.shape.patterns.garmentcode import read_garmentcode

MM = 72.0 / 25.4
OPTIONS = ["--tiles", "a4", "--allowance", "10mm"]
STRIP = {
    "pattern": {
        "panels": {
            "strip": {
                "vertices": [[0, 0], [25, 0], [25, 10], [0, 10]],
                "edges": [{"endpoints": [k, (k + 1) % 4]} for k in range(4)],
            }
        },
        "stitches": [[{"panel": "strip", "edge": 1}, {"panel": "strip", "edge": 3}]],
    },
    "properties": {"units_in_meter": 100},
}
NUMBER = rb"(-?[\d.]+)"


def pages_of(path) -> list[bytes]:
    """What is drawn on each page of a PDF that matplotlib wrote."""
    streams = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", path.read_bytes(), re.DOTALL)
    texts = []
    for stream in streams:
        try:
            texts.append(zlib.decompress(stream))
        except zlib.error:
            continue
    return [text for text in texts if b" l\n" in text and b"BT" in text]


def chains_of(page: bytes) -> list[np.ndarray]:
    """The open or closed lines (m, 2) of a page [mm]."""
    found: list[list[tuple[float, float]]] = []
    for x, y, kind in re.findall(NUMBER + b" " + NUMBER + rb" ([ml])\n", page):
        if kind == b"m":
            found.append([])
        found[-1].append((float(x) / MM, float(y) / MM))
    return [np.array(chain) for chain in found]


@pytest.fixture(scope="module")
def tiles(tmp_path_factory):
    """The sheets of a strip of 250 mm by 100 mm on A4 with an allowance of 10 mm."""
    folder = tmp_path_factory.mktemp("tiles")
    out = folder / "strip.pdf"
    assert main(["pattern", str(written(folder, STRIP)), *OPTIONS, "--out", str(out)]) == 0
    return out


def test_pages_have_the_size_of_the_paper(tiles):
    boxes = re.findall(rb"/MediaBox \[ 0 0 " + NUMBER + b" " + NUMBER + rb" \]", tiles.read_bytes())
    assert len(boxes) == len(pages_of(tiles)) == 3
    for box in boxes:
        assert [float(x) / MM for x in box] == pytest.approx(PAPERS["a4"], abs=1e-6)


def test_the_square_to_measure_has_100_mm(tiles):
    squares = [one for one in chains_of(pages_of(tiles)[0]) if len(one) == 5 and np.ptp(one, axis=0)[0] > 90.0]
    assert any(np.ptp(one, axis=0) == pytest.approx([100.0, 100.0], abs=1e-6) for one in squares)


def test_lines_on_sheets_are_those_of_the_pattern_at_scale(tiles):
    """The sewn ends, of 100 mm, each on one sheet with both of its notches, of 10 mm; the cut line is 270 mm long."""
    pages = [chains_of(page) for page in pages_of(tiles)[1:]]
    upright = [one for page in pages for one in page if len(one) == 2 and np.ptp(one, axis=0)[0] < 1e-6]
    assert sum(np.ptp(one, axis=0)[1] == pytest.approx(100.0, abs=1e-6) for one in upright) == 2
    level = [one for page in pages for one in page if len(one) == 2 and np.ptp(one, axis=0)[1] < 1e-6]
    assert sum(np.ptp(one, axis=0)[0] == pytest.approx(10.0, abs=1e-6) for one in level) >= 4
    left, right = (max((one for one in page if len(one) > 20), key=len) for page in pages)
    # Both sheets have the whole of it, or what of it lies on the paper; they are 180 mm apart.
    assert right[:, 0].max() - left[:, 0].min() + 180.0 == pytest.approx(270.0, abs=1e-6)
    assert np.ptp(left[:, 1]) == pytest.approx(120.0, abs=1e-3)


def test_marks_of_sheets_beside_each_other_lie_over_each_other():
    grid = TileGrid("a4", np.zeros(2), np.array([700.0, 900.0]))
    assert grid.count == (4, 4)
    here, right, above = (grid.corner(Tile(*place)) for place in ((0, 0), (0, 1), (1, 0)))
    assert right - here == pytest.approx((210.0 - 2 * EDGE - OVERLAP, 0.0))
    assert above - here == pytest.approx((0.0, 297.0 - 2 * EDGE - OVERLAP))


def test_empty_sheets_are_left_out():
    grid = TileGrid("a4", np.zeros(2), np.array([700.0, 900.0]))
    diagonal = [np.array([[0.0, 0.0], [700.0, 900.0]])]
    names = [tile.name for tile in grid.tiles(diagonal)]
    assert "A1" in names and "D4" in names and "A4" not in names and "D1" not in names
    for tile in grid.tiles(diagonal):
        t = np.linspace(0.0, 1.0, 2001)[:, None] * (700.0, 900.0) - grid.corner(tile)
        assert ((t >= 0.0) & (t <= grid.printed)).all(axis=1).any()


def test_the_sheet_has_the_edges_of_the_pieces_in_their_lengths(tmp_path):
    pattern = read_garmentcode(written(tmp_path))
    sheet = pattern_sheet(pattern, 0.0)
    drawn = [line.points for line in sheet.lines if line.width == 0.8]
    lengths = np.array([np.linalg.norm(np.diff(points, axis=0), axis=1).sum() for points in drawn])
    outlines = [piece.outline() for piece in pattern.pieces]
    own = sorted(1e3 * outline.length(e) for outline in outlines for e in range(len(outline.edges)))
    assert sorted(lengths[lengths > 6.5]) == pytest.approx(own, rel=1e-4), "all but the notches, of 6 mm"
    assert set(sheet.seams) == {"seam1", "seam2"}


def test_the_same_pattern_gives_the_same_file(tiles, tmp_path):
    """Which is written over its own, and over no other one."""
    source, first = written(tmp_path, STRIP), tiles.read_bytes()
    assert main(["pattern", str(source), *OPTIONS, "--out", str(tiles)]) == 0
    assert tiles.read_bytes() == first
    other = tmp_path / "other.pdf"
    other.write_bytes(b"%PDF-1.4\nof another program\n")
    assert main(["pattern", str(source), *OPTIONS, "--out", str(other)]) == 2


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--tiles", "a4", "--out", "a.svg"], "sheets of paper are a PDF"),
        (["--allowance", "1 kg", "--out", "a.pdf"], "--allowance"),
        (["--allowance", "10mm", "--out", "a.json"], "no cut lines"),
        (["--allowance", "30cm", "--out", "a.pdf"], "more than half the width"),
    ],
)
def test_bad_options_are_refused(tmp_path, capsys, options, message):
    assert main(["pattern", str(written(tmp_path)), *options[:-1], str(tmp_path / options[-1])]) == 2
    assert message in capsys.readouterr().err


def test_lengths_between_marks_are_those_of_the_grid(tiles):
    """Crosses on one sheet are one step apart."""
    lines = [one for one in chains_of(pages_of(tiles)[1]) if len(one) == 2]
    crosses = sorted({round(float(one[0, 0]), 6) for one in lines if np.ptp(one, axis=0) == pytest.approx([0.0, 8.0])})
    assert [b - a for a, b in pairwise(crosses)] == pytest.approx([180.0], abs=1e-5)

"""Seams in the picture of a scene before any solve: both sides in the colour of their line of the legend."""

import itertools

import pytest
from matplotlib.collections import LineCollection
from small_scenes import write_scene
from test_pattern_panels import HUNG, garment, panel

from restshape.cli.main import main
from restshape.report.seam_sides import COLOURS, WIDTH


@pytest.mark.parametrize("number", [1, 7])
def test_both_sides_of_each_seam_have_its_colour_and_dashes(tmp_path, monkeypatch, number):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    names = [f"p{k}" for k in range(number + 1)]
    panels = [panel(name, f"move = [0, {k}, 0]") for k, name in enumerate(names)]
    pairs = list(itertools.pairwise(names))
    seams = [f'[seams.{one}{two}]\nfrom = "{one}.right"\nto = "{two}.left"\n' for one, two in pairs]
    scene = write_scene(tmp_path, garment(*panels, *seams, HUNG.format(name="p0")))
    assert main(["check", str(scene), "--picture", str(tmp_path / "scene.png")]) == 0
    (axes,) = figures[0].axes
    drawn = [one for one in axes.collections if isinstance(one, LineCollection) and one.get_linewidth()[0] == WIDTH]
    # Two edges each, 150 mm long.
    assert [len(one.get_segments()) for one in drawn] == [2] * number
    looks = [(tuple(one.get_edgecolor()[0]), str(one.get_linestyle())) for one in drawn]
    assert len({*looks}) == number and number <= len(COLOURS) + 1
    words = [text.get_text() for text in figures[0].texts]
    assert all(f"seam {one}{two}: {one}.right to {two}.left" in words for one, two in pairs)
    # On panels, whose names are written on them, names stand without these.
    written = [text.get_text() for text in axes.texts]
    assert {"p0", "p1", "top", "left"} <= {*written} and not any("." in name for name in written)

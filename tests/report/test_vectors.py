"""Line segments of a velocity over the colours of another field, views of a part, and frames by their numbers."""

from argparse import ArgumentParser

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image
from restshape_studies.stability.scenery import drag, write_scene, write_script

from restshape.cli.main import main
from restshape.cli.report_looks import add_looks, read_looks
from restshape.replay.recording.recording import Recording
from restshape.report.drawing import Drawing
from restshape.report.scenery import scenery
from restshape.report.vectors import COUNT, LONGEST, VectorSegments

STREAM = """format = "restshape-scene"
version = 1
app = "flow"
[shape]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = [2, 0], c = [2, 1], d = [0, 1] }
[shape.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[shape.holes.window]
circle = { center = [0.6, 0.5], radius = 0.2 }
[fluid]
rho = 1
mu = 1
[boundary.sides]
on = ["outline", "window"]
velocity = ["1.5*y", 0]
[effects]
flow = {}
[mesh]
size = 0.2
[quantities]
fastest = { speed = true }
"""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("vectors")
    out, script = folder / "out.vtkhdf", write_script(folder, drag("window", (0.6, 0.5), [(0.7, 0.5), (0.8, 0.5)]))
    assert main(["replay", str(write_scene(folder, STREAM)), "--edits", str(script), "--out", str(out)]) == 0
    return out


def test_segments_are_as_long_as_the_velocity_where_they_are(recorded):
    with Recording(recorded) as recording:
        common = scenery(recording, field="pressure")
        vectors = VectorSegments(recording, common, range(recording.n))
        lines = vectors.lines(0)
        middle, along = lines.mean(axis=1), np.diff(lines, axis=1)[:, 0]
        np.testing.assert_allclose(along[:, 0], vectors.stretch * 1.5 * middle[:, 1], atol=1e-6)
        np.testing.assert_allclose(along[:, 1], 0.0, atol=1e-6)
        # The longest one that is drawn has the length, not the fastest node; faster ones lie between the places.
        drawn = [np.diff(vectors.lines(i), axis=1)[:, 0] for i in range(recording.n)]
        longest = max(np.hypot(*lengths.T).max() for lengths in drawn)
        assert longest == pytest.approx(LONGEST * vectors.spacing, rel=1e-6) and vectors.largest < 1.49
        # They are over the whole shape but its hole, and none leaves the picture.
        xmin, xmax, ymin, ymax = common.extent
        assert (lines >= [xmin, ymin]).all() and (lines <= [xmax, ymax]).all()
        assert len(lines) == pytest.approx((2 - np.pi * 0.04) / vectors.spacing**2, rel=0.08)
        assert not (np.hypot(*(middle - (0.6, 0.5)).T) < 0.19).any()
        assert vectors.spacing == pytest.approx(2.08 / COUNT, rel=0.01)


def test_segments_on_dark_colours_are_white(recorded):
    """Fast fluid is yellow, slow fluid is dark."""
    with Recording(recorded) as recording:
        vectors = VectorSegments(recording, scenery(recording, field="speed"), [0])
        lines = vectors.lines(0)
        dark, height = vectors.on_dark(lines, 0), lines.mean(axis=1)[:, 1]
        assert dark[height < 0.3].all() and not dark[height > 0.8].any()


def test_one_segment_is_explained_with_its_unit(recorded):
    with Recording(recorded) as recording:
        vectors = VectorSegments(recording, scenery(recording, field="pressure"), [0])
    figure = Figure(figsize=(6, 4))
    vectors.explain(figure, 5.0, 0.4, 2.0)
    (words,) = figure.texts
    (line,) = (one for one in figure.get_children() if isinstance(one, Line2D))
    assert words.get_text() == "velocity\n2 m/s"
    assert np.ptp(line.get_xdata()) * 6.0 == pytest.approx(2.0 * vectors.stretch * 2.0)
    FigureCanvasAgg(figure).draw()
    box = words.get_window_extent()
    assert box.x1 <= figure.bbox.x1 and box.y0 >= 0.0


def test_marks_outside_of_a_view_are_not_drawn(recorded):
    """The fastest fluid is at the upper edge; rings are not cut at the axes."""
    with Recording(recorded) as recording:
        for view, shown in (((0.0, 2.0, 0.5, 1.0), 1), ((0.2, 1.0, 0.2, 0.8), 0)):
            common = scenery(recording, field="speed", view=view)
            assert common.extent == view
            drawing = Drawing(Figure().subplots(), common)
            drawing.show(recording, 0)
            rings = {str(ring.get_marker()): len(ring.get_xdata()) for ring in drawing.marks}
            assert rings["o"] == shown


def test_colours_have_the_values_of_the_frames_that_are_shown(recorded):
    with Recording(recorded) as recording:
        every, first = scenery(recording, field="pressure"), scenery(recording, field="pressure", frames=(0,))
        size = np.abs(recording.field(0, "pressure")).max()
        assert first.top <= size * (1 + 1e-9) and first.top <= every.top and first.bottom == -first.top


@pytest.mark.slow
def test_a_report_shows_the_frames_that_are_named(recorded, tmp_path):
    looks = ["--field", "pressure", "--show", "vectors", "--view=0.2,1.4,0.1,0.9", "--animation", "gif"]
    assert main(["report", str(recorded), "--at", "0,2", "--out", str(tmp_path), *looks]) == 0
    wide = Image.open(tmp_path / "frames.png").size
    assert main(["report", str(recorded), "--at", "2", "--out", str(tmp_path), *looks[:-1], "none"]) == 0
    assert Image.open(tmp_path / "frames.png").size != wide
    assert Image.open(tmp_path / "animation.gif").n_frames == Recording(recorded).n


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--at", "0,99"], "there is no frame 99"),
        (["--at", "last"], "numbers of frames are 0, 1"),
        (["--view", "0,1"], "a view is four numbers"),
        (["--view=1,0,0,1"], "a view is four numbers"),
    ],
)
def test_what_makes_no_sense_is_refused(recorded, tmp_path, capsys, words, message):
    assert main(["report", str(recorded), "--animation", "none", "--out", str(tmp_path), *words]) == 2
    assert message in capsys.readouterr().err


def test_a_recording_without_vectors_shows_none(tmp_path, capsys):
    from small_scenes import BLOCK, CLAMPED, HEAD, PULLED, STEEL, meshed
    from small_scenes import write_scene as write

    text = HEAD + BLOCK.format(width=2, height=1) + STEEL + CLAMPED + PULLED + meshed(0.5)
    out = tmp_path / "out.vtkhdf"
    assert main(["replay", str(write(tmp_path, text)), "--out", str(out)]) == 0
    assert main(["report", str(out), "--show", "vectors", "--out", str(tmp_path / "pictures")]) == 2
    assert "no field of vectors to show" in capsys.readouterr().err


def test_frames_by_their_numbers_are_of_shapes_in_the_plane():
    """Other reports choose their frames, and refuse what they would ignore."""
    parser = ArgumentParser()
    add_looks(parser)
    args = parser.parse_args(["--view=0,1,0,1"])
    assert read_looks(args).of_plane == ("--view",)
    args.at = (1, 2)
    assert read_looks(args).of_plane == ("--view", "--at")

"""Many lines in one path look like as many lines of their own."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection

from restshape.report.segments import MOST, Segments
from restshape.report.style import new_figure


def picture(collection):
    """The pixels (h, w, 4) of a collection in the unit square."""
    figure = new_figure(3.0, 3.0)
    figure.set_layout_engine("none")
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    axes.add_collection(collection, autolim=False)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba()).astype(int)


def test_they_look_as_a_collection_of_lines_does():
    lines = np.random.default_rng(3).random((60, 3, 2))
    segments = Segments(edgecolors="#222222", linewidths=0.6)
    segments.show(lines)
    pixels = picture(segments)
    assert (255 - pixels[:, :, 0]).mean() > 10.0
    # Lines that cross are drawn over each other there, and the edges of both are half transparent.
    assert np.abs(pixels - picture(LineCollection(lines, colors="#222222", linewidths=0.6))).mean() < 1.0


def test_a_mesh_is_few_paths_and_an_empty_one_none():
    segments = Segments(edgecolors="#222222")
    segments.show(np.zeros((2 * MOST + 1, 2, 2)))
    assert [len(path) for path in segments.get_paths()] == [2 * MOST, 2 * MOST, 2]
    segments.show(np.empty((0, 2, 2)))
    assert not segments.get_paths()

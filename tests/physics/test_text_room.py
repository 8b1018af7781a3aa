"""Names in pictures that do not lie over each other."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from restshape.physics.cloth.pictures.text_room import set_apart, set_apart_alike


@pytest.fixture
def axes():
    figure = Figure(figsize=(4, 3), dpi=100)
    FigureCanvasAgg(figure)
    return figure.add_axes((0, 0, 1, 1), xlim=(0, 4), ylim=(0, 3))


def boxes(texts):
    return [text.get_window_extent(texts[0].figure.canvas.get_renderer()) for text in texts]


def meet(texts):
    return [one.overlaps(other) for one, other in combinations(boxes(texts), 2)]


def test_names_that_are_clear_stay_as_they_are(axes):
    texts = [axes.text(x, 1.5, "back", fontsize=8, ha="center", va="center") for x in (0.5, 3.5)]
    set_apart_alike(texts)
    assert [text.get_position() for text in texts] == [(0.5, 1.5), (3.5, 1.5)]
    assert [text.get_fontsize() for text in texts] == [8, 8]


def test_names_of_narrow_panels_get_smaller_alike(axes):
    texts = [axes.text(x, 1.5, "sleeve_left", fontsize=8, ha="center", va="center") for x in (1.6, 2.1)]
    assert meet(texts) == [True]
    set_apart_alike(texts)
    assert meet(texts) == [False]
    assert texts[0].get_fontsize() == texts[1].get_fontsize() < 8


def test_names_go_along_their_ways_and_keep_clear_of_others(axes):
    panel = axes.text(2.0, 1.5, "front", fontsize=8, ha="center", va="center")
    seams = [axes.text(2.0, 1.5, "side", fontsize=8, ha="center", va="center", rotation=90) for _ in range(2)]
    set_apart(seams[:1], [np.array([0.0, 1.0])], [panel])
    assert meet([panel, seams[0]]) == [False] and seams[0].get_position()[0] == pytest.approx(2.0)
    place = seams[1].get_position()
    set_apart(seams[1:], [np.zeros(2)], [panel])
    # There is no room for it.
    assert seams[1].get_position() == place and seams[1].get_fontsize() == 8

"""Words in pictures keep clear of each other and of lines, and stay where they are if nothing is there."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text
from restshape_apps.furniture.report.labels import Labels

from restshape.report.style import new_figure


def placed(places, line=None):
    """Boxes of words at places, after drawing, and the axes."""
    figure = new_figure(4.0, 3.0)
    axes = figure.subplots()
    axes.set(xlim=(0, 1), ylim=(0, 1))
    labels = Labels(axes)
    words = []
    for place in places:
        look = {"arrowstyle": "-", "shrinkA": 0, "shrinkB": 0}
        word = axes.annotate(
            "4.43", place, xytext=(0, 0), textcoords="offset points", ha="center", arrowprops=look, zorder=9
        )
        labels.add(word)
        words.append(word)
    if line is not None:
        labels.spare(np.array(line))
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    return [Text.get_window_extent(word, renderer) for word in words], words, axes


def test_words_at_one_place_do_not_lie_on_each_other():
    boxes, words, _ = placed([(0.5, 0.5)] * 4)
    for i, one in enumerate(boxes):
        assert not any(one.overlaps(other) for other in boxes[:i])
    assert words[0].xyann == (0, 0)


def test_words_far_from_each_other_stay():
    assert [word.xyann for word in placed([(0.2, 0.2), (0.8, 0.8)])[1]] == [(0, 0)] * 2


def test_words_leave_a_line():
    (box,), (word,), axes = placed([(0.5, 0.5)], [(0.4, 0.53), (0.6, 0.53)])
    (left, level), (right, _) = axes.transData.transform([(0.4, 0.53), (0.6, 0.53)])
    assert word.xyann != (0, 0)
    assert box.y1 <= level or box.y0 >= level or box.x1 <= left or box.x0 >= right

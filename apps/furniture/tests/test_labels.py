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


def crowded(ranks):
    """Which of many words of these ranks at one place are drawn, their boxes, and what the picture says."""
    figure = new_figure(4.0, 3.0)
    axes = figure.subplots()
    axes.set(xlim=(0, 1), ylim=(0, 1))
    labels, words = Labels(axes), []
    for rank in ranks:
        word = axes.annotate("4.43", (0.5, 0.5), xytext=(0, 0), textcoords="offset points", ha="center")
        labels.add(word, rank=rank)
        words.append(word)
    canvas = FigureCanvasAgg(figure)
    for _ in range(2):
        canvas.draw()
    drawn = [k for k, word in enumerate(words) if word.get_visible()]
    renderer = canvas.get_renderer()
    said = [text.get_text() for text in axes.texts if text.get_text().startswith("no room")]
    return drawn, [Text.get_window_extent(words[k], renderer) for k in drawn], said


def test_words_without_room_are_left_out_by_rank_and_counted():
    ranks = [3] * 15 + [0, 1]
    drawn, boxes, said = crowded(ranks)
    # What matters most is there, and of the others the first.
    assert 3 <= len(drawn) < len(ranks) and drawn == [*range(len(drawn) - 2), 15, 16]
    assert said == [f"no room for {len(ranks) - len(drawn)} labels"]
    for k, one in enumerate(boxes):
        for other in boxes[:k]:
            wide = max(0.0, min(one.x1, other.x1) - max(one.x0, other.x0))
            high = max(0.0, min(one.y1, other.y1) - max(one.y0, other.y0))
            assert wide * high <= 0.02 * one.width * one.height


def test_a_picture_with_room_says_nothing_of_it():
    drawn, _, said = crowded([0, 0, 3])
    assert len(drawn) == 3 and said == []

"""Pictures of modes: what their colours mean, and where the shape rests."""

from itertools import pairwise

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize

from restshape.physics.elasticity.elasticity_declaration import FREE_VIBRATIONS
from restshape.report.modes import draw_modes

X = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]])
CELLS = np.array([[0, 1, 2], [0, 2, 3]])


def drawn(tmp_path, monkeypatch, shape, X=X, **words):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    draw_modes(tmp_path / "a.png", X, CELLS, np.array([shape]), ["load factor 2"], "column", **words)
    return figures[0]


def test_a_bent_mode_has_its_outline_at_rest_and_a_bar_of_shares(tmp_path, monkeypatch):
    shape = np.array([[0, 0, 0], [0, 0, 0], [7.0, 0, 0], [7.0, 0, 0]])
    figure = drawn(tmp_path, monkeypatch, shape, bend=0.3)
    axes, bar = figure.axes
    (rest,) = [one for one in axes.collections if isinstance(one, LineCollection)]
    (line,) = rest.get_segments()
    ends = {tuple(map(tuple, np.sort(pair, axis=0))) for pair in pairwise(line)}
    assert ends == {tuple(map(tuple, np.sort(X[[k, (k + 1) % 4]], axis=0))) for k in range(4)}
    assert "dashed: shape at rest" in figure.get_suptitle()
    assert "amplitude arbitrary" in bar.get_ylabel() and "size of the motion" in bar.get_ylabel()
    (colours,) = [one for one in axes.collections if one not in (rest,)]
    assert isinstance(colours.norm, Normalize) and (colours.norm.vmin, colours.norm.vmax) == (0.0, 1.0)
    assert colours.get_array().max() == 1.0


def test_a_mode_out_of_the_plane_has_a_bar_of_both_signs(tmp_path, monkeypatch):
    shape = np.array([[0, 0, -3.0], [0, 0, 0], [0, 0, 1.5], [0, 0, 0]])
    figure = drawn(tmp_path, monkeypatch, shape)
    bar = figure.axes[-1]
    assert bar.get_ylim() == (-1.0, 1.0) and "deflection" in bar.get_ylabel()
    assert not any(len(one.get_segments()) for one in figure.axes[0].collections if type(one) is LineCollection)


def test_modes_in_the_plane_are_named_beside_others(tmp_path, monkeypatch):
    """Of solids the mean over the thickness leaves a rest of motion out of the plane, of no meaning."""
    out = np.array([[0, 0, -3.0], [0, 0, 0], [0, 0, 1.5], [0, 0, 0]])
    within = np.array([[1.0, 0, 1e-9], [0, 0, 0], [1.0, 1.0, 0], [0, 0, -1e-9]])
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    for shapes in ([out, within], [within, within]):
        draw_modes(tmp_path / "a.png", X, CELLS, np.array(shapes), ["one", "two"], "plate")
    titles = [[axes.get_title() for axes in figure.axes[:2]] for figure in figures]
    assert titles == [["one", "two, in the plane"], ["one", "two"]]
    assert [len(figure.axes) for figure in figures] == [4, 3]


@pytest.mark.slow
@pytest.mark.parametrize("high", [0.05, 0.1, 0.3, 0.6, 1.0, 1.4, 3.0])
def test_the_label_of_the_bar_is_not_cut_off(tmp_path, monkeypatch, high):
    shape = np.array([[0, 0, -3.0], [0, 0, 0], [0, 0, 1.5], [0, 0, 0]])
    for part in (shape, shape[:, ::-1]):
        figure = drawn(tmp_path, monkeypatch, part, X=X * [3.0, 1.5 * high])
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        width, height = canvas.get_width_height()
        for axes in figure.axes:
            box = axes.get_tightbbox(canvas.get_renderer())
            assert box.x0 >= 0.0 and box.y0 >= 0.0 and box.x1 <= width and box.y1 <= height


def test_the_size_of_a_mode_is_named_for_people():
    assert FREE_VIBRATIONS.pictured["size_of_mode_1"].label == "size of mode 1, amplitude arbitrary"

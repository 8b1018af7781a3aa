"""The picture of error against time: names of what was varied lie on no mark and on no line."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from restshape_studies.pictures import work_precision


def record(error, ms, varied="", pareto=False, policy="auto"):
    given = 1e-4 if varied else None
    found = {"error": error, "frame_ms": ms, "order": 2, "policy": policy, "varied": varied, "given": given}
    return found | {"pareto": pareto}


@pytest.mark.parametrize("right", [False, True])
def test_names_keep_off_marks_and_lines(tmp_path, monkeypatch, right):
    """Of a front whose next points are close to the one that is named, on both sides of the picture."""
    figures = []
    monkeypatch.setattr(work_precision, "save_picture", lambda figure, path: figures.append(figure))
    close = [record(0.016, 18.5, "solve.tolerance", True), record(0.027, 17.8, "", True), record(0.034, 18.0)]
    far = [record(0.0001, 19.0, "", True)] if right else [record(0.4, 10.0, "", True), record(0.001, 60.0)]
    records = [*close, *far, record(0.016, 23.0, "solve.guess"), record(0.016, 40.0)]
    work_precision.draw_work_precision(records, "solution", 1e-9, "bar", tmp_path / "a.png")
    (figure,) = figures
    FigureCanvasAgg(figure).draw()
    axes, over = figure.axes
    (name,) = over.texts
    assert name.get_text() == "tolerance = 0.0001"
    box = name.get_window_extent()
    for line in axes.lines:
        at = axes.transData.transform(line.get_xydata())
        share, ends = np.linspace(0.0, 1.0, 200)[:, None], [*at[1:], at[-1]]
        along = np.concatenate([a + share * (b - a) for a, b in zip(at, ends)])
        assert not any(box.contains(*place) for place in along)
    # It is nearer to its own mark than to any other.
    places = axes.transData.transform([(100.0 * one["error"], one["frame_ms"]) for one in records])
    middle = np.clip(places, [box.x0, box.y0], [box.x1, box.y1])
    assert np.argmin(np.linalg.norm(places - middle, axis=1)) == 0

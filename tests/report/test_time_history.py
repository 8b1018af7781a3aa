"""The picture of quantities over simulated time: drawn where there is one, and with what the recording holds."""

import numpy as np
import pytest
from clear_figures import check_figure
from PIL import Image

from restshape.outputs import picture_files
from restshape.replay.columns import columns
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.report import time_history
from restshape.report.quantity_panels import cut_start
from restshape.report.style import new_figure
from restshape.report.time_history import _line, draw_history, edited_spans, value_step

CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
SWAY = 1e-3 * np.sin(np.arange(12.0))


def record(path, own, scale=1.0):
    """A recording of 12 frames, 0.5 s of simulated time each, of which 4 to 6 move nodes and 9 is refused.

    Times and values are multiplied by a scale.
    """
    known = columns(["sway"], own)
    with Recorder.start(path, {"title": "mast"}, known) as recorder:
        recorder.topology(np.array([[0, 1, 2]]))
        time = 0.0
        for i, value in enumerate(SWAY):
            time += 0.5 * scale if i and i != 9 else 0.0
            row = {"index": i, "level": int(4 <= i <= 6), "event": "drag" if 4 <= i <= 6 else "idle", "time": time}
            row |= {"q_sway": np.nan if i == 9 else scale * value, "refused": "crosses itself" if i == 9 else ""}
            recorder.frame(0.1 * scale * i, CORNERS, {}, {}, {name: row[name] for name in row if name in known})
    return Recording(path)


@pytest.mark.slow
def test_lines_are_the_recorded_values_over_simulated_time(tmp_path, monkeypatch):
    figures = []
    saved = picture_files.write_figure
    monkeypatch.setattr(
        picture_files, "write_figure", lambda figure, *a: (figures.append(figure), saved(figure, *a))[1]
    )
    with record(tmp_path / "a.vtkhdf", {"time": float}) as recording:
        assert draw_history(recording, tmp_path / "history.png")
        times = recording.table["time"]
    check_figure(figures[0])
    axes = figures[0].axes[0]
    (line,) = (one for one in axes.get_lines() if len(one.get_xdata()) == 12)
    np.testing.assert_allclose(line.get_xdata(), times)
    expected = 1e3 * SWAY
    expected[9] = np.nan
    np.testing.assert_allclose(np.asarray(line.get_ydata()), expected * line.get_ydata()[1] / expected[1])
    assert axes.get_xlabel() == "simulated time [s]"
    (above,) = axes.child_axes
    marks = dict(zip(above.get_xticks(), (float(text.get_text()) for text in above.get_xticklabels())))
    # A frame has 0.1 s of edit time and 0.5 s of simulated time, and one, from 0.8 s to 0.9 s, was refused.
    assert marks == pytest.approx({0.0: 0.0, 1.0: 0.2, 2.0: 0.4, 3.0: 0.6, 4.0: 0.8, 4.5: 1.0})
    assert Image.open(tmp_path / "history.png").size[0] > 1000


def test_the_step_of_values_is_the_one_of_all_frames_or_its_extremes():
    even, finer = 0.05 * np.arange(31), 1.5 + 0.02 * np.arange(1, 7)
    assert value_step(even) == "50 ms"
    assert value_step(np.concatenate([even, even[-1:], finer])) == "20 ms to 50 ms"


def test_edited_spans_begin_at_the_end_of_the_frame_before(tmp_path):
    with record(tmp_path / "a.vtkhdf", {"time": float}) as recording:
        assert edited_spans(recording) == [(1.5, 3.0)]


def test_without_simulated_time_there_is_no_picture(tmp_path):
    with record(tmp_path / "a.vtkhdf", {}) as recording:
        assert not draw_history(recording, tmp_path / "history.png")
    assert not (tmp_path / "history.png").exists()


@pytest.mark.parametrize("scale", [1e-6, 1e-4, 3e-3, 0.02])
def test_numbers_along_the_axes_of_short_runs_differ(tmp_path, monkeypatch, scale):
    figures = []
    monkeypatch.setattr(time_history, "save_picture", lambda figure, path: figures.append(figure))
    with record(tmp_path / "a.vtkhdf", {"time": float}, scale) as recording:
        assert draw_history(recording, tmp_path / "history.png")
    (panel,) = figures[0].axes
    for axis in (panel.xaxis, panel.yaxis, panel.child_axes[0].xaxis):
        texts = [text.get_text() for text in axis.get_ticklabels() if text.get_text()]
        assert len(set(texts)) == len(texts) > 1


@pytest.mark.parametrize("start", [13.4, 1.9])
def test_a_start_far_beyond_all_later_values_is_cut_off_and_named(start):
    """A drag between 1.4 and 1.8 that begins at 0 and goes up to 13.4, or to 1.9, which is near."""
    values = np.array([1.4, start, *(1.6 + 0.2 * np.sin(np.arange(30.0)))])
    axes = new_figure(4.0, 2.0).subplots()
    axes.plot(values)
    whole = axes.get_ylim()
    cut_start(axes, values, "N")
    low, high = axes.get_ylim()
    if start == 1.9:
        assert (low, high) == whole and not axes.texts
        return
    later = values[5:]
    assert low < later.min() and later.max() < high < 2.0
    assert axes.texts[0].get_text() == "cut off: the first 5 frames go from 1.4 to 13.4 N"


def test_a_start_is_not_cut_off_before_values_that_differ_by_rounding_alone():
    """A flux that is 0 at rest, and what enters from the first step on: its last digits are no swings."""
    values = np.array([0.0, *(0.012 + 1e-16 * np.sin(np.arange(30.0)))])
    axes = new_figure(4.0, 2.0).subplots()
    axes.plot(values)
    whole = axes.get_ylim()
    cut_start(axes, values, "m^3/s")
    assert axes.get_ylim() == whole and not axes.texts


def test_a_quantity_without_a_value_says_so():
    axes = new_figure(4.0, 2.0).subplots()
    assert _line(axes, np.arange(3.0), np.full(3, np.nan), "", {}) == ""
    assert [text.get_text() for text in axes.texts] == ["no values"]

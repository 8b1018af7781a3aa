"""The axis of frames has whole numbers, and each frame lies on it."""

import numpy as np
import pytest

from restshape.report.frame_axis import frame_axis
from restshape.report.style import new_figure


@pytest.mark.parametrize("count", [1, 2, 3, 7, 250])
def test_ticks_are_frames(count):
    axes = new_figure(10.0, 2.0).subplots()
    axes.plot(np.arange(count), np.ones(count), marker=".")
    frame_axis(axes, count)
    low, high = axes.get_xlim()
    shown = [tick for tick in axes.get_xticks() if low <= tick <= high]
    assert shown and all(float(tick).is_integer() and tick >= 0 for tick in shown)
    assert low < 0.0 and high > count - 1.0 and axes.get_xlabel() == "frame"

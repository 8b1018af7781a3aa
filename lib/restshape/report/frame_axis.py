"""The axis of frames below pictures of a recording."""

from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator


def frame_axis(axes: Axes, count: int) -> None:
    """Has the horizontal axis be that of so many frames: whole numbers alone, also where there is one frame."""
    axes.set_xlabel("frame")
    axes.set_xlim(-0.5 - 0.01 * count, count - 0.5 + 0.01 * count)
    axes.xaxis.set_major_locator(MaxNLocator("auto", steps=[1, 2, 2.5, 5, 10], integer=True, min_n_ticks=1))

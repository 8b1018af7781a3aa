"""What must be so in each figure of panels."""

from itertools import combinations

from matplotlib.backends.backend_agg import FigureCanvasAgg


def check_figure(figure) -> None:
    """All texts lie within the figure; axes with their numbers, title and legend do not overlap."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer, (width, height) = canvas.get_renderer(), canvas.get_width_height()
    boxes = [axes.get_tightbbox(renderer) for axes in figure.axes]
    boxes += [part.get_window_extent(renderer) for part in (figure._suptitle, *figure.legends) if part]
    for box in boxes:
        assert box.x0 >= 0.0 and box.y0 >= 0.0 and box.x1 <= width and box.y1 <= height
    for one, other in combinations(boxes, 2):
        assert (
            min(one.x1, other.x1) - max(one.x0, other.x0) < 1.0 or min(one.y1, other.y1) - max(one.y0, other.y0) < 1.0
        )
    # Each name of an axis stands beside the numbers, not on them.
    for axes in figure.axes:
        name = axes.yaxis.label.get_window_extent(renderer)
        numbers = [label.get_window_extent(renderer) for label in axes.get_yticklabels() if label.get_text()]
        numbers = [box for box in numbers if axes.bbox.y0 <= 0.5 * (box.y0 + box.y1) <= axes.bbox.y1]
        assert not axes.get_ylabel() or not numbers or name.x1 <= min(box.x0 for box in numbers)
    # At most a third of the figure is room around the panels.
    assert sum(axes.get_position().height for axes in figure.axes) > 0.5
    assert all(axes.get_position().width > 0.75 for axes in figure.axes)

"""Titles of scenes are cut at a word where their figure is too narrow for them."""

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from restshape.report.fitted_title import fits, fitted
from restshape.report.style import new_figure

LONG = "a bar of steel that somebody has sawn, filed and drilled, and hung up on two cords in a workshop to be heard"


@pytest.mark.parametrize("inches", [3.0, 6.0])
@pytest.mark.parametrize("rest", ["", ": its modes"])
@pytest.mark.parametrize("size", [8.0, 11.0])
def test_a_long_title_fits_and_keeps_what_its_line_says_besides(inches, rest, size):
    words = fitted(LONG, inches, rest, size)
    assert words.endswith(" …" + rest) and LONG.startswith(words.removesuffix(" …" + rest) + " ")
    figure = new_figure(inches, 1.0)
    drawn = figure.text(0.0, 0.5, words, fontsize=size)
    width = drawn.get_window_extent(FigureCanvasAgg(figure).get_renderer()).width / figure.dpi
    # One more word would not fit.
    assert width <= inches and width > 0.7 * inches


def test_a_title_that_fits_stays():
    assert fitted("bar", 3.0) == "bar" and fitted("", 3.0, ": modes") == ": modes"
    assert fits("", 1.0) and not fits(LONG, 3.0)


def test_a_single_long_word_stays():
    assert fitted("w" * 200, 3.0).startswith("w" * 200)

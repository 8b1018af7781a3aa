"""Words over pictures of bars stay within them, however long the title of a scene is, and however few the bars."""

import importlib

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from restshape.cli.main import main

TITLE = "a bar of aluminium that somebody has sawn, filed, drilled and hung up on two cords in a workshop " * 2


@pytest.fixture
def bar(tmp_path):
    """The scene that `restshape new` writes, with a long title."""
    assert main(["new", "metallophone", str(tmp_path / "bar")]) == 0
    path = tmp_path / "bar" / "scene.toml"
    path.write_text(path.read_text().replace('"my bar"', f'"{TITLE.strip()}"'))
    return path


@pytest.mark.parametrize(
    ("command", "option", "module"),
    [
        ("modes", "--out", "restshape.report.modes"),
        ("modes", "--space", "restshape.report.space_modes"),
        ("instrument", "--out", "restshape_apps.metallophone.instrument.picture"),
        ("pitches", "--out", "restshape_apps.metallophone.pitches_picture"),
    ],
)
def test_titles_lie_within_their_pictures(bar, monkeypatch, command, option, module):
    shown = bar
    if command == "pitches":
        shown = bar.parent / "bar.vtkhdf"
        assert main(["replay", str(bar), "--out", str(shown)]) == 0
    figures = []
    monkeypatch.setattr(importlib.import_module(module), "save_picture", lambda figure, path: figures.append(figure))
    assert main([command, str(shown), option, str(bar.parent / "picture.png")]) == 0
    (figure,) = figures
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    assert figure.texts or figure.get_suptitle()
    for text in figure.findobj(lambda one: one in figure.texts or one is figure._suptitle):
        box = text.get_window_extent(renderer)
        assert box.x0 >= 0.0 and box.x1 <= figure.bbox.width, text.get_text()

"""A quantity at a singular place is named so wherever its value is shown, at rest and in motion."""

import json

import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from small_scenes import plate, write_scene

from restshape.replay.singular_notes import MARK, singular_notes

MOVING = plate(0.3).replace('app = "plane"', 'app = "moving"') + "[effects.dynamics]\ntime_step = 2e-4\nsteps = 2\n"
PICTURES = ("report.quantity_panels", "variation.sweep_picture", "comparison.comparison_picture")


@pytest.fixture
def drawn(monkeypatch):
    """The figures that commands draw of quantities."""
    found: list[Figure] = []
    for module in PICTURES:
        monkeypatch.setattr(f"restshape.{module}.save_picture", lambda figure, path: found.append(figure))
    return found


def titles(figure):
    """Titles of all panels of a figure."""
    return [axes.get_title(loc="left") for axes in figure.findobj(Axes)]


@pytest.mark.slow
@pytest.mark.parametrize("text", [plate(0.3), MOVING], ids=["rest", "motion"])
def test_every_command_says_the_same(command, tmp_path, drawn, text):
    write_scene(tmp_path, text)
    replayed = command("replay", "scene.toml", "--out", "a.vtkhdf", "--json", "a.json")
    assert replayed.returncode == 0, replayed.stderr
    singular = json.loads((tmp_path / "a.json").read_text())["singular"]
    (note,) = singular_notes(singular)
    assert list(singular) == ["peak"] and note.startswith("peak is taken at a singular place (r^-0.")
    shown = command("report", "a.vtkhdf", "--animation", "none", "--json", "r.json")
    again = command("compare", "a.vtkhdf", "a.vtkhdf", "--out", "c.png")
    swept = command(
        "sweep", "scene.toml", "--set", "material.steel.E=200GPa,210GPa", "--out", "s.png", "--json", "s.json"
    )
    for done in (replayed, shown, again, swept):
        assert done.returncode == 0 and note in done.stdout, done.stdout + done.stderr
    report = json.loads((tmp_path / "r.json").read_text())
    assert report["singular"] == json.loads((tmp_path / "s.json").read_text())["singular"] == singular
    assert next(row["error"] for row in report["quantities"] if row["quantity"] == "peak") == "singular"
    assert len(drawn) == 3 and all(f"peak ({MARK})" in titles(figure) for figure in drawn)

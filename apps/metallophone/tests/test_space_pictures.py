"""Pictures of modes in space by their command, of each model of a body."""

import json

import pytest
from restshape_apps.metallophone import application
from restshape_apps.metallophone.space_picture import flat_body, space_modes

from restshape.cli.main import main
from restshape.interface.first_frame import first_frame

SCENES = application.folder / "scenes"
FISH = ["mesh.size=14 mm", "effects.modal.modes=7", "effects.modal.in_plane=true", "mesh.order=1"]


def settings(overrides):
    return [word for one in overrides for word in ("--set", one)]


def test_modes_in_space_are_drawn(tmp_path, monkeypatch):
    monkeypatch.setattr("restshape.report.mode_period.PICTURES", 2)
    out, period, found = (tmp_path / name for name in ("space.png", "mode.gif", "modes.json"))
    words = [*settings(FISH), "--space", str(out), "--period", str(period), "--mode", "2", "--json", str(found)]
    assert main(["modes", str(SCENES / "fish.toml"), *words]) == 0
    assert out.stat().st_size > 20_000 and period.stat().st_size > 5_000
    shares = json.loads(found.read_text())["perpendicular"]
    assert len(shares) == 7 and min(shares) < 0.05 and max(shares) > 0.99
    # What is there and is ours may be replaced.
    assert main(["modes", str(SCENES / "fish.toml"), *words]) == 0


@pytest.mark.parametrize(
    ("scene", "words", "thickness", "perpendicular"),
    [
        ("bar_150.toml", ["effects.modal.model=plate"], 0.004, True),
        ("bar_150.toml", ["effects.modal.model=solid"], 0.004, True),
        ("bar_150.toml", ["effects.modal.model=plane_stress"], 0.004, False),
        ("bar_150.toml", ["effects.modal.model=plate", 'material.aluminium.thickness="2 mm + 0.02*x"'], None, True),
    ],
)
def test_bodies_have_their_thickness_and_modes_their_kind(scene, words, thickness, perpendicular):
    analysis = first_frame(SCENES / scene, ['mesh.size="15 mm"', "mesh.order=1", *words]).analysis
    body, (mode,) = flat_body(analysis), space_modes(analysis)
    ends = (0.002, 0.005) if thickness is None else (thickness, thickness)
    assert (body.thickness.min(), body.thickness.max()) == pytest.approx(ends)
    assert mode.perpendicular is perpendicular and len(mode.shape) == len(body.X)


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (["--period", "mode.png"], "name ends in .gif"),
        (["--mode", "2", "--space", "a.png"], "add --period"),
        (["--period", "mode.gif", "--mode", "3"], "only 1 mode is computed"),
        (["--period", "mode.gif", "--mode", "0"], "--mode 0"),
    ],
)
def test_what_cannot_be_drawn_is_refused(tmp_path, monkeypatch, capsys, words, reported):
    monkeypatch.chdir(tmp_path)
    overrides = ['mesh.size="15 mm"', "effects.modal.model=plate"]
    assert main(["modes", str(SCENES / "bar_150.toml"), *settings(overrides), *words]) == 2
    assert reported in capsys.readouterr().err and not list(tmp_path.glob("*.gif"))

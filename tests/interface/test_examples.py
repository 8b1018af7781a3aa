"""What a program does by hand is a script, whose replay gives the same rows: the example of each application."""

import runpy
from pathlib import Path

import pytest

import restshape
from restshape.interface.shown_frame import LastAnswer

APPS = Path(__file__).parents[2] / "apps"
COARSE = {
    "bridge": ("mesh.size='900 mm'", "mesh.order=1"),
    "cantilever": ("mesh.size='120 mm'",),
    "couture": ("mesh.size='60 mm'",),
    "flow": ("mesh.size='30 mm'",),
    "furniture": (),
    "metallophone": ("mesh.size='20 mm'",),
    "solid": ("mesh.size='150 mm'",),
    "thermal": ("mesh.size='6 mm'", "mesh.order=1"),
    "vibration": ("mesh.size='900 mm'",),
}
"""Settings with which the scene of each example is simulated quickly."""


EXAMPLES = {path.parents[1].name: path for path in APPS.glob("*/python/*.py") if "def edit(" in path.read_text()}


def values(row: dict) -> dict:
    """The columns of a row but its times; texts of values, in which numbers that are none are equal."""
    return {name: repr(value) for name, value in row.items() if not name.startswith("ms")}


def test_every_application_has_an_example():
    assert set(EXAMPLES) == set(COARSE)
    assert set(COARSE) == {path.parent.name for path in APPS.glob("*/scenes")}


@pytest.mark.parametrize("app", COARSE)
def test_the_script_of_an_example_replays_to_the_same_rows(app, monkeypatch, tmp_path):
    rows, usual = [], LastAnswer.frame

    def kept(answer, row):
        rows.append(dict(row))
        return usual(answer, row)

    example = runpy.run_path(str(EXAMPLES[app]))
    scene = restshape.load(example["SCENE"], *COARSE[app])
    with monkeypatch.context() as patched:
        patched.setattr(LastAnswer, "frame", kept)
        with restshape.open(scene) as sim:
            example["edit"](sim)
    restshape.save_script(sim.script, tmp_path / "done.jsonl")
    script = restshape.load_script(tmp_path / "done.jsonl", scene)
    assert script.frame_count == len(rows) > 4
    replayed = [values(frame.row) for frame in restshape.replay(scene, script)]
    assert replayed == [values(row) for row in rows]


@pytest.mark.parametrize("app", ["couture", "furniture"])
def test_what_is_no_plane_shape_is_drawn_as_its_reports_draw_it(app, tmp_path):
    scene = restshape.load(runpy.run_path(str(EXAMPLES[app]))["SCENE"], *COARSE[app])
    run = restshape.replay(scene, out=tmp_path / "drawn.vtkhdf")
    drawn = next(run)._repr_png_()
    assert not list(run)
    with restshape.recording(tmp_path / "drawn.vtkhdf") as recording:
        assert drawn.startswith(b"\x89PNG") and drawn == recording.frames[0]._repr_png_()

"""The picture of a tone beside its edit: which frames it shows, and that an artist's edit ends in tune."""

import json
from argparse import Namespace
from pathlib import Path

import numpy as np
import pytest
import restshape_apps.metallophone as metallophone
from restshape_apps.metallophone.pitches_picture import _tones, pitches_of
from restshape_apps.metallophone.workshop.bar import bar_of

from restshape.cli.main import main
from restshape.export.edited_frame import frame_of_script
from restshape.outputs.kinds import PictureFile
from restshape.replay.recording.recording import Recording
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

FOLDER = Path(metallophone.__file__).parent
TEMPLATE = FOLDER / "template" / "scene.toml"


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A recording of a corner that is dragged to a place and on to another one, after which nothing happens."""
    folder = tmp_path_factory.mktemp("recorded")
    lines = [
        {"format": "restshape-edits", "version": 1, "scene": str(TEMPLATE), "units": "mm"},
        {"t": 0.0, "do": "press", "on": "c", "at": [170, 30]},
        {"t": 0.1, "do": "drag", "path": [[160, 30]], "frames": 2},
        {"t": 0.2, "do": "drag", "path": [[160, 20]], "frames": 2},
        {"t": 0.3, "do": "release"},
        {"t": 0.4, "do": "idle", "frames": 2},
    ]
    script = folder / "edits.jsonl"
    script.write_text("\n".join(map(json.dumps, lines)))
    out = folder / "bar.vtkhdf"
    assert main(["replay", str(TEMPLATE), "--edits", str(script), "--out", str(out)]) == 0
    return out


@pytest.mark.slow
def test_shapes_are_those_at_the_ends_of_gestures(recording, tmp_path):
    out, numbers = PictureFile(tmp_path / "pitch.png"), tmp_path / "pitch.json"
    assert main(["pitches", str(recording), "--out", str(out), "--json", str(numbers)]) == 0
    assert out.ours() and out.stat().st_size > 10_000
    found = json.loads(numbers.read_text())
    with Recording(recording) as known:
        events, frequencies = [str(event) for event in known.table["event"]], known.table["f_1"]
        lines = [int(line) for line in known.table["line"]]
        several = pitches_of(known, [], 2)
    drags = [k for k, event in enumerate(events) if event == "drag"]
    ends = [max(k for k in drags if lines[k] == line) for line in sorted({lines[k] for k in drags})]
    assert len(ends) == 2 and [one["frame"] for one in found["shown"]] == [0, *ends]
    np.testing.assert_allclose([one["frequency"] for one in found["shown"]], frequencies[[0, *ends]])
    assert several.shown == [0, ends[-1]] and several.a4 == pytest.approx(440.0, rel=1e-9)


@pytest.mark.parametrize("at", ["x", "0,99", ",".join(map(str, range(11)))])
def test_frames_that_are_not_there_are_refused(recording, tmp_path, at, capsys):
    assert main(["pitches", str(recording), "--out", str(tmp_path / "pitch.png"), "--at", at]) == 2
    assert "frames are numbers from 0 to" in capsys.readouterr().err


def test_lines_of_tones_lie_at_their_frequencies():
    found = _tones(430.0, 530.0, 440.0)
    assert [name.split()[0] for name in found.values()] == ["A4", "A#4", "B4", "C5"]
    np.testing.assert_allclose(list(found), 440.0 * 2.0 ** (np.array([0, 1, 2, 3]) / 12.0))
    assert not any("#" in name for name in _tones(100.0, 1000.0, 440.0).values())


def test_the_artists_fish_is_in_tune():
    """The shape that the edits end with, on a mesh of its own."""
    scene = load_scene(FOLDER / "scenes" / "artist.toml")
    script = load_script(FOLDER / "edits" / "artist.jsonl", scene)
    bar = bar_of(frame_of_script(scene, script, -1), Namespace(to=None, cord=0.0))
    assert bar.target == "G#5" and abs(bar.cents) < 2.0 and bar.hanging.found
    assert bar.outline.entity("fork").vertices and len(bar.outline.edges) == 7

"""Replay and report count, of the same frames, the same ones as solved, and list the same notes."""

import json
from types import SimpleNamespace

import numpy as np
from cloths import PIN, write_cloth

from restshape.cli.main import main
from restshape.replay.recording.recording import Recording
from restshape.report.tables import level_table, note_table, with_values


def test_an_undo_that_brings_back_a_drape_is_not_counted_as_solved(tmp_path):
    scene, recording, data = write_cloth(tmp_path, PIN), tmp_path / "cloth.vtkhdf", tmp_path / "cloth.json"
    lines = [{"format": "restshape-edits", "version": 1, "scene": "cloth.toml", "units": "m"}]
    lines.append({"t": 0.0, "do": "set", "key": "material.cotton.rho", "value": 500})
    lines += [{"t": 0.1, "do": "undo"}, {"t": 0.2, "do": "redo"}, {"t": 0.3, "do": "idle"}]
    (tmp_path / "edits.jsonl").write_text("\n".join(map(json.dumps, lines)))
    call = ["--set", "mesh.size=0.5", "--json", str(data)]
    assert main(["replay", str(scene), str(tmp_path / "edits.jsonl"), "--out", str(recording), *call]) == 0
    replayed = json.loads(data.read_text())
    with Recording(recording) as found:
        levels = {row["level"]: row["frames"] for row in level_table(found)}
        assert list(with_values(found)) == [False, True, False, False, False]
    assert replayed["still"] == levels["values"] + levels["still"] == 1
    assert replayed["idle"] - replayed["still"] == levels["idle"] == 3


def test_of_notes_that_differ_by_numbers_the_worst_is_listed_with_its_frame():
    notes = np.array(["", "3 mm inside", "5 mm inside", "4 mm inside", ""])
    table = {"line": np.array([0, 2, 2, 2, 3]), "index": np.arange(5), "note": notes, "refused": notes}
    recording = SimpleNamespace(n=5, table=table)
    assert note_table(recording) == [(2, "1 to 3, worst 2", "5 mm inside")]
    assert note_table(recording, "refused") == [(2, "1 to 3", "3 mm inside")]

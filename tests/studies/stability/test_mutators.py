"""Mutators damage what they are given, and the files that they damage are read where they are whole."""

import base64
import json
import tomllib
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
from hypothesis import HealthCheck, find, given, settings
from hypothesis import strategies as st
from restshape_studies.stability.batch import DAMAGED, DRAWN, FILES, KINDS, RECORDINGS, Batch
from restshape_studies.stability.crafted_recordings import CRAFTED as CRAFTED_RECORDINGS
from restshape_studies.stability.crafted_recordings import datasets
from restshape_studies.stability.example import EDITS, SCENE, Example
from restshape_studies.stability.foreign_files import samples
from restshape_studies.stability.fuzz import BATCH, CYCLE, _new_folder, fuzz
from restshape_studies.stability.hostile_bytes import BYTES
from restshape_studies.stability.hostile_files import naming
from restshape_studies.stability.hostile_recordings import DAMAGE, damages, outcome
from restshape_studies.stability.mutators import MUTATORS, texts
from restshape_studies.stability.player import Fault, play
from restshape_studies.stability.scenery import plate
from restshape_studies.stability.tables import toml
from restshape_studies.stability.tried import Found

from restshape.cli.main import main
from restshape.mesh.importer import read_mesh
from restshape.shape.drawings.dxf import read_dxf
from restshape.shape.drawings.geo import read_geo
from restshape.shape.drawings.svg import read_svg

SCENE_TABLE = {"format": "x", "version": 1, "shape": {"vertices": {"a": [0.0, 1.5]}}, "mesh": {"size": 0.25}}
LINES = [{"format": "e", "version": 1}, {"t": 0.1, "do": "press", "on": "a"}, {"t": 0.2, "do": "drag", "to": [1.0, 2]}]
QUICK = settings(
    max_examples=25, deadline=None, database=None, suppress_health_check=list(HealthCheck), derandomize=True
)


@pytest.mark.parametrize("name", list(MUTATORS))
def test_a_mutator_changes_a_scene_or_its_script(name):
    whole, changed = texts(SCENE_TABLE, LINES), set()

    @QUICK
    @given(st.data())
    def mutate(data):
        found = MUTATORS[name](data.draw, SCENE_TABLE, LINES)
        assert all(isinstance(text, str) for text in found)
        changed.add(found)

    mutate()
    assert len(changed - {whole}) > 5
    assert SCENE_TABLE["shape"] == {"vertices": {"a": [0.0, 1.5]}} and len(LINES) == 3


def test_numbers_too_long_for_python_and_depths_too_large_for_it_are_in_the_text():
    def has(name: str, part: str) -> None:
        draws = st.composite(lambda draw: MUTATORS[name](draw, SCENE_TABLE, LINES))()
        found = find(draws, lambda both: part in "".join(both), settings=settings(QUICK, max_examples=3000))
        with pytest.raises((ValueError, RecursionError)):
            tomllib.loads(found[0]), [json.loads(line) for line in found[1].splitlines()]

    has("huge", "7" * 5000)
    has("nested", "[" * 5000)


@pytest.mark.slow
def test_samples_are_read_as_they_are_and_damage_changes_them(tmp_path):
    readers = {".geo": read_geo, ".dxf": read_dxf, ".svg": lambda path: read_svg(path, {})}
    for name, (ending, data) in samples().items():
        path = tmp_path / f"sample{ending}"
        path.write_bytes(data)
        assert readers.get(ending, read_mesh)(path), name
    assert meshio.read(tmp_path / "sample.vtu").cells


@pytest.mark.parametrize("name", list(BYTES))
def test_damage_of_bytes(name):
    data, changed = samples()["gmsh"][1], set()

    @QUICK
    @given(st.data())
    def damage(drawn):
        changed.add(BYTES[name](drawn.draw, data))

    damage()
    assert len(changed - {data}) > 5


def test_batches_are_of_all_kinds_in_the_shares_that_are_documented():
    shares = [CYCLE.count(kind) * BATCH[kind] for kind in KINDS]
    assert [20 * share / sum(shares) for share in shares] == [8, 8, 3, 1]
    assert (DRAWN, DAMAGED, FILES, RECORDINGS) == KINDS


def test_an_example_with_files_is_refused_or_played_and_what_it_writes_over_is_a_fault(tmp_path, monkeypatch):
    name, drawing = "part.geo", samples()["geo"][1][:200]
    scene = toml(naming(tomllib.loads(plate("plane")), name))
    files = {name: base64.b64encode(drawing).decode()}
    example = Example(
        "plane", scene, '{"format": "restshape-edits", "version": 1}\n', "auto", "none", "file: cut", files=files
    )
    example.write(tmp_path)
    assert (tmp_path / name).read_bytes() == drawing
    played = play(tmp_path, example)
    assert played.outcome == "2" and "part.geo" in played.message

    def spoil(folder: Path, *_: object) -> None:
        (folder / EDITS).write_text("mine")

    monkeypatch.setattr("restshape_studies.stability.player._play", spoil)
    with pytest.raises(Fault, match=r"written over: \['edits\.jsonl'\]"):
        play(tmp_path, example)
    monkeypatch.setattr(
        "restshape_studies.stability.player._play", lambda folder, *_: (folder / "new").write_text("mine")
    )
    example.write(tmp_path)
    with pytest.raises(Fault, match=r"left behind: \['new'\]"):
        play(tmp_path, example)


def test_bytes_that_are_no_text_are_written(tmp_path):
    Example("plane", "\udcff\udcfe", "\ud800", "auto", "none").write(tmp_path)
    assert (tmp_path / SCENE).read_bytes() == b"\xff\xfe" and (tmp_path / EDITS).read_bytes() == b"\xed\xa0\x80"


@pytest.mark.slow
def test_damaged_recordings_end_in_a_report_or_a_message(tmp_path):
    found = [(name, outcome(tmp_path, path)) for name, path in damages(Batch(3, 6, ("plane",), RECORDINGS), tmp_path)]
    assert len(found) == 6 and len({name for name, _ in found}) > 3
    assert {name.removeprefix("recording: ") for name, _ in found} <= set(DAMAGE)
    assert any(codes == "report 2, salvage 2" for _, codes in found)


@pytest.mark.parametrize("what", CRAFTED_RECORDINGS)
def test_crafted_structures_stand_in_the_place_of_an_array(tmp_path, what):
    """A group with an array and its attribute, and a header; afterwards the file still opens, and is another one."""
    path = tmp_path / "small.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("VTKHDF/Points", data=np.arange(6.0)).attrs["order"] = 1
        file.create_dataset("restshape/header", data=np.frombuffer(b"{}", dtype="u1"))
    before = path.read_bytes()
    with h5py.File(path, "r+") as file:
        assert datasets(file) == ["VTKHDF/Points", "restshape/header"]
        CRAFTED_RECORDINGS[what](file, "VTKHDF/Points")
    assert path.read_bytes() != before
    with h5py.File(path) as file:
        assert "restshape/header" in file


def counted(batch, tried, keep, each):
    """In place of playing a batch."""
    tried.examples += batch.count


def test_kinds_of_batches_are_chosen(monkeypatch):
    played = []

    def play(batch, tried, keep, each):
        played.append(batch)
        counted(batch, tried, keep, each)

    monkeypatch.setattr("restshape_studies.stability.fuzz._play", play)
    fuzz(260, 3, ("plane",), kinds=[RECORDINGS, FILES])
    assert [(one.kind, one.count) for one in played] == [(RECORDINGS, 25), (FILES, 100)] * 2 + [(RECORDINGS, 10)]
    played.clear()
    fuzz(2000, 3, ("plane",))
    assert [one.seed for one in played] == list(range(3, 26))
    assert {kind: sum(one.count for one in played if one.kind == kind) for kind in KINDS} == {
        DRAWN: 800,
        DAMAGED: 800,
        FILES: 300,
        RECORDINGS: 100,
    }


def test_a_fuzz_goes_on_with_the_counts_of_one_before(monkeypatch, tmp_path, capsys):
    """In two parts as in one: the same batches, and counts of both; a table of another campaign is refused."""
    seeds = []

    def play(batch, tried, keep, each):
        seeds.append((batch.seed, batch.kind))
        counted(batch, tried, keep, each)
        tried.ended(batch.kind, "0")
        tried.messages["no"] += 1
        tried.found.setdefault("odd", Found(batch.seed, "fault", "odd", "it broke")).seen += 1

    monkeypatch.setattr("restshape_studies.stability.fuzz._play", play)
    monkeypatch.setattr("restshape_studies.stability.fuzz.checked_out", lambda: "0123456789ab")
    table, words = (
        tmp_path / "fuzz.json",
        ["stability", "--seed", "5", "--resume", "--json", str(tmp_path / "fuzz.json")],
    )
    assert main([*words, "--fuzz", "300"]) == 1
    first = json.loads(table.read_text())
    assert first["examples"] == 300 and first["parts"] == [
        {"commit": "0123456789ab", "examples": 300, "seconds": first["seconds"]}
    ]
    monkeypatch.setattr("restshape_studies.stability.fuzz.checked_out", lambda: "ba9876543210")
    main([*words, "--fuzz", "700"])
    both, in_parts = json.loads(table.read_text()), list(seeds)
    assert [part["examples"] for part in both["parts"]] == [300, 400] and both["faults"][0]["seen"] == 9
    seeds.clear()
    monkeypatch.setattr("restshape_studies.stability.fuzz.checked_out", lambda: "0123456789ab")
    # The first part ended within a batch, whose rest is never played.
    whole = fuzz(700, 5, both["apps"]).as_dict()
    assert in_parts == seeds
    times = ("seconds", "processor_seconds", "parts")
    assert {key: whole[key] for key in whole if key not in times} == {
        key: both[key] for key in whole if key not in times
    }
    capsys.readouterr()
    assert main([*words, "--fuzz", "900", "--seed", "6"]) == 2 and "another seed" in capsys.readouterr().err
    table.write_text('{"seed": 5}')
    assert main([*words, "--fuzz", "900"]) == 2
    assert main(["stability", "--resume"]) == 2 and main(["stability", "--resume", "--fuzz", "9"]) == 2


def test_a_folder_of_faults_is_a_new_one(tmp_path):
    first = _new_folder(tmp_path, "01-seed-7")
    (first / SCENE).write_text("kept")
    assert _new_folder(tmp_path, "01-seed-7") == tmp_path / "01-seed-7-2"
    assert (first / SCENE).read_text() == "kept"

"""Damage of a recording is reported, and what is good in it is saved."""

import json
import os
from pathlib import Path

import h5py
import numpy as np
import pytest
from plates import record_plate

from restshape.errors import UserError, printable
from restshape.outputs.picture_files import save_picture
from restshape.replay.recording.good_frames import salvage
from restshape.replay.recording.recording import Recording, ranges
from restshape.report.scenery import goals_of
from restshape.report.style import new_figure


@pytest.fixture(scope="module")
def valid(tmp_path_factory):
    path = tmp_path_factory.mktemp("recording") / "plate.vtkhdf"
    return path, record_plate(path, frames=12, remesh_every=4)


@pytest.fixture
def damaged(valid, tmp_path) -> Path:
    """A copy to damage."""
    path = tmp_path / "damaged.vtkhdf"
    path.write_bytes(valid[0].read_bytes())
    return path


def same_frames(path: Path, known: list, numbers: list[int]) -> None:
    """The frames of a recording are those of another with these numbers, bit for bit."""
    with Recording(path) as recording:
        assert recording.n == len(numbers) and recording.verify() == [] and recording.status == "salvaged"
        for i, number in enumerate(numbers):
            frame = known[number]
            assert np.array_equal(recording.points(i), frame["points"])
            assert np.array_equal(recording.cells(i), frame["cells"])
            for name in ("displacement", "von_mises"):
                assert np.array_equal(recording.field(i, name), frame[name])
            assert recording.table["iterations"][i] == frame["iterations"]


@pytest.mark.slow
def test_a_report_says_which_frames_are_good_and_salvage_writes_them(command, valid, damaged):
    with h5py.File(damaged, "r+") as file:
        row = file["restshape/table"][3]
        row["iterations"] += 1
        file["restshape/table"][3] = row
    ended = command("report", damaged)
    assert ended.returncode == 2 and "1 of 12 frames" in ended.stderr and "damaged: 3; good: 0-2, 4-11" in ended.stderr
    assert f"restshape salvage {damaged} --out" in ended.stderr
    out = damaged.with_name("good.vtkhdf")
    ended = command("salvage", damaged, "--out", out, "--json", "a.json")
    assert ended.returncode == 0 and "11 of 12 frames are good: 0-2, 4-11" in ended.stdout, ended.stderr
    good = [0, 1, 2, *range(4, 12)]
    assert json.loads(damaged.with_name("a.json").read_text()) == {"frames": 12, "good": good}
    same_frames(out, valid[1], good)
    ended = command("salvage", damaged, "--out", damaged)
    assert ended.returncode == 2 and "reads" in ended.stderr


def test_a_file_that_is_cut_off_keeps_its_frames(valid, damaged, tmp_path):
    size = damaged.stat().st_size
    os.truncate(damaged, size - 1)
    with pytest.raises(UserError, match="cut off"):
        Recording(damaged)
    good, count = salvage(damaged, tmp_path / "good.vtkhdf")
    assert count == 12 and good == list(range(12))
    same_frames(tmp_path / "good.vtkhdf", valid[1], good)


@pytest.mark.slow
def test_no_flipped_byte_is_drawn_without_a_word_or_ends_in_a_traceback(valid, damaged):
    data, rng = valid[0].read_bytes(), np.random.default_rng(0)
    reported = 0
    with Recording(valid[0]) as recording:
        table, times = recording.table, recording.times
        for place in rng.integers(0, len(data), 80):
            changed = bytearray(data)
            changed[place] ^= 1 << int(rng.integers(8))
            damaged.write_bytes(changed)
            try:
                with Recording(damaged) as other:
                    bad = other.verify()
                    reported += bool(bad)
                    if not bad:
                        assert other.n == 12 and other.header == recording.header
                        assert all(np.array_equal(other.table[k].astype(str), table[k].astype(str)) for k in table)
                        assert np.array_equal(other.times, times)
                        for i, frame in enumerate(valid[1]):
                            assert np.array_equal(other.points(i), frame["points"])
                            assert np.array_equal(other.field(i, "von_mises"), frame["von_mises"])
            except UserError:
                reported += 1
    assert reported > 5


def write_header(file: h5py.File, text: bytes) -> None:
    """Another header, with its checksum gone."""
    del file["restshape/header"]
    file["restshape"].create_dataset("header", data=np.frombuffer(text, "u1"))
    del file["restshape"].attrs["header_checksum"]


def craft(file: h5py.File, name: str) -> None:
    """Does to a recording what no writer of ours does."""
    root = file["VTKHDF"]
    if name == "huge":
        del root["Points"]
        root.create_dataset("Points", (1 << 40, 3), "f8", chunks=(1024, 3))
    elif name == "count":
        root["NumberOfPoints"][0] = 1 << 60
    elif name == "steps":
        root["Steps"].attrs["NSteps"] = 1 << 60
    elif name == "negative":
        root["Steps/PointOffsets"][2] = -5
    elif name == "circle":
        root["PointData/again"] = root
    elif name == "deep":
        write_header(file, b"[" * 200_000 + b"]" * 200_000)
    elif name == "list":
        write_header(file, b"[1]")
    elif name == "title":
        write_header(file, b'{"title": 5}')
    elif name == "quantities":
        write_header(file, b'{"scene_values": {"quantities": [1]}}')
    elif name == "limits":
        write_header(file, b'{"limits": {"peak": 4}}')
    elif name == "header":
        del file["restshape/header"]
        file["restshape"].create_dataset("header", (40 << 30,), "u1", chunks=(1 << 20,))
    elif name == "objects":
        del root["Points"]
        root.create_dataset("Points", (4, 3), h5py.string_dtype())
    elif name == "packed":
        del root["Points"]
        root.create_dataset("Points", data=np.zeros((4, 3)), compression="gzip")
    elif name == "none":
        del root["Points"]
    elif name == "times":
        del root["Steps/Values"]
        root.create_group("Steps/Values")
    elif name == "group":
        del root["Offsets"]
        root.create_group("Offsets")


CRAFTED = (
    *("huge", "count", "steps", "negative", "circle", "deep", "list"),
    *("title", "quantities", "limits", "header", "objects", "packed", "none", "times", "group"),
)


@pytest.mark.parametrize("name", CRAFTED)
def test_crafted_files_end_in_a_message(command, damaged, name):
    with h5py.File(damaged, "r+") as file:
        craft(file, name)
    for words in (("report", damaged), ("salvage", damaged, "--out", "new.vtkhdf")):
        ended = command(*words)
        assert ended.returncode == 2 and "damaged" in ended.stderr, ended.stderr
        assert "Traceback" not in ended.stderr


@pytest.mark.parametrize("lost", ["restshape/header", "restshape/table", "VTKHDF/Steps/PartOffsets", "VTKHDF/Offsets"])
def test_a_recording_without_header_or_index_cannot_be_salvaged_and_that_is_said(command, damaged, lost):
    with h5py.File(damaged, "r+") as file:
        del file[lost]
    ended = command("salvage", damaged, "--out", damaged.with_name("good.vtkhdf"))
    assert ended.returncode == 2 and "header or index cannot be read" in ended.stderr
    assert "record it again" in ended.stderr and "restshape salvage " + str(damaged) not in ended.stderr
    assert not damaged.with_name("good.vtkhdf").exists()


def test_a_table_without_checksums_is_damage(command, damaged):
    with h5py.File(damaged, "r+") as file:
        rows = file["restshape/table"][()]
        del file["restshape/table"]
        file["restshape/table"] = rows[[name for name in rows.dtype.names if name != "checksum"]]
    done = command("report", damaged)
    assert done.returncode == 2 and "its table has no checksums" in done.stderr


def test_points_that_are_no_numbers_are_damage(valid, damaged):
    with h5py.File(damaged, "r+") as file:
        file["VTKHDF/Points"][0] = np.nan
    with Recording(damaged) as recording:
        assert 0 in recording.verify()


@pytest.mark.parametrize("name", ["Types", "Offsets"])
def test_a_flip_in_types_or_offsets_of_one_cell_is_damage_of_the_frames_that_have_it(command, valid, damaged, name):
    with Recording(damaged) as recording:
        last = [i for i in range(recording.n) if recording.topology(i) == recording.topology(recording.n - 1)]
    assert 0 < len(last) < 12
    with h5py.File(damaged, "r+") as file:
        file["VTKHDF"][name][-2] ^= 1
    with Recording(damaged) as recording:
        assert recording.verify() == last
    ended = command("report", damaged)
    assert ended.returncode == 2 and f"{len(last)} of 12 frames are damaged" in ended.stderr
    good = damaged.with_name("good.vtkhdf")
    assert command("salvage", damaged, "--out", good).returncode == 0
    same_frames(good, valid[1], list(range(min(last))))


@pytest.mark.parametrize(
    ("name", "column", "value"),
    [("Points", 2, 5e-324), ("PointData/displacement", 2, 1e-300), ("Connectivity", None, 1 << 40)],
)
def test_what_the_program_does_not_read_is_verified_for_those_who_do(valid, damaged, name, column, value):
    """ParaView reads the third components of plane fields, and indices with all of their bytes."""
    with h5py.File(damaged, "r+") as file:
        dataset = file["VTKHDF"][name]
        place = (0, column) if column is not None else 0
        dataset[place] = dataset[place] + value
    with Recording(damaged) as recording:
        assert 0 in recording.verify() and len(recording.verify()) < recording.n


def test_frames_without_points_are_damage(valid, damaged):
    with h5py.File(damaged, "r+") as file:
        file["VTKHDF/NumberOfPoints"][:] = 0
    with Recording(damaged) as recording:
        assert recording.verify() == list(range(12))


def test_a_goal_that_is_none_is_damage(damaged):
    with h5py.File(damaged, "r+") as file:
        header = {"app": "cantilever", "scene_values": {"goal": {"arc": {"polyline": 5}}}}
        write_header(file, json.dumps(header).encode())
    with Recording(damaged) as recording, pytest.raises(UserError, match=r"damaged: \[goal\]"):
        goals_of(recording)


def test_texts_are_drawn_and_printed_as_they_are(tmp_path):
    figure = new_figure(4.0, 3.0)
    axes = figure.add_subplot()
    axes.set(title="$\\frac{1}$", yscale="log", ylim=(1, 1e3))
    save_picture(figure, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 1000
    assert printable("a\x1b[2Jb\x9b\u202ec\n") == "a[2Jbc\n"
    assert ranges([0, 1, 2, 5, 7, 8]) == "0-2, 5, 7-8"

"""A writer that is killed between any two bytes that it writes leaves all frames that were safe."""

import os
import zlib

import h5py
import numpy as np
import pytest

from restshape.errors import UserError
from restshape.replay.recording import journal
from restshape.replay.recording.recording import Recording
from restshape.replay.recording.vtkhdf import RecordedFrame, Topology, VtkHdfWriter

ROW = np.dtype([("index", "i8"), ("t", "f8"), ("area", "f8")])
BATCHES = (3, 40, 61, 30)
"""Frames of each commit: more than a chunk of the table holds, a second field and a second mesh among them."""


class Disk:
    """All that a writer writes, in its order, and how large its file is at each commit."""

    def __init__(self, monkeypatch):
        self.writes, self.commits = [], []
        put = journal._put

        def kept(file, write):
            # HDF5 uses its buffers again.
            self.writes.append(journal.Write(write.start, bytes(write.data)))
            put(file, write)

        monkeypatch.setattr(journal, "_put", kept)

    def after(self, writer):
        """A commit has ended."""
        self.commits.append((len(self.writes), writer.frames, writer.path.stat().st_size))

    def images(self, every):
        """Files as a kill leaves them before each of some writes, or half-way through it, and the frames safe by then.

        What the first commit writes is left out: by then the file has no name of a recording.
        """
        image = bytearray()
        begun, safe, size = 0, 0, 0
        for ended, frames, size in self.commits:
            image.extend(bytes(max(size - len(image), 0)))
            for k in range(begun, ended):
                write = self.writes[k]
                if safe and k % every == 0:
                    half = len(write.data) // 2 * (k % 2)
                    image[write.start : write.start + half] = write.data[:half]
                    yield bytes(image), safe, k
                image[write.start : write.start + len(write.data)] = write.data
            begun, safe = ended, frames


def recorded(path, monkeypatch, last=True):
    """The writes of a recording of some frames."""
    disk, random = Disk(monkeypatch), np.random.default_rng(0)
    writer = VtkHdfWriter(path, {"title": "a"}, ROW)
    for batch in BATCHES:
        for _ in range(batch):
            i = writer.frames
            if i % 50 == 0:
                writer.append(Topology(random.integers(0, 9, (12, 3)).astype("i4"), 5))
            row = np.array([(i, 0.1 * i, random.random())], dtype=ROW)
            fields = {"u": random.random((9, 2))} | ({"T": random.random(9)} if i > 60 else {})
            writer.append(RecordedFrame(0.1 * i, random.random((9, 2)), fields, {}, row.tobytes()))
        writer.commit()
        disk.after(writer)
    writer.add_header({"title": "b"})
    disk.after(writer)
    if last:
        writer.close("done", {})
        disk.commits.append((len(disk.writes), writer.frames, disk.commits[-1][2]))
    return disk


def test_killed_at_any_write(tmp_path, monkeypatch):
    disk = recorded(tmp_path / "a.vtkhdf", monkeypatch)
    tried, finished = 0, 0
    for image, safe, k in disk.images(every=3):
        killed = tmp_path / "killed.vtkhdf"
        killed.write_bytes(image)
        with Recording(killed) as recording:
            assert recording.n >= safe and recording.verify() == [], f"before write {k}"
            assert recording.header["title"] in {"a", "b"}
            assert recording.table["index"].tolist() == list(range(recording.n))
        tried += 1
        finished += killed.read_bytes() != image
    assert tried > 40 and finished > 20


def test_without_the_journal_most_kills_within_a_commit_lose_the_recording(tmp_path, monkeypatch):
    """What the journal is for: the same files, not finished."""
    disk = recorded(tmp_path / "a.vtkhdf", monkeypatch)
    monkeypatch.setattr("restshape.replay.recording.recording.finish_journal", lambda path: None)
    lost = 0
    for image, safe, _ in disk.images(every=5):
        killed = tmp_path / "killed.vtkhdf"
        killed.write_bytes(image)
        try:
            with Recording(killed) as recording:
                lost += recording.n < safe or recording.verify() != []
        except UserError:
            lost += 1
    assert lost > 5


def test_a_finished_recording_is_as_hdf5_writes_it(tmp_path, monkeypatch):
    recorded(tmp_path / "a.vtkhdf", monkeypatch)
    with h5py.File(tmp_path / "a.vtkhdf") as file:
        assert file["VTKHDF/Steps"].attrs["NSteps"] == sum(BATCHES)
        assert os.stat(tmp_path / "a.vtkhdf").st_size == file.id.get_filesize()


@pytest.fixture
def unfinished(tmp_path, monkeypatch):
    """A recording whose journal waits."""
    disk = recorded(tmp_path / "a.vtkhdf", monkeypatch)
    path = tmp_path / "killed.vtkhdf"
    for image, _, _ in disk.images(every=1):
        path.write_bytes(image)
        with path.open("rb") as file:
            if journal._journal_in(file) is not None:
                return path
    raise AssertionError("no journal waits")


def test_a_journal_that_may_not_be_finished(unfinished, monkeypatch):
    def refuse(self, mode, *_):
        if mode == "r+b":
            raise PermissionError(13, "Permission denied", str(self))
        return open(self, mode)

    monkeypatch.setattr(type(unfinished), "open", refuse)
    with pytest.raises(UserError, match="killed while it wrote") as caught:
        Recording(unfinished)
    assert "chmod u+w" in str(caught.value) and str(unfinished) in str(caught.value)


def test_a_journal_of_a_living_writer_is_left_alone(unfinished, monkeypatch):
    monkeypatch.setattr("restshape.replay.recording.recording._ATTEMPTS", 2)
    before = unfinished.read_bytes()
    with unfinished.open("rb") as writer:
        journal.lock(writer.fileno())
        with pytest.raises(UserError, match="still being written"):
            Recording(unfinished)
    assert unfinished.read_bytes() == before


@pytest.mark.parametrize("place", [-1, -20, -30, -200])
def test_a_damaged_journal_does_nothing(unfinished, place):
    data = bytearray(unfinished.read_bytes())
    data[place if place != -1 else -24] ^= 1
    unfinished.write_bytes(data)
    journal.finish_journal(unfinished)
    assert unfinished.read_bytes() == bytes(data)


def test_a_journal_writes_nothing_beyond_its_own_begin(tmp_path):
    entries = journal._ENTRY.pack(1 << 40, 3) + b"abc"
    path = tmp_path / "hostile"
    path.write_bytes(bytes(64) + entries + journal._FOOTER.pack(journal._MARK, len(entries), zlib.crc32(entries)))
    before = path.read_bytes()
    journal.finish_journal(path)
    assert path.read_bytes() == before


def test_no_room_for_the_journal_leaves_the_file_as_it_was(tmp_path, monkeypatch):
    path = tmp_path / "file"
    path.write_bytes(b"0123456789")
    with path.open("r+b") as opened:
        file = journal.JournaledFile(opened.fileno())
        file.truncate(10)
        file.seek(2)
        file.write(b"ab")
        file.seek(0)
        assert file.read(6) == b"01ab45" and path.read_bytes() == b"0123456789"

        def full(*_):
            raise OSError(28, "No space left on device")

        with monkeypatch.context() as short:
            short.setattr(os, "posix_fallocate", full)
            with pytest.raises(OSError, match="No space"):
                file.settle()
        assert path.read_bytes() == b"0123456789" and not file.settling
        file.settle()
        assert path.read_bytes()[:10] == b"01ab456789"

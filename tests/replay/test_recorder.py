"""The recorder's promises: nothing is lost, nothing is changed, mistakes are reported before the run."""

import errno
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from restshape.errors import UserError
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recorder_start import begun
from restshape.replay.recording.recording import Recording
from restshape.replay.recording.rows import encode_text, row_dtype
from restshape.replay.recording.vtkhdf import NoRoom, VtkHdfWriter

CELLS = np.array([[0, 1, 2]], dtype=np.int32)
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


@pytest.fixture(autouse=True)
def broken_pipes_are_errors():
    """PETSc, which other tests of the same process start, makes them deadly."""
    before = signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    yield
    signal.signal(signal.SIGPIPE, before)


@pytest.fixture(autouse=True)
def real_processes(monkeypatch):
    """Not forked ones, as in other tests."""
    monkeypatch.setattr("restshape.replay.recording.recorder_start.subprocess", subprocess)


@pytest.mark.cli
def test_the_process_imports_no_scenes_nor_what_reads_them():
    """It is ready before PETSc has started."""
    code = "import sys, restshape.replay.recording.recorder_process; print(*sys.modules)"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "h5py" in found and not {"pydantic", "restshape.scene", "petsc4py", "mpi4py"} & set(found)


@pytest.mark.cli
def test_it_imports_neither_mpi_nor_petsc_nor_hdf5():
    loaded = "print({'petsc4py', 'mpi4py', 'h5py'} & set(sys.modules) or 'none')"
    code = f"import sys, restshape.replay.recording.recorder; {loaded}"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "none\n"


def test_mpi_variables_do_not_reach_the_process(tmp_path, monkeypatch):
    for name in ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"):
        monkeypatch.setenv(name, "0")
    with Recorder.start(tmp_path / "a.vtkhdf", {}, {}) as recorder:
        environment = Path(f"/proc/{recorder.process_id}/environ").read_bytes()
        assert b"PATH=" in environment
        assert b"OMPI_" not in environment and b"PMIX_" not in environment and b"PMI_" not in environment
        assert os.getsid(recorder.process_id) != os.getsid(0)


def test_every_kind_of_column_comes_back(tmp_path):
    columns = {"a": "i4", "b": "u1", "c": "f8", "d": "f4", "e": str, "f": "S5", "g": "i8", "h": "?"}
    row = {"a": -7, "b": 200, "c": 0.1, "d": 0.5, "e": "gebrochen – 断", "f": "abc", "g": 1 << 40, "h": True}
    with Recorder.start(tmp_path / "a.vtkhdf", {}, columns) as recorder:
        recorder.topology(CELLS)
        recorder.frame(0.0, CORNERS, {}, {}, row)
        recorder.frame(1.0, CORNERS, {}, {}, {})
        with pytest.raises(ValueError, match="no column is named zz"):
            recorder.frame(2.0, CORNERS, {}, {}, {"zz": 1})
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert {name: values[0] for name, values in recording.table.items()} == row
        assert recording.table["a"][1] == -1 and np.isnan(recording.table["c"][1]) and recording.table["e"][1] == ""
        assert recording.n == 2


def test_long_texts_are_cut_between_characters():
    assert encode_text("abc", 5) == b"abc"
    assert encode_text("ééééé", 8).decode() == "éé…"
    assert row_dtype({"x": str}).itemsize == 480


def test_fields_may_come_late_and_be_left_out(tmp_path):
    with Recorder.start(tmp_path / "a.vtkhdf", {}, {}) as recorder:
        recorder.topology(CELLS)
        recorder.frame(0.0, CORNERS, {}, {}, {})
        recorder.frame(1.0, CORNERS, {"u": CORNERS}, {"s": np.ones(1)}, {})
        recorder.frame(2.0, CORNERS, {"u": 2 * CORNERS}, {}, {})
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert np.isnan(recording.field(0, "u")).all() and recording.field(0, "u").shape == (3, 2)
        assert np.array_equal(recording.field(1, "u"), CORNERS) and np.array_equal(recording.field(2, "u"), 2 * CORNERS)
        assert recording.field(1, "s") == [1.0] and np.isnan(recording.field(2, "s"))
        assert recording.verify() == []


@pytest.mark.parametrize(
    ("fields", "message"),
    [({"u": np.zeros(2)}, "field 'u' has shape"), ({"u": np.zeros((3, 2, 2))}, "field 'u' has shape")],
)
def test_fields_that_do_not_fit_the_mesh_are_refused(tmp_path, fields, message):
    with Recorder.start(tmp_path / "a.vtkhdf", {}, {}) as recorder:
        with pytest.raises(ValueError, match="topology first"):
            recorder.frame(0.0, CORNERS, {}, {}, {})
        recorder.topology(CELLS)
        with pytest.raises(ValueError, match=message):
            recorder.frame(0.0, CORNERS, fields, {}, {})


@pytest.mark.slow
def test_frames_larger_than_the_ring_and_a_full_ring(tmp_path, monkeypatch):
    monkeypatch.setattr("restshape.replay.recording.recorder.RING_BYTES", 1 << 20)
    rng = np.random.default_rng(0)
    known = [rng.random((n, 2)) for n in (1000, 1000, 20000, 20000, 5, *([30000] * 40), 70000, 3)]
    with Recorder.start(tmp_path / "a.vtkhdf", {}, {"i": "i4"}) as recorder:
        for i, points in enumerate(known):
            recorder.topology(CELLS)
            recorder.frame(float(i), points, {"u": points[::-1]}, {}, {"i": i})
    assert recorder.result["stalls"] > 0 and recorder.result["frames"] == len(known)
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.verify() == []
        for i, points in enumerate(known):
            assert np.array_equal(recording.points(i), points)
            assert np.array_equal(recording.field(i, "u"), points[::-1])


def test_the_cost_of_writing_is_reported(tmp_path):
    with Recorder.start(tmp_path / "a.vtkhdf", {}, {}) as recorder:
        recorder.topology(CELLS)
        recorder.frame(0.0, CORNERS, {}, {}, {})
    result = recorder.result
    assert result["bytes"] == (tmp_path / "a.vtkhdf").stat().st_size
    assert 0 < result["cpu_s"] < 60 and result["lag_s"] > 0
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.writer["cpu_s"] == result["cpu_s"]


def test_bad_places_are_reported_before_the_run(tmp_path):
    text = tmp_path / "scene.toml"
    text.write_text("format = 1\n")
    for path, message in [
        (tmp_path / "none" / "a.vtkhdf", "folder of the recording does not exist"),
        (tmp_path, "this is a folder"),
        (text, "is not a recording of restshape"),
        ("/proc/a.vtkhdf", "cannot be written"),
    ]:
        with pytest.raises(UserError, match=message):
            Recorder.start(path, {}, {})
    assert text.read_text() == "format = 1\n"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_an_unwritable_folder_is_reported_before_the_run(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(UserError, match="Permission denied"):
        Recorder.start(tmp_path / "a.vtkhdf", {}, {})


@pytest.mark.slow
def test_a_full_disk_stops_the_replay_and_keeps_what_was_safe(tmp_path):
    path = tmp_path / "a.vtkhdf"
    rng = np.random.default_rng(0)
    points = [rng.random((20000, 2)) for _ in range(7)]
    recorder = Recorder.start(path, {}, {"i": "i4"})
    resource.prlimit(recorder.process_id, resource.RLIMIT_FSIZE, (30 << 20, 30 << 20))
    recorder.topology(CELLS)
    with pytest.raises(UserError, match=r"the disk is full; the first \d+ frames? of the recording") as caught:
        for i in range(2000):
            recorder.frame(float(i), points[i % 7], {}, {}, {"i": i})
    assert str(path) in str(caught.value)
    recorder.close()
    with Recording(path) as recording:
        assert recording.status == "disk full" and recording.n > 0
        assert f"first {recording.n} frame" in str(caught.value)
        assert recording.verify() == []
        assert all(np.array_equal(recording.points(i), points[i % 7]) for i in range(recording.n))


@pytest.fixture
def earlier(tmp_path):
    """A recording that is there already, and its bytes."""
    with Recorder.start(tmp_path / "a.vtkhdf", {"made": "earlier"}, {}) as recorder:
        recorder.topology(CELLS)
        recorder.frame(0.0, CORNERS, {}, {}, {})
    return tmp_path / "a.vtkhdf", (tmp_path / "a.vtkhdf").read_bytes()


@pytest.mark.slow
def test_a_run_without_frames_leaves_an_earlier_recording(earlier):
    path, data = earlier
    recorder = Recorder.start(path, {}, {})
    recorder.add_header({"ranks": 1})
    recorder.topology(CELLS)
    assert recorder.close("interrupted")["frames"] == 0
    assert path.read_bytes() == data and [p.name for p in path.parent.iterdir()] == [path.name]


@pytest.mark.slow
def test_a_recorder_killed_before_its_first_frame_leaves_an_earlier_recording(earlier):
    path, data = earlier
    recorder = Recorder.start(path, {}, {})
    os.kill(recorder.process_id, 9)
    with pytest.raises(UserError, match="ended from outside"):
        recorder.close()
    assert path.read_bytes() == data
    with Recorder.start(path, {"made": "later"}, {}) as recorder:
        recorder.topology(CELLS)
        recorder.frame(0.0, CORNERS, {}, {}, {})
    with Recording(path) as recording:
        assert recording.header == {"made": "later"} and recording.n == 1
    assert [p.name for p in path.parent.iterdir()] == [path.name]


@pytest.mark.slow
def test_a_disk_full_before_the_first_frame_leaves_an_earlier_recording(earlier):
    path, data = earlier
    recorder = Recorder.start(path, {}, {})
    resource.prlimit(recorder.process_id, resource.RLIMIT_FSIZE, (3 << 20, 3 << 20))
    recorder.topology(CELLS)
    # Either call may be the one that hears of it.
    with pytest.raises(UserError, match="the disk is full; the first 0 frames"):
        recorder.frame(0.0, np.zeros((300_000, 2)), {}, {}, {})
        recorder.close()
    assert path.read_bytes() == data and [p.name for p in path.parent.iterdir()] == [path.name]


def test_a_disk_full_at_the_start_leaves_nothing_but_an_earlier_recording(earlier, monkeypatch):
    """Of the first room that is reserved, before there are frames: 1 MB and more."""
    path, data = earlier

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "posix_fallocate", full)
    with pytest.raises(NoRoom):
        VtkHdfWriter(path, {}, row_dtype({}))
    assert path.read_bytes() == data and [p.name for p in path.parent.iterdir()] == [path.name]


def test_a_killed_recorder_is_reported(tmp_path):
    recorder = Recorder.start(tmp_path / "a.vtkhdf", {}, {})
    recorder.topology(CELLS)
    os.kill(recorder.process_id, 9)
    with pytest.raises(UserError, match="ended from outside"):
        for _ in range(1000):
            recorder.frame(0.0, CORNERS, {}, {}, {})
            time.sleep(0.001)


@pytest.mark.cli
def test_before_large_libraries_the_process_is_a_copy(tmp_path):
    """One with PETSc or HDF5 loaded is not copied: the copy would have theirs."""
    code = (
        "import os, sys\n"
        "from restshape.replay.recording.recorder import Recorder\n"
        "from restshape.replay.recording.recorder_start import begun\n"
        "process = begun()\n"
        "print(type(process.process).__name__)\n"
        "with Recorder.start('a.vtkhdf', {'title': 'copy'}, {}, process=process) as recorder:\n"
        "    folder = f'/proc/{recorder.process_id}/'\n"
        "    print(open(folder + 'comm').read().strip(), len(os.listdir(folder + 'fd')) < 12)\n"
        "    print(os.getsid(recorder.process_id) != os.getsid(0))\n"
        "print(recorder.result['status'])\n"
        "import h5py\n"
        "print(type(begun().process).__name__)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.stdout.split("\n") == ["Copy", "recorder True", "True", "done", "Popen", ""], done.stderr


def test_a_process_that_has_nothing_to_write_ends():
    process = begun()
    process.abandon()
    assert process.process.poll() is not None


def test_a_field_with_another_number_of_values_is_refused_and_frames_before_are_kept(tmp_path):
    path = tmp_path / "a.vtkhdf"
    wrong = pytest.raises(UserError, match="stress at a cell, 6 so far, and here there are 3")
    with wrong, Recorder.start(path, {}, {}) as recorder:
        recorder.topology(CELLS)
        for components in (6, 3):
            recorder.frame(0.0, CORNERS, {}, {"stress": np.zeros((1, components))}, {})
    with Recording(path) as recording:
        assert recording.n == 1


def test_a_limit_of_file_sizes_is_named():
    """The shared memory is a file to the system."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (60 * 1024, before[1]))
    try:
        with pytest.raises(UserError) as refused:
            begun()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert "ulimit -f" in refused.value.do

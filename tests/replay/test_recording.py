"""A recording holds what was recorded, bit for bit, for us and for VTK."""

import json
import time

import h5py
import numpy as np
import pytest
from plates import record_plate

from restshape.errors import UserError
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    path = tmp_path_factory.mktemp("recording") / "plate.vtkhdf"
    return path, record_plate(path, frames=12, remesh_every=4)


def test_round_trip_bit_for_bit(plate):
    path, known = plate
    with Recording(path) as recording:
        assert recording.n == len(known) == 12
        assert recording.status == "done" and recording.verify() == []
        for i, frame in enumerate(known):
            points, cells = recording.mesh(i)
            assert np.array_equal(points, frame["points"]) and points.flags.c_contiguous
            assert np.array_equal(cells, frame["cells"]) and cells.dtype == np.int32
            for name in ("displacement", "von_mises"):
                assert np.array_equal(recording.field(i, name), frame[name])
            for name in ("index", "t", "event", "level", "iterations", "ms", "refused", "q_tip"):
                assert recording.table[name][i] == frame[name]
        assert np.isnan(recording.table["min_quality"]).all()
        assert np.array_equal(recording.mesh(-1)[0], known[-1]["points"])


def test_cells_are_stored_once_a_topology_and_points_once_a_change(plate):
    path, known = plate
    meshes = [known[i] for i in (0, 4, 8)]
    moved = [frame for i, frame in enumerate(known) if i % 4 != 3]
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        assert root["NumberOfCells"][()].tolist() == [len(m["cells"]) for m in meshes]
        assert len(root["Connectivity"]) == sum(m["cells"].size for m in meshes)
        assert len(root["Offsets"]) == sum(len(m["cells"]) + 1 for m in meshes)
        assert len(root["Types"]) == sum(len(m["cells"]) for m in meshes)
        assert len(root["Points"]) == sum(len(frame["points"]) for frame in moved)
        assert root["Points"].dtype == np.float64


@pytest.mark.slow
def test_vtk_reads_every_step(plate):
    vtk = pytest.importorskip("vtkmodules.all")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    path, known = plate
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == len(known)
    information, key = reader.GetOutputInformation(0), vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    times = [information.Get(key, i) for i in range(information.Length(key))]
    assert times == [frame["t"] for frame in known]
    for i in (0, 1, 3, 4, 7, 11, 8, 2):
        reader.UpdateTimeStep(times[i])
        grid = reader.GetOutput()
        points = vtk_to_numpy(grid.GetPoints().GetData())
        assert points.dtype == np.float64
        assert np.array_equal(points[:, :2], known[i]["points"]) and not points[:, 2].any()
        connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 3)
        assert np.array_equal(connectivity, known[i]["cells"])
        assert {grid.GetCellType(k) for k in range(grid.GetNumberOfCells())} == {vtk.VTK_TRIANGLE}
        displacement = vtk_to_numpy(grid.GetPointData().GetArray("displacement"))
        assert np.array_equal(displacement[:, :2], known[i]["displacement"]) and not displacement[:, 2].any()
        assert np.array_equal(vtk_to_numpy(grid.GetCellData().GetArray("von_mises")), known[i]["von_mises"])


def test_frames_at_the_same_time_stay_apart_in_paraview(tmp_path):
    with Recorder.start(tmp_path / "a.vtkhdf", {}, {"t": "f8"}) as recorder:
        recorder.topology(np.array([[0, 1, 2]]))
        for t in (0.0, 0.0, 0.0, 1.0):
            recorder.frame(t, np.eye(3)[:, :2], {}, {}, {"t": t})
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.table["t"].tolist() == [0, 0, 0, 1]
        assert (np.diff(recording.times) > 0).all() and np.allclose(recording.times, [0, 0, 0, 1], atol=1e-300)


def test_three_dimensional_second_order_cells(tmp_path):
    points, cells = np.random.default_rng(0).random((10, 3)), np.arange(10)[None]
    with Recorder.start(tmp_path / "a.vtkhdf", {}, {}) as recorder:
        recorder.topology(cells)
        recorder.frame(0.0, points, {"u": points, "p": points[:, 0]}, {"stress": np.ones((1, 6))}, {})
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert np.array_equal(recording.points(0), points) and np.array_equal(recording.cells(0), cells)
        assert recording.field(0, "u").shape == (10, 3) and recording.field(0, "stress").shape == (1, 6)
        assert np.array_equal(recording.field(0, "p"), points[:, 0])
    with h5py.File(tmp_path / "a.vtkhdf") as file:
        assert file["VTKHDF/Types"][0] == 24


@pytest.mark.slow
def test_header_is_kept_and_grows(tmp_path):
    header = {"scene": 'title = "é"\n' * 100000, "ranks": 1, "calibration": {"spmv": 1e-9}}
    with Recorder.start(tmp_path / "a.vtkhdf", header, {}) as recorder:
        recorder.add_header({"ranks": 2, "versions": {"petsc": [3, 18]}})
        recorder.topology(np.array([[0, 1, 2]]))
        recorder.frame(0.0, np.eye(3)[:, :2], {}, {}, {})
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.header == header | {"ranks": 2, "versions": {"petsc": [3, 18]}}
        assert json.dumps(recording.header)
        assert recording.n == 1


@pytest.mark.parametrize("place", ["VTKHDF/Points", "VTKHDF/PointData/displacement", "VTKHDF/CellData/von_mises"])
def test_verify_finds_one_flipped_bit(plate, tmp_path, place):
    path, _ = plate
    damaged = tmp_path / "damaged.vtkhdf"
    damaged.write_bytes(path.read_bytes())
    with h5py.File(damaged, "r+") as file:
        row = file[place][5:6]
        row.view("u8").flat[0] ^= np.uint64(1)
        file[place][5:6] = row
    with Recording(damaged) as recording:
        assert recording.verify() == [0]


def test_verify_finds_a_changed_row_and_changed_cells(plate, tmp_path):
    path, _ = plate
    damaged = tmp_path / "damaged.vtkhdf"
    damaged.write_bytes(path.read_bytes())
    with h5py.File(damaged, "r+") as file:
        row = file["restshape/table"][2]
        row["iterations"] += 1
        file["restshape/table"][2] = row
        file["VTKHDF/Connectivity"][-1] += 1
    with Recording(damaged) as recording:
        assert recording.verify() == [2, 8, 9, 10, 11]


def test_what_is_no_recording_is_refused(tmp_path):
    (tmp_path / "text.vtkhdf").write_text("hello")
    with h5py.File(tmp_path / "other.vtkhdf", "w") as file:
        file["x"] = 1
    for name, message in [
        ("none", "no such"),
        ("text", "not an HDF5 file"),
        ("other", "or it is damaged"),
    ]:
        with pytest.raises(UserError, match=message):
            Recording(tmp_path / f"{name}.vtkhdf")


def test_unknown_fields_and_frames_are_refused(plate):
    with Recording(plate[0]) as recording:
        with pytest.raises(UserError, match="use one of: displacement, von_mises"):
            recording.field(0, "stress")
        with pytest.raises(IndexError):
            recording.mesh(12)


def test_a_recording_that_is_being_written_is_reported(tmp_path, monkeypatch):
    monkeypatch.setattr("restshape.replay.recording.recording._PAUSE", 0.0)
    with Recorder.start(tmp_path / "a.vtkhdf", {}, {}) as recorder:
        recorder.topology(np.array([[0, 1, 2]]))
        recorder.frame(0.0, np.eye(3)[:, :2], {}, {}, {})
        deadline = time.monotonic() + 10
        while not (tmp_path / "a.vtkhdf").exists() and time.monotonic() < deadline:
            time.sleep(0.01)
        with pytest.raises(UserError, match="still being written"):
            Recording(tmp_path / "a.vtkhdf")

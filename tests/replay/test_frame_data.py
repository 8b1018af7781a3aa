"""Recorded fields on request, numbers of frames as field data that vtk reads, and the origin that results name."""

import csv
import json

import numpy as np
import pytest
from small_scenes import plate, write_scene, write_script
from vibrating import SHAKEN, dynamics, tower

from restshape import __version__
from restshape.cli.main import main
from restshape.errors import UserError
from restshape.replay.recording.frame_data import STATUSES
from restshape.replay.recording.recording import Recording
from restshape.scene.load import load_scene

LIMITED = '\n[quantities]\nsag = { displacement = "x", reduce = "max", max = 0.1 }\n'
FIELDS = ["--fields", "stress, principal,strain"]


def of_vtk(path):
    """Field data (frames,) by name, as vtk's own reader finds them."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    information, found = reader.GetOutputInformation(0), {}
    for i in range(reader.GetNumberOfSteps()):
        reader.UpdateTimeStep(information.Get(Pipeline.TIME_STEPS(), i))
        data = reader.GetOutputDataObject(0).GetFieldData()
        for k in range(data.GetNumberOfArrays()):
            array = data.GetAbstractArray(k)
            (value,) = vtk_to_numpy(array).ravel()
            found.setdefault(array.GetName(), []).append(value)
    return {name: np.array(values) for name, values in found.items()}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A tower in motion that is edited: its recording, the rows of its table, and its JSON."""
    folder = tmp_path_factory.mktemp("frames")
    scene = tower(folder, SHAKEN, dynamics(), "\n[effects.modal]\nmodes = 2\n")
    script = write_script(folder, [{"do": "idle", "frames": 3}])
    out, table, result = folder / "a.vtkhdf", folder / "a.csv", folder / "a.json"
    words = [
        "--edits",
        script,
        "--out",
        out,
        "--csv",
        table,
        "--json",
        result,
        "--set",
        "solve.tolerance=1e-8",
        *FIELDS,
    ]
    assert main(["replay", str(scene), *map(str, words)]) == 0
    with table.open(newline="") as lines:
        return out, list(csv.DictReader(lines)), json.loads(result.read_text())


@pytest.mark.slow
def test_vtk_reads_quantities_and_flags_of_each_frame(recorded):
    path, rows, _ = recorded
    found = of_vtk(path)
    names = [name for name in rows[0] if name.startswith("q_")]
    assert names
    for name in (*names, "time", "f_1", "effective_mass_2", "level", "stale", "predicted"):
        np.testing.assert_allclose(found[name], [float(row[name]) for row in rows], rtol=1e-12, err_msg=name)
    assert not any(name.startswith("ms") or name in ("line", "iterations") for name in found)
    assert len(set(found["time"])) == 4


@pytest.mark.slow
def test_the_constraint_status_is_a_number(tmp_path):
    events = [
        {"do": "set", "key": "loads.pull.traction", "value": [1e12, 0]},
        {"do": "set", "key": "loads.no.force", "value": 1},
    ]
    text = plate().partition("\n[quantities]")[0] + LIMITED
    out = tmp_path / "a.vtkhdf"
    words = ["--edits", str(write_script(tmp_path, events)), "--out", str(out)]
    assert main(["replay", str(write_scene(tmp_path, text)), *words]) == 0
    with Recording(out) as recording:
        words = recording.table["constraint_status"]
    found = of_vtk(out)["constraint_status"]
    assert list(words) == ["holds", "fails", ""]
    assert [STATUSES[k] for k in found[:2]] == [b"holds", b"fails"] and found[2] == -1


def test_requested_fields_agree_with_each_other(recorded):
    """Principal stresses are those of the tensor; strains are those of Hooke's law in plane stress."""
    with Recording(recorded[0]) as recording:
        data = {name: recording.field(3, name) for name in recording.fields}
    E, nu = 2e6, 0.3
    xx, yy, xy = (data[f"stress_{key}"] for key in ("xx", "yy", "xy"))
    tensors = np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -1)
    np.testing.assert_allclose(data["min_principal"], np.linalg.eigvalsh(tensors)[:, 0], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(data["max_principal"], np.linalg.eigvalsh(tensors)[:, 1], rtol=1e-9, atol=1e-9)
    along = np.stack([np.cos(data["principal_angle"]), np.sin(data["principal_angle"])], -1)
    stretched = np.einsum("nij,nj->ni", tensors, along)
    np.testing.assert_allclose(stretched, data["max_principal"][:, None] * along, atol=1e-9 * np.abs(xx).max())
    size = np.abs(xx).max() / E
    np.testing.assert_allclose(data["strain_xx"], (xx - nu * yy) / E, atol=1e-8 * size)
    np.testing.assert_allclose(data["strain_xy"], (1 + nu) * xy / E, atol=1e-8 * size)
    np.testing.assert_allclose(data["strain_zz"], -nu * (xx + yy) / E, atol=1e-8 * size)
    assert not data["stress_zz"].any()


def test_results_say_where_they_are_from(recorded):
    path, _, result = recorded
    origin = result["origin"]
    assert origin["scene"].endswith(".toml") and origin["restshape"] == __version__ and origin["machine"]
    assert origin["overrides"] == ["solve.tolerance=1e-8", 'recording.fields=["stress", "principal", "strain"]']
    assert set(origin["units"]) == set(result["quantities"]) and "m" in origin["units"].values()
    with Recording(path) as recording:
        assert {key: recording.header[key] for key in origin} == origin


@pytest.mark.slow
def test_reports_repeat_the_origin(recorded, tmp_path):
    path, _, result = recorded
    words = ["--out", str(tmp_path / "pictures"), "--animation", "none", "--json", str(tmp_path / "report.json")]
    assert main(["report", str(path), *words]) == 0
    assert json.loads((tmp_path / "report.json").read_text())["origin"] == result["origin"]
    assert (tmp_path / "pictures" / "history.png").is_file()


def test_fields_that_there_are_not_are_refused(tmp_path):
    path = write_scene(tmp_path, plate())
    with pytest.raises(UserError, match=r"recording\.fields: the application 'plane' has no fields 'stran'"):
        load_scene(path, ['recording.fields=["stran"]'])


@pytest.mark.parametrize(("large", "order"), [(False, 1), (False, 2), (True, 2)])
def test_strains_of_a_linear_displacement_are_exact(large, order):
    """Of u = H X all strains are (H + H^T) / 2, Green's with H^T H / 2 besides, also in curved cells."""
    from restshape.physics.elasticity.plane_strains import plane_strains

    H = np.array([[2e-2, -7e-3], [4e-3, 5e-2]])
    X = np.array([[0, 0], [2, 0.1], [0.3, 1.5], [1.1, -0.1], [1.2, 0.85], [0.1, 0.7]])[: 3 * order]
    cells, points = np.arange(3 * order, dtype=np.int32)[None], np.array([[0.2, 0.3], [0.6, 0.1]])
    found = plane_strains(X, X @ H.T, cells, points, large, np.array(0.5))
    expected = 0.5 * (H + H.T) + (0.5 * H.T @ H if large else 0.0)
    plane = [expected[0, 0], expected[1, 1], expected[0, 1]]
    np.testing.assert_allclose(found, np.broadcast_to([*plane, -0.5 * (plane[0] + plane[1])], (1, 2, 4)), atol=1e-15)


def test_fields_of_modes_are_refused_with_the_reason(tmp_path):
    scene = plate().replace('app = "plane"', 'app = "modes"').replace("[effects.solid]", "[effects.modal]")
    with pytest.raises(UserError, match="the amplitude of a mode is arbitrary"):
        load_scene(write_scene(tmp_path, scene), ['recording.fields=["stress"]'])

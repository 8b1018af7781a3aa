"""A recording of cloth holds where the cloth lies and where its bodies are, for us and for VTK."""

import json

import numpy as np
import pytest
from cloths import HEAD
from small_scenes import block

from restshape.cli.main import main
from restshape.physics.cloth.contact.body_columns import body_columns, body_row, recorded_bodies
from restshape.replay.recording.recording import Recording
from restshape.scene.bodies import Body

SCENE = f"""
{HEAD}[parameters]
level = "-0.3 m"
{block()}[material.felt]
E = "1 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "1 mm"
[supports.rim]
on = "outline"
fix = ["x", "y", "z"]
[bodies.ball]
sphere = {{ center = [0.5, 0.5, "level"], radius = "25 cm" }}
friction = 0.3
[effects.cloth]
bending = "hinge"
[effects.gravity]
[effects.contact]
[mesh]
size = 0.3
"""
EVENTS = (
    {"format": "restshape-edits", "version": 1, "scene": "cloth.toml", "units": "m"},
    {"t": 0.1, "do": "set", "key": "bodies.ball.sphere.radius", "value": "20 cm", "frames": 2},
    {"t": 0.15, "do": "set", "key": "parameters.level", "value": "-0.4 m"},
    {"t": 0.2, "do": "press", "on": "ball", "at": [0.5, 0.5]},
    {"t": 0.3, "do": "drag", "to": [0.6, 0.4], "frames": 2},
    {"t": 0.4, "do": "release"},
    {"t": 0.5, "do": "undo"},
)


@pytest.fixture(scope="module")
def cloth(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cloth")
    (folder / "cloth.toml").write_text(SCENE)
    (folder / "cloth.jsonl").write_text("\n".join(map(json.dumps, EVENTS)))
    call = ["replay", str(folder / "cloth.toml"), "--edits", str(folder / "cloth.jsonl")]
    assert main([*call, "--out", str(folder / "cloth.vtkhdf"), "--json", str(folder / "cloth.json")]) == 0
    return folder / "cloth.vtkhdf"


def test_bodies_of_each_frame_are_those_of_the_script(cloth):
    with Recording(cloth) as recording:
        assert not any(recording.table["refused"])
        found = [recorded_bodies(recording.table, i) for i in range(recording.n)]
    spheres = [(*bodies["ball"].sphere.center, bodies["ball"].sphere.radius) for bodies in found]
    expected = [(0.5, 0.5, -0.3, radius) for radius in (0.25, 0.225, 0.2)]
    expected += [(0.5 + way, 0.5 - way, -0.4, 0.2) for way in (0.0, 0.0, 0.05, 0.1, 0.1, 0.0)]
    assert np.array(spheres) == pytest.approx(np.array(expected), abs=1e-12)
    assert {bodies["ball"].friction for bodies in found} == {0.3}


def test_the_summary_counts_the_frames_that_converged(cloth, tmp_path, capsys):
    rest = json.loads(cloth.with_suffix(".json").read_text())["rest"]
    with Recording(cloth) as recording:
        table = recording.table
        rests, stays = (np.asarray(table[name]) == 1 for name in ("converged", "tangent_positive_definite"))
        counts = {
            "converged": rests.sum(),
            "tangent_positive_definite": (rests & stays).sum(),
            "untrusted": (rests & [bool(why) for why in table["untrusted"]]).sum(),
            "not_converged": (~rests).sum(),
        }
        assert rest == counts | {"residual": pytest.approx(max(table["residual"]))}
        assert rest["converged"] > 0
    # one step is too few for any cloth that falls
    out = tmp_path / "restless.json"
    words = ["replay", str(cloth.with_suffix(".toml")), "--set", "effects.drape.steps=1", "--json", str(out)]
    assert main(words) == 0
    reported = json.loads(out.read_text())["rest"]
    assert (reported["converged"], reported["tangent_positive_definite"], reported["not_converged"]) == (
        0,
        0,
        1,
    ) and reported["residual"] > 1e-4
    assert f"converged: 0 of 1 frame, 0 of them stable; largest residual {reported['residual']:.1e} of the weight" in (
        capsys.readouterr().out
    )


def test_vtk_warps_the_pattern_to_where_the_cloth_lies(cloth):
    vtk = pytest.importorskip("vtkmodules.all")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    reader, warp = vtk.vtkHDFReader(), vtk.vtkWarpVector()
    reader.SetFileName(str(cloth))
    warp.SetInputConnection(reader.GetOutputPort())
    point_data = vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS
    warp.SetInputArrayToProcess(0, 0, 0, point_data, "displacement")
    with Recording(cloth) as recording:
        for i in (0, 4, 1):
            warp.UpdateTimeStep(recording.times[i])
            X, cells = recording.mesh(i)
            lies = vtk_to_numpy(warp.GetOutput().GetPoints().GetData())
            assert lies[:, :2] == pytest.approx(X + recording.field(i, "displacement")[:, :2], abs=1e-15)
            # Held at its rim, it sags under its weight towards the ball, and goes nowhere up.
            on_rim = (np.abs(X - 0.5) == 0.5).any(axis=1)
            assert not lies[on_rim, 2].any() and (lies[~on_rim, 2] < 0.0).all()
            assert len(vtk_to_numpy(warp.GetOutput().GetCellData().GetArray("tension"))) == len(cells)


BODIES = {
    "table": {"box": {"center": [0, 1, 2], "half": [3, 4, 5], "rotate": [0.1, 0.2, 0.3], "radius": 0.5}},
    "bar": {"capsule": {"start": [0, -1, 0], "end": [0, 1, 0.5], "radius": 0.05}, "friction": 0.4},
    "drum": {"cylinder": {"start": [0, 0, -2], "end": [0, 0, -1], "radius": 0.5, "rounded": 0.01}},
    "floor-2": {"plane": {"point": [0, 0, -1], "normal": [0, 0.6, 0.8]}},
}


def test_all_kinds_of_bodies_come_back_from_their_columns():
    bodies = {name: Body.model_validate(given) for name, given in BODIES.items()}
    row = body_row(bodies, body_columns(bodies))
    assert row["bodies.bar.capsule.end.2"] == 0.5 and len(row) == 11 + 8 + 9 + 7
    table = {name: np.array([value]) for name, value in row.items()}
    assert recorded_bodies(table, 0) == bodies


def test_a_body_that_becomes_of_another_kind_is_not_recorded():
    bodies = {name: Body.model_validate(given) for name, given in BODIES.items()}
    names = body_columns(bodies)
    row = body_row(bodies | {"bar": Body.model_validate({"sphere": {"center": [0, 0, 0], "radius": 1}})}, names)
    table = {name: np.array([row.get(name, np.nan)]) for name in names}
    assert set(recorded_bodies(table, 0)) == {"table", "drum", "floor-2"}

"""Second-order triangles through a replay: reuse equals rebuild, levels, solutions transferred, recordings, two
ranks."""

import json
from pathlib import Path

import numpy as np
import pytest
from restshape_studies.stability.scenery import plate as scenery_plate
from small_scenes import PATCH, PATCH_GRADIENT, across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.application import application
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.replay.columns import columns_of
from restshape.replay.parity import ENTRIES, Parity
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.report.animation import animated_frames
from restshape.report.frames import draw_frames
from restshape.report.scenery import scenery
from restshape.scene.load import load_scene

ORDER = "mesh.order=2"
EVENTS = drag("window", (0.5, 0.5), across((0.5, 0.5), (1.5, 0.5), 40))
FLIPPING = {"relocation": "laplacian", "criterion": "author", "flip_everywhere": True}
A = np.array(PATCH_GRADIENT)


def replayed(folder, name="auto", overrides=(), events=EVENTS, text=None, **changed):
    """A replay of second order of the small plate."""
    scene, script = write_scene(folder, text or plate()), write_script(folder, events)
    return make_replay(scene, script, name, [ORDER, *overrides], **changed)


@pytest.mark.slow
@pytest.mark.parametrize("changed", [{}, FLIPPING], ids=["auto", "flips"])
def test_reuse_equals_rebuild(tmp_path, changed):
    made = replayed(tmp_path, **changed)
    check = Parity(made)
    rows = rows_of(made, lambda row: row.update(check()))
    assert {row["level"] for row in rows} == {0, 1, 2, 3}
    assert sum(row["flips"] for row in rows) > 5
    found = check.summary()
    assert found["holds"] and found["entries"] <= ENTRIES == 1e-13
    assert not any(row["refused"] for row in rows)


@pytest.mark.slow
def test_large_deformation_under_a_following_pressure(tmp_path):
    text = plate().replace("E = 200e9", "E = 2e9").replace("[mesh]", "[effects.large_deformation]\n[mesh]")
    text = text.replace("[mesh]", "[loads.inside]\non = 'window'\npressure = 2e7\n[mesh]")
    made = replayed(tmp_path, text=text, **FLIPPING)
    check = Parity(made)
    rows = rows_of(made, lambda row: row.update(check()))
    assert check.summary()["holds"] and {1, 2, 3} <= {row["level"] for row in rows}
    # The force of a pressure on a closed curve is none, deformed or not.
    assert all(row["q_wall"] == pytest.approx(-1e6, rel=1e-4) for row in rows)


@pytest.mark.parametrize("name", ["auto", "thesis", "refactor", "rebuild"])
def test_linear_displacements_are_exact_with_curved_sides(tmp_path, name):
    script = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.7, 0.6), 12))
    made = replayed(tmp_path, name, events=script, text=PATCH)
    for row in made.frames():
        mesh = made.analysis.space
        assert isinstance(mesh, LagrangeSpace) and len(mesh.curved)
        np.testing.assert_allclose(made.analysis.x, mesh.X @ A.T, atol=1e-13)
        assert row["unknowns"] == 2 * len(mesh.X)


@pytest.mark.slow
def test_guesses_follow_the_nodes_of_flipped_edges(tmp_path, monkeypatch):
    def residuals():
        """Residuals of the last solution as a guess, over the right side, in frames with flips."""
        made, found, last = replayed(tmp_path, guess="last", **FLIPPING), [], []

        def look(mat, b, x, *_):
            r = b.duplicate()
            mat.mult(x, r)
            r.aypx(-1.0, b)
            last[:] = [r.norm() / b.norm()]

        made.analysis.solver.on_solve = look
        rows_of(made, lambda row: found.extend(last if row["level"] == 2 else []))
        return np.array(found)

    follow = residuals()
    monkeypatch.setattr(LagrangeSpace, "interpolate", lambda self, field, interpolations: field)
    stay = residuals()
    # Values that belong to another place add to the forces that the motion itself has brought.
    assert len(follow) == len(stay) > 2
    assert (follow < stay).all() and follow.mean() < 0.9 * stay.mean()


def test_reactions_balance_forces_on_edges_and_points(tmp_path):
    more = "[loads.f]\non = 'c'\nforce = [300, -700]\n[mesh]"
    text = plate().replace('traction = ["100 MPa", 0]', "force = [1e6, 0]").replace("[mesh]", more)
    text = text.replace("[quantities]", "[quantities]\nlift = { reaction = 'y', at = 'left' }")
    for row in rows_of(replayed(tmp_path, overrides=["solve.tolerance=1e-10"], events=EVENTS[:2], text=text)):
        assert row["q_wall"] == pytest.approx(-1e6 - 300, rel=1e-7)
        assert row["q_lift"] == pytest.approx(700, rel=1e-4)


def test_pressure_on_a_curved_hole_has_no_resultant(tmp_path):
    text = plate().replace('on = "right"\ntraction = ["100 MPa", 0]', 'on = "window"\npressure = "100 MPa"')
    text = text.replace("[quantities]", "[quantities]\nlift = { reaction = 'y', at = 'left' }")
    (row,) = rows_of(make_replay(write_scene(tmp_path, text), None, "auto", [ORDER, "solve.tolerance=1e-10"]))
    # Of 100 MPa on 10 mm x 0.3 m: a closed curve is pushed nowhere.
    assert abs(row["q_wall"]) < 1e-6 * 3e5 and abs(row["q_lift"]) < 1e-6 * 3e5


def test_the_area_of_the_round_hole(tmp_path):
    text = plate().replace("[quantities]", "[quantities]\narea = { area = true }")
    (row,) = rows_of(make_replay(write_scene(tmp_path, text), None, "auto", [ORDER]))
    assert row["q_area"] == pytest.approx(2.0 - np.pi * 0.15**2, rel=1e-4)


def test_the_order_may_change_in_a_session(tmp_path):
    events = [{"do": "set", "key": "mesh.order", "value": 2}, {"do": "set", "key": "mesh.order", "value": 1}]
    made = make_replay(write_scene(tmp_path, plate()), write_script(tmp_path, events))
    rows = rows_of(made)
    assert [row["level"] for row in rows] == [3, 3, 3] and not any(row["refused"] for row in rows)
    assert rows[1]["unknowns"] > 3 * rows[0]["unknowns"] and rows[2]["unknowns"] == rows[0]["unknowns"]
    assert rows[2]["q_energy"] == pytest.approx(rows[0]["q_energy"], rel=1e-9)


@pytest.mark.parametrize(
    "text", [plate(), scenery_plate("vibration") + "[effects.dynamics]\ntime_step = 1e-4\nsteps = 3\n"]
)
def test_another_order_is_no_jump_of_the_mesh(tmp_path, text):
    """In motion too, whose state goes to other elements."""
    events = [{"do": "set", "key": "mesh.order", "value": 1}, {"do": "undo"}]
    made = make_replay(
        write_scene(tmp_path, text), write_script(tmp_path, events), overrides=[ORDER, "solve.jumps=true"]
    )
    rows = rows_of(made)
    jumps = [value for row in rows for name, value in row.items() if name.endswith("_jump")]
    assert [row["level"] for row in rows] == [3, 3, 3] and not any(row["refused"] for row in rows)
    assert jumps and np.isnan(jumps).all()


@pytest.mark.slow
def test_a_recording_holds_quadratic_triangles(tmp_path):
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import vtk_to_numpy

    path = tmp_path / "a.vtkhdf"
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, EVENTS)
    known = []
    with Recorder.start(path, {"title": "plate"}, columns_of(load_scene(scene), application("plane"))) as recorder:
        made = make_replay(scene, script, "auto", [ORDER], recorder=recorder)
        for _ in made.frames():
            mesh = made.analysis.space
            known.append((mesh.X.copy(), mesh.cells.copy(), made.analysis.x.copy()))
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    with Recording(path) as recording:
        assert recording.n == len(known) and not recording.verify()
        for i in (0, 7, 20, 42):
            X, cells, x = known[i]
            assert np.array_equal(recording.points(i), X) and np.array_equal(recording.cells(i), cells)
            reader.UpdateInformation()
            reader.UpdateTimeStep(recording.times[i])
            grid = reader.GetOutput()
            assert {grid.GetCellType(k) for k in range(grid.GetNumberOfCells())} == {vtk.VTK_QUADRATIC_TRIANGLE}
            assert np.array_equal(vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 6), cells)
            assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData())[:, :2], X)
            assert np.array_equal(vtk_to_numpy(grid.GetPointData().GetArray("displacement"))[:, :2], x)
            # VTK's own quadratic triangles, cut finely, fill what is round with less error than their chords.
            fine = vtk.vtkDataSetSurfaceFilter()
            fine.SetInputData(grid)
            fine.SetNonlinearSubdivisionLevel(3)
            fine.Update()
            size = vtk.vtkMassProperties()
            size.SetInputData(fine.GetOutput())
            assert size.GetSurfaceArea() == pytest.approx(2.0 - np.pi * 0.15**2, rel=2e-4)
        chosen = animated_frames(recording, 4)
        draw_frames(recording, chosen, scenery(recording), tmp_path / "frames.png")
        assert (tmp_path / "frames.png").stat().st_size > 10_000


@pytest.mark.slow
@pytest.mark.mpi
def test_two_ranks_give_what_one_gives(tmp_path, on_ranks):
    events = drag("window", (0.5, 0.5), across((0.5, 0.5), (1.5, 0.5), 16))
    scene, script = write_scene(tmp_path, plate(0.14)), write_script(tmp_path, events)
    found = []
    for ranks in (1, 2):
        words = ("--edits", script, "--json", f"{ranks}.json", "--set", "solve.tolerance=1e-9", "--set", ORDER)
        words += ("--set", "mesh.relocation=laplacian", "--set", "mesh.criterion=author")
        done = on_ranks(ranks, "replay", scene, *words, "--parity")
        assert done.returncode == 0, done.stdout + done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    one, two = found
    assert (one["ranks"], two["ranks"]) == (1, 2)
    for key in ("frames", "refused", "levels", "unknowns", "elements"):
        assert one[key] == two[key], key
    assert one["levels"]["2"] and one["parity"]["holds"] and two["parity"]["holds"]
    for quantity, values in one["quantities"].items():
        np.testing.assert_allclose(two["quantities"][quantity], values, rtol=1e-5, err_msg=quantity)


@pytest.mark.parametrize("ending", ["inp", "msh"])
def test_an_imported_mesh_gets_nodes_on_its_sides(ending):
    scenes = Path(__file__).parents[1] / "scenes"
    settings = [ORDER, f'mesh.file="../../meshes/bracket.{ending}"']
    made = make_replay(scenes / "bracket.toml", overrides=settings)
    (row,) = rows_of(made)
    mesh, space = made.moving.mesh, made.moving.space
    # Euler: of a plane piece with h holes, nodes - edges + triangles = 1 - h.
    holes = len(mesh.outline.names("hole"))
    assert row["unknowns"] == 2 * (2 * len(mesh.X) + len(mesh.cells) + holes - 1)
    # The bolt hole is round: all of its 16 sides are curved.
    assert len(space.curved) == 16 and row["level"] == 3
    assert row["q_clamp_force"] == pytest.approx(20.0, rel=1e-5)

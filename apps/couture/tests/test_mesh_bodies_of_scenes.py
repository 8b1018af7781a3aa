"""Scenes with bodies of triangles: beside closed forms, edited by events, recorded, and refused."""

import numpy as np
import pytest
from body_meshes import ball, box, write

from restshape import _kernels
from restshape.application import application
from restshape.cli.main import main
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.pictures.drape import recorded_surface
from restshape.replay.recording.recording import Recording
from restshape.scene.load import load_scene, revise

pytestmark = pytest.mark.skipif(not _kernels.has_cgal, reason="bodies of triangles need CGAL")
SCENES = application("couture").folder / "scenes"
PLANE = 'plane = { point = [0.05, 0.05, -0.002], normal = ["sin(slope)", 0, "cos(slope)"] }'
SLAB = 'mesh = { file = "slab.ply", spacing = 0.01, move = [0.05, 0.05, -0.002], turn = [0, "slope", 0] }'
BALL = "sphere = { center = [0.05, 0.05, -0.202], radius = 0.2 }"
FACETS = 'mesh = { file = "ball.ply", spacing = SPACING, move = [0.05, 0.05, -0.202] }'


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def patch(folder, body, *settings):
    """The patch of the incline on another body, and its first frame."""
    X, cells = box((0.2, 0.2, 0.05))
    write(folder / "slab.ply", (X - np.array([0.0, 0.0, 0.05]), cells))
    (folder / "patch.toml").write_text((SCENES / "incline.toml").read_text().replace(PLANE, body))
    return folder / "patch.toml", list(settings)


@pytest.mark.slow
@pytest.mark.parametrize("part, rests", [(0.99, True), (1.01, False)])
def test_a_patch_on_a_slab_slips_at_the_angle_of_friction(tmp_path, part, rests):
    slope = float(np.arctan(0.3 * part))
    path, settings = patch(tmp_path, SLAB, f"parameters.slope={slope!r}", "effects.drape.steps=400")
    # One that slips does so until it hangs over the rim, or falls.
    assert (first_frame(path, settings).row["q_downhill"] < 1e-3) == rests


@pytest.mark.slow
def test_cloth_rests_on_a_ball_of_triangles_as_on_a_ball(tmp_path):
    rest = {}
    for pieces, spacing in ((0, 0.0), (8, 0.02), (16, 0.01)):
        if pieces:
            write(tmp_path / "ball.ply", ball(pieces, 0.2))
        body = FACETS.replace("SPACING", str(spacing)) if pieces else BALL
        settings = "parameters.slope=0.0", "effects.contact.stiffness=6e4"
        path, settings = patch(tmp_path, body, *settings)
        rest[pieces] = first_frame(path, settings).row
    errors = [abs(rest[pieces]["q_potential"] / rest[0]["q_potential"] - 1.0) for pieces in (8, 16)]
    # Facets lie within the ball by the square of their size.
    assert errors[1] < 0.4 * errors[0] and errors[1] < 0.05
    assert all(row["converged"] == 1 for row in rest.values())


def test_numbers_of_a_mesh_body_are_edited_as_others(tmp_path):
    path, _ = patch(tmp_path, SLAB)
    scene = revise(load_scene(path), "bodies.ground.mesh.scale", "1.5")
    form = scene.bodies["ground"].evaluated(scene.parameters).form
    assert form.scale == 1.5 and form.file == "slab.ply" and form.turn[1] == pytest.approx(np.deg2rad(12.0))


@pytest.mark.slow
def test_a_recording_holds_the_surface_that_its_report_draws(tmp_path, capsys):
    path, _ = patch(tmp_path, SLAB)
    assert main(["replay", str(path), "--out", str(tmp_path / "patch.vtkhdf")]) == 0
    (tmp_path / "slab.ply").unlink()
    X, cells = recorded_surface(Recording(tmp_path / "patch.vtkhdf"), "ground")
    assert X.shape == (8, 3) and cells.shape == (12, 3)
    assert main(["report", str(tmp_path / "patch.vtkhdf"), "--out", str(tmp_path), "--animation", "none"]) == 0
    assert (tmp_path / "frames.png").exists()


@pytest.mark.parametrize(
    "change, what",
    [
        (("slab.ply", "none.ply"), "there is no file"),
        (("spacing = 0.01", "scale = 0"), "0 times as large"),
        (("spacing = 0.01", "band = 1e-3"), "contact begins 2 mm from a body whose distance is known within 1"),
        (("spacing = 0.01", 'unit = "kg"'), "kg"),
        (('file = "slab.ply"', "file = 3"), "no name of a file"),
        (('file = "slab.ply"', 'file = "../slab.ply"'), "lies outside|there is no file|\\.\\."),
    ],
)
def test_what_makes_no_body_is_refused_with_its_key(tmp_path, change, what):
    path, _ = patch(tmp_path, SLAB.replace(*change))
    with pytest.raises(UserError, match=what) as refused:
        first_frame(path, [])
    assert "bodies.ground" in str(refused.value) and refused.value.do

"""Pleats of seams: all layers are sewn, cloth keeps its length, the order of the layers, derivatives, refusals."""

import numpy as np
import pytest
from drape_designs import COTTON, DrapeDesign
from small_scenes import head, make_replay, meshed, rows_of, write_scene, write_script

from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.mesh.generate import generate
from restshape.physics.cloth.initial_placement import InitialPlacement
from restshape.physics.cloth.sensitivity.pattern_numbers import draws, pattern_motion
from restshape.physics.cloth.sensitivity.scene_numbers import ChangingNumber
from restshape.scene.load import load_scene
from restshape.shape.build import unchecked_outline

LONG, SHORT, DEPTH = 0.14, 0.10, 0.02
PANEL = """
[panels.{name}]
outline = ["bottom", "right", "top", "left"]
vertices = {{ a = [0, {low}], b = [{width}, {low}], c = [{width}, {high}], d = [0, {high}] }}
turn = ["90 deg", 0, 0]
move = [{left}, 0, {down}]
[panels.{name}.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["{first}", "{last}"] }}
left = {{ line = ["d", "a"] }}
"""
SEAM = '[seams.waist]\nfrom = "frill.top"\nto = "band.bottom"\n'
PLEAT = '[seams.waist.pleats.one]\nat = {at}\ndepth = {depth}\ntoward = "{toward}"\n'
PINS = '[supports.pins]\non = "band"\nfix = ["x", "y", "z"]\n[effects.contact]\nself = true\n'
DART = '[darts.cup]\nedge = "frill.top"\nat = {}\nlength = 0.02\nwidth = 0.006\n'
KNIFE = PLEAT.format(at=0.5, depth="'depth'", toward="end")


def frill(pleats: str = KNIFE, seam: str = SEAM, ends: str = "dc", kind: str = "hinge", size: float = 0.01) -> str:
    """A band that is held, and a longer frill below it with pleats."""
    band = PANEL.format(name="band", low=0, high=0.02, width=SHORT, left=0, down=0, first="c", last="d")
    left = -0.5 * (LONG - SHORT)
    below = PANEL.format(
        name="frill", low=-0.06, high=0, width=LONG, left=left, down=-0.01, first=ends[0], last=ends[1]
    )
    cotton = COTTON.format(kind=kind, bending=2e-6)
    return (
        head("cloth") + f"[parameters]\ndepth = {DEPTH}\n" + cotton + band + below + seam + pleats + PINS + meshed(size)
    )


def sewn_edge(text: str, folder) -> tuple[np.ndarray, np.ndarray, DrapeDesign]:
    """Of the frill's sewn nodes in order: how far along the band they are, in the pattern and at rest [m]."""
    design = DrapeDesign(folder, text)
    line = design.problem.seams.pairs[0].first
    return line.lengths(design.X), design.problem.corners(design.x)[line.nodes], design


def test_cloth_that_is_pleated_keeps_its_length_on_the_shorter_side(tmp_path):
    flat, x, design = sewn_edge(frill(), tmp_path)
    np.testing.assert_allclose(np.linalg.norm(np.diff(x, axis=0), axis=1), np.diff(flat), rtol=5e-3)
    begin = 0.5 * (LONG - DEPTH)
    wanted = np.where(flat < begin, flat, np.where(flat < begin + DEPTH, 2 * begin - flat, flat - 2 * DEPTH))
    np.testing.assert_allclose(x[:, 0], wanted, atol=2e-5)
    assert np.abs(x[:, 1:]).max() < 2e-5 and design.problem.seams.gap(design.problem.corners(design.x)) < 2e-5
    row = design.analysis.row()
    assert row["crossings"] == 0 and not row["untrusted"]
    assert not design.problem.seams.ease_notes()


@pytest.mark.parametrize(
    ("toward", "ends", "sign"), [("end", "dc", -1), ("start", "dc", 1), ("end", "cd", 1)], ids=["end", "start", "drawn"]
)
def test_the_fold_on_the_face_looks_to_the_end_that_is_named(tmp_path, toward, ends, sign):
    """The face of the frill looks along -y: what comes before the first fold lies there, or what follows the second."""
    _, _, design = sewn_edge(frill(PLEAT.format(at=0.5, depth=DEPTH, toward=toward), ends=ends), tmp_path)
    X, x = design.X, design.problem.corners(design.x)
    frill_nodes = np.flatnonzero(design.analysis.space.node_piece == 1)
    corner = X[frill_nodes].min(axis=0)
    across, up = (X[frill_nodes] - corner).T
    row = (up > 0.035) & (up < 0.055)
    begin = 0.5 * (LONG - DEPTH)
    before, after = (
        row & (across > a) & (across < b) for a, b in ((begin - DEPTH, begin), (begin + DEPTH, begin + 2 * DEPTH))
    )
    depth = x[frill_nodes, 1]
    assert sign * (depth[before].mean() - depth[after].mean()) > 1e-3


def test_remainders_of_derivatives_by_the_depth_and_the_place_are_of_second_order(tmp_path):
    _, _, design = sewn_edge(frill(size=0.015), tmp_path)
    for key in ("parameters.depth", "seams.waist.pleats.one.at"):
        number = ChangingNumber(design.scene, design.analysis.state.plan, key)
        s, dX = design.analysis.number_derivatives([key], 1e-10).s[0], pattern_motion(design.analysis.space, number)
        found = [
            float(np.linalg.norm(design.move(h * dX, number.scene_with(number.value + h)) - design.x - h * s))
            for h in (2e-5, 1e-5)
        ]
        assert 1e-10 < found[0] < 0.1 * 2e-5 * np.linalg.norm(s), f"{key}: {found}"
        assert 1.7 < np.log2(found[0] / found[1]) < 2.3, f"{key}: {found}"


def test_a_pleat_that_gets_deeper_keeps_the_mesh_and_the_gathered_length(tmp_path):
    edits = [{"t": 0, "do": "set", "key": "parameters.depth", "value": 0.018, "frames": 2}]
    replay = make_replay(write_scene(tmp_path, frill()), write_script(tmp_path, edits))
    rows = rows_of(replay)
    assert [row["level"] for row in rows[1:]] == [1, 1] and all(row["converged"] for row in rows)
    outline = replay.session.outline
    names = [outline.vertex_names.index(f"frill.waist.one.{fold}") for fold in ("first", "second")]
    first, second = outline.points[names]
    assert np.hypot(*(second - first)) == pytest.approx(0.018)


def test_pleats_begin_in_a_wave_on_each_panel_of_their_side(tmp_path):
    """A side of two frills, with a pleat on the second one: that begins as one frill would, the first stays flat."""
    other = PANEL.format(name="other", low=-0.06, high=0, width=LONG, left=0.13, down=-0.01, first="d", last="c")
    pleat = "[seams.waist.pleats.one]\nedge = 'other.top'\nat = 0.5\ndepth = 0.02\n"
    seam = SEAM.replace('"frill.top"', '["frill.top", "other.top"]')
    heights = []
    for text in (frill(pleat, seam, size=0.015) + other, frill(ends="dc", size=0.015)):
        scene = load_scene(write_scene(tmp_path, text))
        mesh = generate(unchecked_outline(scene.shape), scene.mesh)
        placement = InitialPlacement(scene)
        moved = np.abs(placement.scattered(mesh) - placement.places(mesh))[:, 1]
        heights.append({name: moved[mesh.nodes_of(name)].max() for name in ("frill", "other") if name in text})
    assert heights[0]["frill"] == 0.0
    assert heights[0]["other"] == pytest.approx(heights[1]["frill"]) and heights[1]["frill"] > 1e-3


def test_a_seam_named_pleats_draws_nothing():
    assert draws(("seams", "waist", "pleats", "one", "at")) and not draws(("seams", "pleats", "stiffness"))


def test_folds_of_pleats_are_vertices_of_the_pattern(tmp_path):
    pleats = PLEAT.format(at=0.5, depth=DEPTH, toward="end") + PLEAT.format(
        at=0.2, depth=0.004, toward="start"
    ).replace("pleats.one", "pleats.two")
    scene = load_scene(write_scene(tmp_path, frill(pleats)))
    outline = unchecked_outline(scene.shape)
    entity = outline.entity("frill.top")
    assert len(entity.edges) == 5
    assert scene.shape.kinds()["frill.waist.two.second"] == "vertex"


@pytest.mark.parametrize(
    ("pleats", "seam", "said"),
    [
        (PLEAT.format(at=0.05, depth=DEPTH, toward="end"), SEAM, "beyond an end of 'frill.top', which is 140 mm long"),
        (PLEAT.format(at=0.17, depth=DEPTH, toward="end"), SEAM, "as it is laid, reaches 6.2 mm beyond an end"),
        (KNIFE + KNIFE.replace("pleats.one", "pleats.two").replace("0.5", "0.6"), SEAM, "two pleats overlap"),
        (KNIFE, SEAM.replace('"frill.top"', '["frill.top", "frill.left"]'), "does not say on which edge"),
        ("[seams.waist.pleats.one]\nedge = 'frill.left'\nat = 0.5\ndepth = 0.01\n", SEAM, "is no edge of `from`"),
        (KNIFE, SEAM + 'stitched = "flat"\n', "nothing bends across a seam with pleats"),
        (KNIFE, SEAM + DART.format(0.55), "a dart is where the pleat lies on 'frill.top'"),
        (KNIFE, SEAM + DART.format(0.43), "a dart is where the pleat lies on 'frill.top'"),
    ],
    ids=["off the edge", "off the seam", "overlap", "which", "other", "flat", "round a dart", "at a dart"],
)
def test_pleats_that_have_no_place_are_refused(tmp_path, pleats, seam, said):
    with pytest.raises(UserError, match=said):
        first_frame(write_scene(tmp_path, frill(pleats, seam)))

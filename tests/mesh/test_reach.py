"""What a drag with a reach moves: nodes near what moves of the outline, without a jump at the border."""

import numpy as np
import pytest
import small_scenes
from mesh_samples import qualities
from small_scenes import write_scene
from test_moving import Hand, plate

from restshape.errors import UserError
from restshape.mesh.moving import MovingMesh
from restshape.scene.load import load_scene
from restshape.scene.model import MeshSpec
from restshape.shape.hand import gesture as gestures


def pressed(reach, held="window", size=0.04, **options):
    outline = plate()
    mesh = MovingMesh(outline, MeshSpec(size=size, reach=reach, **options))
    hand = Hand(outline, mesh.spec)
    mesh.update(hand.frame("start", "start"))
    gesture = gestures.drag(outline, outline.entity(held))
    update = mesh.update(hand.frame("press", "none", gesture))
    return mesh, hand, gesture, update


def test_nodes_beyond_the_reach_stay_and_others_fade():
    reach = 0.1
    mesh, hand, gesture, _ = pressed(reach)
    before, cells = mesh.mesh.X.copy(), mesh.mesh.cells
    assert mesh.update(hand.frame("drag", "move", gesture, (0.01, 0.0))).level == 1
    moved = np.linalg.norm(mesh.mesh.X - before, axis=1)
    away = np.linalg.norm(before - (0.3, 0.5), axis=1) - 0.12
    assert moved[away > reach + 1e-3].max() == 0.0
    np.testing.assert_allclose(moved[np.abs(away) < 1e-6], 0.01, rtol=1e-9)
    assert np.flatnonzero(moved).tolist() == mesh.part.nodes.tolist()
    # No side of a triangle takes up more than its share of the way: it is spread over the whole reach.
    jumps = np.abs(moved[cells] - moved[np.roll(cells, 1, axis=1)])
    sides = np.linalg.norm(before[cells] - before[np.roll(cells, 1, axis=1)], axis=2)
    assert (jumps / sides).max() < 3.0 * 0.01 / reach


def test_the_whole_way_to_half_the_reach_keeps_the_connections():
    mesh, hand, gesture, _ = pressed(0.15)
    for k in range(1, 11):
        assert mesh.update(hand.frame("drag", "move", gesture, (0.0075 * k, 0.0))).level == 1
    assert qualities(mesh.mesh.X, mesh.mesh.cells).min() == pytest.approx(mesh.min_quality) and mesh.min_quality > 0.3


@pytest.mark.parametrize("held", ["a", "right", "window"])
def test_all_of_the_outline_that_the_hand_moves_does(held):
    mesh, hand, gesture, _ = pressed(0.001, held)
    frame = hand.frame("drag", "move", gesture, (-0.001, 0.0005))
    mesh.update(frame)
    boundary = mesh._generated.boundary
    np.testing.assert_allclose(
        mesh.mesh.X[boundary.nodes], boundary.values(frame.outline, frame.outline.points), atol=1e-15
    )


def test_a_hand_that_moves_nothing():
    mesh, hand, *_ = pressed(0.1)
    still = gestures.drag(mesh.mesh.outline, mesh.mesh.outline.entity("window"), np.zeros((2, 2)))
    mesh.update(hand.frame("release", "none"))
    update = mesh.update(hand.frame("press", "none", still))
    assert update.part is None and len(mesh.part.nodes) == 0
    assert mesh.update(hand.frame("drag", "move", still, (0.1, 0.0))).level == 1


@pytest.mark.parametrize(("reach", "condensed"), [(0.05, True), (3.0, False), (None, False)])
def test_large_parts_are_not_condensed(reach, condensed):
    assert (pressed(reach)[3].part is not None) is condensed


@pytest.mark.parametrize("kind", ["pmvc", "mvc", "laplacian"])
def test_other_maps_have_no_reach(kind):
    with pytest.raises(ValueError, match=r"mesh\.relocation"):
        MeshSpec(reach=0.1, relocation=kind)


SCENE = small_scenes.plate()


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("0", ("mesh.reach", "greater than 0")),
        ("-1", ("mesh.reach", "greater than 0")),
        ("'3 kg'", ("mesh.reach", "kg")),
        ("far", ("mesh.reach", "far")),
        ("nan", ("mesh.reach", "finite")),
        ("[1]", ("mesh.reach",)),
    ],
)
def test_bad_values_are_refused_with_place_and_remedy(tmp_path, value, words):
    with pytest.raises(UserError) as refused:
        load_scene(write_scene(tmp_path, SCENE), [f"mesh.reach={value}"])
    assert all(word in str(refused.value) for word in words)


@pytest.mark.parametrize(("relocation", "bulges"), [("laplacian", False), (None, True)])
def test_a_reach_that_moves_all_nodes_says_so(caplog, relocation, bulges):
    outline = plate()
    mesh = MovingMesh(outline, MeshSpec(size=0.1, reach=0.1), relocation=relocation)
    hand = Hand(outline, mesh.spec)
    mesh.update(hand.frame("start", "start"))
    gesture = gestures.bend(outline) if bulges else gestures.drag(outline, outline.entity("window"))
    with caplog.at_level("INFO", logger="restshape.mesh"):
        assert mesh.update(hand.frame("press", "none", gesture)).part is None
    assert f"Reach 0.1 m: all nodes move, for {'an arc bends' if bulges else 'springs relax them'}" in caplog.text


def test_auto_is_no_reach(tmp_path):
    assert load_scene(write_scene(tmp_path, SCENE), ["mesh.reach=auto"]).mesh.reach is None
    assert load_scene(write_scene(tmp_path, SCENE), ["mesh.reach=20 mm"]).mesh.reach == pytest.approx(0.02)

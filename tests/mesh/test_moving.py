"""A mesh under a drag: valid in every frame, on its outline, at the level that the rules of reuse give."""

from copy import deepcopy
from types import SimpleNamespace

import numpy as np
import pytest
from mesh_samples import SQUARE, author_ratios, mesh_of, polygon_outline, qualities

from restshape.errors import ReplayProblem
from restshape.mesh import moving
from restshape.mesh.advance import MeshUpdate
from restshape.mesh.mesh import cells_left_of, edges_of_cells
from restshape.mesh.moving import MovingMesh
from restshape.mesh.quality import areas
from restshape.mesh.reconnect import edges_between
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.hand import gesture as gestures
from restshape.shape.hand.gesture import Gesture
from restshape.shape.outline import Outline
from restshape.shape.session import EditFrame

KINDS = ("harmonic", "pmvc", "mvc", "laplacian")


def plate(radius: float = 0.12, x: float = 0.3) -> Outline:
    """A plate of 2 x 1 with a round hole."""
    corners = {"a": [0.0, 0.0], "b": [2.0, 0.0], "c": [2.0, 1.0], "d": [0.0, 1.0]}
    edges = {"bottom": {"line": ["a", "b"]}, "right": {"line": ["b", "c"]}, "top": {"line": ["c", "d"]}}
    spec = {
        "vertices": corners,
        "edges": {**edges, "left": {"line": ["d", "a"]}},
        "outline": ["bottom", "right", "top", "left"],
        "holes": {"window": {"circle": {"center": [x, 0.5], "radius": radius}}},
    }
    return outline_from_spec(ShapeSpec.model_validate(spec))


class Hand:
    """Makes the frames of a drag without a session."""

    def __init__(self, outline: Outline, spec: MeshSpec) -> None:
        self.outline, self.index = outline, 0
        self.scene = SimpleNamespace(mesh=spec)

    def frame(self, do: str, change: str, gesture: Gesture | None = None, c=(0.0, 0.0), scene=None, refused=None):
        outline = self.outline
        if change == "move":
            outline = outline.moved(gesture.points(c))
        self.index += 1
        return EditFrame(self.index - 1, 0.0, 0, do, change, gesture, c, scene or self.scene, refused, outline)


def begin(kind: str, size: float = 0.1, **options) -> tuple[MovingMesh, Hand, Gesture]:
    """A meshed plate whose hole, of few edges, the hand holds."""
    outline = plate()
    mesh = MovingMesh(outline, MeshSpec(size=size, relocation=kind, edges_per_circle=8), **options)
    hand = Hand(outline, mesh.spec)
    assert mesh.update(hand.frame("start", "start")).level == 3
    gesture = gestures.drag(outline, outline.entity("window"))
    press = mesh.update(hand.frame("press", "none", gesture))
    assert press.level == 0
    return mesh, hand, gesture


def check(moving_mesh: MovingMesh, outline: Outline) -> None:
    """Positive triangles that fill the shape, boundary nodes on it, arrays that agree with each other."""
    mesh = moving_mesh.mesh
    assert areas(mesh.X, mesh.cells).min() > 0
    for node in np.flatnonzero(mesh.node_edge >= 0):
        expected = outline.point(int(mesh.node_edge[node]), mesh.node_param[node])[0]
        assert np.abs(mesh.X[node] - expected).max() < 1e-13
    a, b = mesh.X[mesh.facets[:, 0]], mesh.X[mesh.facets[:, 1]]
    enclosed = 0.5 * (a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]).sum()
    assert areas(mesh.X, mesh.cells).sum() == pytest.approx(enclosed, rel=1e-12)
    nodes, _ = edges_of_cells(mesh.cells, len(mesh.X))
    assert np.array_equal(nodes, np.unique(mesh.edge_nodes, axis=0))
    assert np.array_equal(mesh.facet_cell, cells_left_of(mesh.facets, mesh.cells, len(mesh.X)))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("criterion", ["quality", "author"])
def test_a_hole_dragged_there_and_back(kind, criterion):
    mesh, hand, gesture = begin(kind, criterion=criterion)
    steps = np.concatenate([np.linspace(0, 1.2, 25)[1:], np.linspace(1.2, 0, 25)[1:]])
    levels = set()
    for x in steps:
        frame = hand.frame("drag", "move", gesture, (float(x), float(0.2 * np.sin(3 * x))))
        advance = mesh.update(frame)
        levels.add(advance.level)
        check(mesh, frame.outline)
        X, cells = mesh.mesh.X, mesh.mesh.cells
        assert advance.min_quality == pytest.approx(qualities(X, cells).min(), rel=1e-12)
        if advance.level < 3 and criterion == "author":
            assert author_ratios(X, cells).max() < 15
        if advance.level < 3 and criterion == "quality":
            assert qualities(X, cells).min() >= 0.3
        assert (advance.level == 2) == (advance.flips > 0) == (len(advance.changed_cells) > 0)
        assert (advance.level == 3) == (advance.old_mesh is not None)
    assert levels <= {1, 2, 3} and {1, 3} <= levels


@pytest.mark.parametrize("kind", ["harmonic", "pmvc", "mvc"])
def test_nodes_move_by_the_linear_map_and_come_back(kind):
    mesh, hand, gesture = begin(kind)
    start, Psi = mesh.mesh.X.copy(), mesh.Psi
    for c in [(0.01, 0.0), (0.02, -0.01), (0.015, 0.01)]:
        assert mesh.update(hand.frame("drag", "move", gesture, c)).level == 1
        assert np.allclose(mesh.mesh.X, start + c[0] * Psi[0] + c[1] * Psi[1], rtol=0, atol=1e-15)
    mesh.update(hand.frame("drag", "move", gesture, (0.0, 0.0)))
    assert np.array_equal(mesh.mesh.X, start)


def test_versions_show_what_changed():
    mesh, hand, gesture = begin("laplacian", 0.08)
    for x in np.linspace(0, 0.6, 40)[1:]:
        first, topology, geometry = mesh.mesh, mesh.mesh.topology, mesh.mesh.geometry
        cells = first.cells.copy()
        advance = mesh.update(hand.frame("drag", "move", gesture, (float(x), 0.0)))
        if advance.level == 3:
            assert mesh.mesh is not first and mesh.mesh.topology != topology
            continue
        assert mesh.mesh is first and first.geometry != geometry
        assert (first.topology != topology) == (advance.level == 2)
        changed = np.flatnonzero((cells != first.cells).any(axis=1))
        assert np.isin(changed, advance.changed_cells).all()
        others = np.setdiff1d(np.arange(len(cells)), advance.changed_cells)
        assert np.array_equal(cells[others], first.cells[others])


@pytest.mark.parametrize("kind", KINDS)
def test_a_jump_over_forty_percent_of_the_plate_does_not_tunnel(kind):
    mesh, hand, gesture = begin(kind)
    for c in [(0.8, 0.1), (0.0, 0.0), (1.4, -0.2)]:
        frame = hand.frame("drag", "move", gesture, c)
        assert mesh.update(frame).level == 3
        check(mesh, frame.outline)
    nudged = hand.frame("drag", "move", gesture, (1.39, -0.2))
    assert mesh.update(nudged).level == 1
    check(mesh, nudged.outline)


def test_flips_alone_can_save_a_sheared_plate():
    X = np.array([*SQUARE, [0.5, 0.5], [0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]], dtype=float)
    cells = np.array([[0, 5, 8], [5, 4, 8], [5, 1, 6], [5, 6, 4], [4, 6, 7], [6, 2, 7], [8, 4, 7], [8, 7, 3]])
    outline = polygon_outline(SQUARE)
    mesh = MovingMesh(outline, MeshSpec(size=0.5), imported=mesh_of(outline, X, cells))
    hand = Hand(outline, mesh.spec)
    mesh.update(hand.frame("start", "start"))
    before = mesh.mesh
    gesture = gestures.drag(outline, outline.entity("e2"))
    levels = []
    for c in np.linspace(0, 1.6, 17)[1:]:
        frame = hand.frame("drag", "move", gesture, (float(c), 0.0))
        levels.append(mesh.update(frame).level)
        check(mesh, frame.outline)
        if levels[-1] == 2:
            break
    assert levels[-1] == 2 and set(levels[:-1]) == {1} and mesh.mesh is before


def test_idle_refused_and_still_frames_change_nothing():
    mesh, hand, gesture = begin("harmonic")
    mesh.update(hand.frame("drag", "move", gesture, (0.05, 0.0)))
    first, version, X = mesh.mesh, mesh.mesh.geometry, mesh.mesh.X.copy()
    for frame in (
        hand.frame("drag", "move", gesture, (0.05, 0.0)),
        hand.frame("idle", "none"),
        hand.frame("set", "values"),
        hand.frame("drag", "none", gesture, (0.05, 0.0), refused="the hole would leave the plate"),
        hand.frame("release", "none"),
    ):
        assert mesh.update(frame).level == 0
    assert mesh.mesh is first and first.geometry == version and np.array_equal(first.X, X)


def test_a_second_gesture_starts_where_the_first_ended():
    mesh, hand, gesture = begin("harmonic")
    mesh.update(hand.frame("drag", "move", gesture, (0.06, 0.02)))
    hand.outline = hand.outline.moved(gesture.points((0.06, 0.02)))
    entity = hand.outline.entity("window")
    turn = gestures.rotate(hand.outline, entity, hand.outline.centroid(entity))
    for angle in (0.1, 0.2, 0.3):
        frame = hand.frame("rotate", "move", turn, (float(np.cos(angle) - 1), float(np.sin(angle))))
        advance = mesh.update(frame)
        assert advance.level == 1 and ("map" in advance.stages) == (angle == 0.1)
        check(mesh, frame.outline)


def test_bulging_an_arc_is_followed_without_a_linear_basis():
    mesh, hand, _ = begin("harmonic")
    bend = gestures.bend(hand.outline)
    levels = []
    for share in np.linspace(1, 0.6, 9)[1:]:
        frame = hand.frame("arc", "move", bend)
        bulges = hand.outline.bulges.copy()
        bulges[hand.outline.entity("window.1").edges[0]] *= share
        frame.outline = hand.outline.moved(bulges=bulges)
        levels.append(mesh.update(frame).level)
        check(mesh, frame.outline)
    assert levels.count(1) >= 4


def test_the_shape_changes_its_layout_and_the_mesh_its_size():
    mesh, hand, _ = begin("harmonic")
    other = outline_from_spec(ShapeSpec.model_validate({
        "vertices": {"a": [0.0, 0.0], "b": [1.0, 0.0], "c": [0.0, 1.0]},
        "edges": {"e": {"line": ["a", "b"]}, "f": {"line": ["b", "c"]}, "g": {"line": ["c", "a"]}},
        "outline": ["e", "f", "g"],
    }))  # fmt: skip
    hand.outline = other
    advance = mesh.update(hand.frame("insert", "shape"))
    assert advance.level == 3 and advance.old_mesh is not None
    assert areas(mesh.mesh.X, mesh.mesh.cells).sum() == pytest.approx(0.5)
    coarse = len(mesh.mesh.cells)
    finer = SimpleNamespace(mesh=MeshSpec(size=0.05))
    assert mesh.update(hand.frame("set", "mesh", scene=finer)).level == 3
    assert len(mesh.mesh.cells) > 3 * coarse


def test_rebuild_meshes_each_frame_that_moves():
    mesh, hand, gesture = begin("harmonic", regenerate=True)
    seen = {id(mesh.mesh)}
    keep = [mesh.mesh]
    for x in (0.01, 0.02, 0.03):
        frame = hand.frame("drag", "move", gesture, (x, 0.0))
        assert mesh.update(frame).level == 3
        keep.append(mesh.mesh)
        seen.add(id(mesh.mesh))
        check(mesh, frame.outline)
    assert len(seen) == 4
    assert mesh.update(hand.frame("idle", "none")).level == 0


def test_a_frame_without_a_mesh_keeps_the_one_before_and_the_next_recovers(monkeypatch):
    mesh, hand, gesture = begin("harmonic")
    mesh.update(hand.frame("drag", "move", gesture, (0.02, 0.0)))
    kept, X, good = mesh.mesh, mesh.mesh.X.copy(), moving.generate

    def fail(*_):
        raise ReplayProblem("no mesh today")

    monkeypatch.setattr(moving, "generate", fail)
    with pytest.raises(ReplayProblem, match="no mesh today"):
        mesh.update(hand.frame("drag", "move", gesture, (1.2, 0.0)))
    assert mesh.mesh is kept and np.array_equal(kept.X, X)
    monkeypatch.setattr(moving, "generate", good)
    frame = hand.frame("drag", "move", gesture, (1.21, 0.0))
    assert mesh.update(frame).level == 3
    check(mesh, frame.outline)


def state_of(mesh):
    """Bytes and objects that report how a mesh lies."""
    held = mesh.mesh
    arrays = (held.X, held.cells, held.cell_edges, held.edge_nodes, held.facet_cell)
    return id(held), held.outline, held.geometry, mesh.min_quality, *(array.tobytes() for array in arrays)


@pytest.mark.slow
def test_a_frame_whose_relocated_mesh_is_poor_and_has_no_other_is_undone(monkeypatch):
    # Triangles are of low quality, not inverted: the mesh before has already followed when the mesher fails.
    mesh, hand, gesture = begin("harmonic", 0.08)
    good, calls, tried = moving.generate, [], 0

    def fail_once(*words):
        calls.append(words)
        if len(calls) == 1:
            raise ReplayProblem("no mesh today")
        return good(*words)

    monkeypatch.setattr(moving, "generate", fail_once)
    for x in np.linspace(0, 0.6, 241)[1:]:
        frame = hand.frame("drag", "move", gesture, (float(x), 0.0))
        before = state_of(mesh)
        try:
            mesh.update(frame)
        except ReplayProblem:
            tried += 1
            assert state_of(mesh) == before
            assert mesh.update(frame).level == 3
        check(mesh, frame.outline)
    assert tried == 1 and len(calls) > 1


@pytest.mark.parametrize("kind", KINDS)
def test_every_frame_can_be_taken_back_and_done_again(kind):
    mesh, hand, gesture = begin(kind, 0.08)
    other, _, other_gesture = begin(kind, 0.08)
    levels = set()
    for x in np.linspace(0, 0.9, 46)[1:]:
        frame = hand.frame("drag", "move", gesture, (float(x), 0.1 * float(x)))
        before = state_of(mesh)
        levels.add(mesh.update(frame).level)
        mesh.rollback()
        assert state_of(mesh) == before
        mesh.update(frame)
        check(mesh, frame.outline)
        frame.gesture = other_gesture
        other.update(frame)
        assert np.array_equal(mesh.mesh.X, other.mesh.X) and np.array_equal(mesh.mesh.cells, other.mesh.cells)
    assert {1, 3} <= levels and (kind != "laplacian" or 2 in levels)


def test_one_rank_refines_and_all_number_what_it_gives():
    """Places and triangles come from one rank, their order from two at once; each mesh lies on the frame's shape."""
    asked = []

    def shared(*makes):
        asked.append(len(makes))
        return [deepcopy(make()) for make in makes]

    mesh, hand, gesture = begin("harmonic", ranks=2, shared=shared)
    former = mesh.mesh
    assert asked == [1, 2] and len(former.node_offsets) == 3
    mesh.update(hand.frame("drag", "move", gesture, (0.9, 0.0)))
    assert asked == [1, 2] * 2 and mesh.mesh is not former


def test_a_mesh_that_another_rank_refined_lies_on_the_shape_of_the_frame():
    """Else the old mesh on the new shape is taken for one on the shape before, and jumps depend on ranks."""
    mesh, hand, gesture = begin("harmonic", ranks=2, shared=lambda *makes: [deepcopy(make()) for make in makes])
    former = mesh.mesh
    assert former.outline is hand.outline
    frame = hand.frame("scale", "mesh", gesture, (0.0, 0.0))
    update = mesh.update(frame)
    assert update.level == 3 and mesh.mesh is not former and mesh.mesh.outline is frame.outline
    assert [other.before for other in mesh.other_meshes(update.old_mesh)] == [False]


def test_a_drag_repeats_bit_for_bit():
    runs = []
    for _ in range(2):
        mesh, hand, gesture = begin("harmonic", 0.07)
        log = []
        for x in np.linspace(0, 0.9, 31)[1:]:
            advance = mesh.update(hand.frame("drag", "move", gesture, (float(x), 0.1 * float(x))))
            log.append(
                (advance.level, advance.flips, advance.min_quality, mesh.mesh.X.tobytes(), mesh.mesh.cells.tobytes())
            )
        runs.append(log)
    assert runs[0] == runs[1]


def test_outline_edges_never_flip():
    mesh, hand, gesture = begin("laplacian", 0.08)
    for x in np.linspace(0, 0.6, 40)[1:]:
        mesh.update(hand.frame("drag", "move", gesture, (float(x), 0.0)))
        ends = mesh.mesh.edge_nodes[edges_between(mesh.mesh.edge_nodes, mesh.mesh.facets)]
        assert np.array_equal(np.sort(ends, axis=1), np.sort(mesh.mesh.facets, axis=1))


def test_nothing_is_an_idle_frame():
    assert MeshUpdate.nothing().level == 0 and not len(MeshUpdate.nothing().changed_cells)


def test_its_dimension_is_that_of_the_mesh_it_has():
    mesh = MovingMesh(plate(), MeshSpec(size=0.3))
    with pytest.raises(RuntimeError):
        _ = mesh.dim
    mesh.state = SimpleNamespace(generated=SimpleNamespace(mesh=SimpleNamespace(dim=3)))
    assert mesh.dim == 3


@pytest.mark.parametrize("kind", ["harmonic", "pmvc", "mvc", "laplacian"])
@pytest.mark.parametrize("spec", [{}, {"order": 2}, {"levels": 2}])
def test_its_motion_has_the_dimension_of_the_mesh(kind, spec):
    outline = plate()
    mesh = MovingMesh(outline, MeshSpec(size=0.3, relocation=kind, **spec), order_of=lambda scene: spec.get("order", 1))
    hand, gesture = Hand(outline, mesh.spec), gestures.drag(outline, outline.entity("window"))
    mesh.update(hand.frame("start", "start"))
    mesh.update(hand.frame("press", "none", gesture))
    nodes = mesh.field_mesh
    assert mesh.dim == nodes.dim == nodes.X.shape[1]
    assert mesh.field_motion.shape == (2, len(nodes.X), mesh.dim)
    # A unit of the hand's second coefficient takes the nodes of the hole along the second axis.
    np.testing.assert_allclose(
        mesh.field_motion[1][nodes.nodes_of("window")], [[0.0, 1.0]] * len(nodes.nodes_of("window")), atol=1e-12
    )

"""Layers that a frame leads far: friction acts against the way of the frame, in one or in many."""

import numpy as np
import pytest
from drape_designs import COTTON
from scipy.spatial.transform import Rotation
from small_scenes import head, make_replay, meshed, write_scene, write_script
from test_cloth_crossings import grid

from restshape.physics.cloth.contact.collision_surface import CollisionSurface
from restshape.physics.cloth.self_contact.layer_friction import LayerFriction, Touching
from restshape.physics.cloth.self_contact.self_contact import SelfContact, SelfContactValues

PANEL = """
[panels.{name}]
outline = ["bottom", "right", "top", "left"]
at = [0, {at}]
move = [{move}]
[panels.{name}.vertices]
a = [0, 0]
b = [{width}, 0]
c = [{width}, {height}]
d = [0, {height}]
[panels.{name}.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
"""
SHEETS = f"""
{head("cloth")}
{PANEL.format(name="below", at=0, move="0, 0, 0", width=0.2, height=0.1)}
{PANEL.format(name="above", at=0.2, move="0.1, 0.02, 5e-4", width=0.06, height=0.06)}
{COTTON.format(kind="hinge", bending=5e-6).replace("1e-9", "1e-4")}
[supports.below]
on = ["below.bottom", "below.right", "below.top", "below.left"]
fix = ["x", "y", "z"]
[supports.hand]
on = "above.left"
fix = {{ x = 0, y = 0, z = 0 }}
[bodies.table]
plane = {{ point = [0, 0, -0.002], normal = [0, 0, 1] }}
friction = 0.5
[effects.contact]
self = true
self_friction = 0.3
[quantities]
pull = {{ reaction = "x", at = "above.left" }}
{meshed(0.02)}
"""


def pulled(folder, frames: int) -> tuple[np.ndarray, float]:
    """Where a sheet is at last (n, 3) [m] that is pulled by 50 mm over another one, and what it is pulled with [N]."""
    pull = {"t": 0.1, "do": "set", "key": "supports.hand.fix.x", "value": "-0.05 m", "frames": frames}
    replay = make_replay(write_scene(folder, SHEETS), write_script(folder, [pull]))
    rows = list(replay.frames())
    assert all(row["converged"] == 1 for row in rows)
    return replay.analysis.state.problem.corners(replay.analysis.x), rows[-1]["q_pull"]


@pytest.fixture(scope="module")
def at_once(tmp_path_factory):
    return pulled(tmp_path_factory.mktemp("once"), 1)


@pytest.mark.slow
@pytest.mark.parametrize("frames", [4, pytest.param(16, marks=pytest.mark.weekly)])
def test_a_sheet_pulled_over_another_one_ends_alike_in_any_number_of_frames(tmp_path, at_once, frames):
    x, pull = pulled(tmp_path, frames)
    assert pull == pytest.approx(at_once[1], rel=1e-3)
    assert np.linalg.norm(x - at_once[0], axis=1).max() < 5e-5


def test_layers_that_turn_together_have_not_slid_and_those_that_slide_turn_their_way():
    """A sheet is taken around by two radians with the one it lies on, and then along it, in one frame."""
    friction, slip, far = 0.4, 1e-3, 0.2
    X, cells = grid(8)
    above = np.arange(2 * len(X)) >= len(X)
    X, cells = np.vstack([X, 0.4 * X + [2.0, 0.0]]), np.vstack([cells, cells + len(X)])
    x = np.column_stack([X, np.where(above, 0.02, 0.0)]) - np.where(above, 1.79, 0.0)[:, None] * [1.0, 0.0, 0.0]
    contact = SelfContact(CollisionSurface(X, cells), SelfContactValues(0.03, 2.0, friction, slip))
    contact.update_friction(x)
    contact.begin_frame(x)
    turn = Rotation.from_rotvec([0.0, 2.0, 0.0]).as_matrix()
    turned = x @ turn.T
    assert contact.update_friction(turned) == 0.0
    assert contact.history.energy(turned, friction, slip) < 1e-12
    along = turned + np.outer(above, [0.0, far, 0.0])
    contact.update_friction(along)
    history, pushed, after = contact.history, np.zeros_like(x), np.zeros_like(x)
    history.add_forces(along, friction, slip, pushed)
    total = friction * history.touching.forces.sum()
    assert total > 0.0
    # Pairs at the border press aslant.
    np.testing.assert_allclose(pushed[above].sum(axis=0), [0.0, total, 0.0], atol=0.02 * total)
    assert contact.end_frame(along) == pytest.approx(far - slip, rel=1e-3)
    contact.history.add_forces(along, friction, slip, after)
    np.testing.assert_allclose(after, pushed, atol=1e-9 * total)


@pytest.mark.parametrize(("lower", "upper"), [(2e-3, 2e-3), (6e-3, 2e-3), (2e-3, 4e-3)])
def test_friction_acts_against_the_way_around_a_bend_whatever_the_meshes_of_both_layers(lower, upper):
    """A strip is pulled by 80 mm around a rod that another one lies on, which stays."""
    radius, gap, way = 0.01, 5e-4, 0.08

    def strip(along: np.ndarray, r: float) -> np.ndarray:
        """Nodes at both sides of a strip: straight, around the rod by half a turn, and straight back."""
        angle = np.clip(along / r, 0.0, np.pi)
        x = np.minimum(along, 0.0) + r * np.sin(angle) - np.maximum(along - np.pi * r, 0.0)
        return np.array([(a, w, b) for a, b in zip(x, r * np.cos(angle)) for w in (-1e-3, 1e-3)])

    def triangles(stations: int) -> np.ndarray:
        first = 2 * np.arange(stations - 1)
        return np.concatenate([np.add.outer(first, corners) for corners in ((0, 2, 1), (1, 2, 3))])

    below, above = np.arange(0.0, np.pi * radius + lower, lower), np.arange(0.0, np.pi * (radius + gap), upper)
    fixed, size = strip(below, radius), 2 * len(below)
    begin, end = (np.vstack([fixed, strip(above - back, radius + gap)]) for back in (way, 0.0))
    cells = np.vstack([triangles(len(below)), triangles(len(above)) + size])
    # Each node of the upper strip that has gone around by up to 130 degrees, on the edge below it.
    angles = above / (radius + gap)
    touches = np.flatnonzero(angles < np.radians(130.0))
    angles = angles[touches]
    place = angles * radius / lower
    edge = place.astype(int)
    nodes = np.column_stack([size + 2 * touches, 2 * edge, 2 * edge + 2, size + 2 * touches])
    shares = np.column_stack([np.ones(len(edge)), place - edge - 1.0, edge - place, 0.0 * place])
    normals = np.column_stack([np.sin(angles), 0.0 * angles, np.cos(angles)])
    pairs = Touching(nodes, shares, normals, np.ones(len(edge)))
    friction = LayerFriction.none(len(begin)).begun(begin, cells, gap)
    tangents = np.column_stack([np.cos(angles), 0.0 * angles, -np.sin(angles)])
    slid = np.einsum("ma,ma->m", friction.begin.ways(end, pairs), tangents)
    # Half of the angle between the layers is left over.
    np.testing.assert_allclose(slid, way * np.cos(0.5 * angles), atol=0.1 * way)

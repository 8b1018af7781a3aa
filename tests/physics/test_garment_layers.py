"""Layers of garments: cloth out of bodies, panels in order, edges on lines inside a panel, three edges in one seam."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import write_scene
from test_pattern_panels import garment, panel

from restshape import _kernels
from restshape.cli.main import main
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.contact.collision_surface import CollisionSurface
from restshape.physics.cloth.contact.out_of_bodies import brought_out, still_inside, through_words
from restshape.physics.cloth.seams.sewn_neighbours import shared_nodes, with_shared
from restshape.physics.cloth.self_contact.layer_order import LayerOrder, Layers, is_another_order, outer_sides
from restshape.physics.cloth.self_contact.lines_through import lines_through
from restshape.scene.load import load_scene

THICK = 2e-3
POCKET = """
[panels.front.regions]
place = { polygon = [[0.05, 0.03], [0.15, 0.03], [0.15, 0.11], [0.05, 0.11]] }
[seams.pocket]
from = ["pocket.left", "pocket.bottom", "pocket.right"]
to = ["front.place.4", "front.place.1", "front.place.2"]
[supports.front]
on = "front.top"
fix = ["x", "y", "z"]
[effects.cloth]
bending = "hinge"
"""
TURNED = 'turn = ["90 deg", 0, 0]'


def grid(n, side):
    """Places (n n, 3) and triangles of a square in the plane z = 0 around the origin."""
    at = np.linspace(-0.5 * side, 0.5 * side, n)
    x, y = np.meshgrid(at, at, indexing="ij")
    first = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    cells = np.vstack(
        [np.column_stack([first, first + n, first + n + 1]), np.column_stack([first, first + n + 1, first + 1])]
    )
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(n * n)]), cells.astype(np.int32)


@pytest.mark.parametrize(("height", "side"), [(0.03, 1.0), (-0.06, -1.0)])
def test_a_sheet_through_a_ball_comes_out_on_the_nearer_side(height, side):
    """As a cap: every node inside goes up, or down, none around; those outside stay."""
    x, cells = grid(11, 0.4)
    x[:, 2] = height
    found = brought_out([_kernels.Body.sphere((0, 0, 0), 0.1)], x, cells, np.ones(len(x), bool), THICK)
    within = np.linalg.norm(x, axis=1) < 0.1
    assert np.array_equal(found[~within], x[~within])
    assert np.linalg.norm(found[within], axis=1) == pytest.approx(0.1 + THICK, abs=0.02 * THICK)
    assert (side * found[within, 2] >= side * height).all()
    assert len(np.unique(found.round(6), axis=0)) == len(x)


def test_a_sheet_across_the_middle_of_a_ball_goes_one_way_as_a_whole():
    x, cells = grid(11, 0.4)
    found = brought_out([_kernels.Body.sphere((0, 0, 0), 0.1)], x, cells, np.ones(len(x), bool), THICK)
    assert np.abs(found[:, :2] - x[:, :2]).max() < 1e-12
    inside = np.hypot(*x[:, :2].T) < 0.1
    wanted = np.sqrt((0.1 + THICK) ** 2 - (x[inside, :2] ** 2).sum(axis=1))
    assert np.abs(found[inside, 2]) == pytest.approx(wanted, abs=1e-3 * THICK + 1e-4)


def test_a_tube_inside_a_body_is_widened_evenly_and_what_is_held_stays():
    angle, z = (part.ravel() for part in np.meshgrid(np.linspace(0, 6, 25), np.linspace(0, 0.1, 4), indexing="ij"))
    x = np.column_stack([0.05 * np.cos(angle), 0.05 * np.sin(angle), z])
    first = (np.arange(24)[:, None] * 4 + np.arange(3)).ravel()
    cells = np.column_stack([first, first + 4, first + 5]).astype(np.int32)
    movable = np.ones(len(x), bool)
    movable[:4] = False
    body = _kernels.Body.capsule((0, 0, -1), (0, 0, 1), 0.15)
    found = brought_out([body], x, cells, movable, THICK)
    assert np.array_equal(found[:4], x[:4])
    assert found[4:] == pytest.approx(x[4:] * [3.04, 3.04, 1.0], abs=0.02 * THICK)


def sheets(*heights):
    """Squares above each other, each a panel, the first of layer 1, the second of 2, and so on."""
    x, cells = grid(5, 0.2)
    places = np.vstack([x + np.array([0.0, 0.0, z]) for z in heights])
    all_cells = np.vstack([cells + k * len(x) for k in range(len(heights))]).astype(np.int32)
    number = np.repeat(np.arange(len(heights)), len(x))
    order = LayerOrder(1.0 + number, tuple("abc"[: len(heights)]), number, np.ones(len(number)))
    # In the pattern they lie beside each other.
    flat = np.vstack([x[:, :2] + np.array([0.3 * k, 0.0]) for k in range(len(heights))])
    return places, Layers(order, CollisionSurface(flat, all_cells), [_kernels.Body.plane((0, 0, -1), (0, 0, 1))])


def test_layers_in_the_wrong_order_are_put_into_it():
    x, layers = sheets(0.03, 0.02, 0.021)
    assert layers.notes(x) == ["25 nodes of b lie under a lower layer", "25 nodes of c lie under a lower layer"]
    found, ended = layers.in_order(x, np.ones(len(x), bool), 5e-3)
    heights = found[:, 2].reshape(3, 25)
    assert np.ptp(heights, axis=1).max() < 1e-12 and np.array_equal(found[:, :2], x[:, :2])
    assert heights[:, 0] == pytest.approx([0.03, 0.035, 0.04])
    assert ended and not layers.notes(found)


def test_layers_without_bodies_are_seen_from_the_back_of_what_lies_below():
    x, layers = sheets(0.0, -0.01)
    found, _ = Layers(layers.order, layers.surface, ()).in_order(x, np.ones(len(x), bool), 4e-3)
    assert found[25:, 2] == pytest.approx(4e-3)


def test_tubes_without_bodies_in_order_stay_and_others_are_put_into_it():
    """The faces of a tube cancel: each node is seen from the nearest one below."""
    angle, z = (part.ravel() for part in np.meshgrid(np.linspace(0, 2 * np.pi, 25), [0, 0.1, 0.2], indexing="ij"))
    first = (np.arange(24)[:, None] * 3 + np.arange(2)).ravel()
    one = np.vstack(
        [np.column_stack([first, first + 3, first + 4]), np.column_stack([first, first + 4, first + 1])]
    ).astype(np.int32)
    n = len(z)
    number, cells = np.repeat([0, 1], n), np.vstack([one, one + n]).astype(np.int32)
    flat = np.column_stack([np.tile(angle, 2) + 10.0 * number, np.tile(z, 2)])
    order = LayerOrder(1.0 + number, ("in", "out"), number, np.zeros(2 * n))
    layers = Layers(order, CollisionSurface(flat, cells), ())

    def tubes(*radii):
        return np.vstack([np.column_stack([r * np.cos(angle), r * np.sin(angle), z]) for r in radii])

    right = tubes(0.15, 0.16)
    found, ended = layers.in_order(right, np.ones(2 * n, bool), 3e-3)
    assert ended and not layers.notes(right) and np.array_equal(found, right)
    wrong = tubes(0.15, 0.145)
    assert layers.under(wrong)[n:].all()
    found, _ = layers.in_order(wrong, np.ones(2 * n, bool), 3e-3)
    assert not layers.notes(found) and np.hypot(*found[n:, :2].T).min() > 0.15


def test_a_node_within_the_fold_of_a_lower_layer_is_on_its_outer_side():
    x, layers = sheets(0.01, 0.05)
    lower, upper = x[:25], x[25:]
    # Half of the lower one is turned over to above the other half, and the upper one lies between the two.
    back = lower[:, 0] > 0.01
    lower[back] = lower[back] * [-1, 1, 1] + np.array([0.0, 0.0, 0.04])
    upper[:] = upper * [0.3, 0.5, 0.0] + np.array([-0.05, 0.0, 0.03])
    assert not layers.notes(x)
    assert layers.under(x - np.outer(np.arange(50) >= 25, [0, 0, 0.025]))[25:].any()


def test_the_outer_side_of_a_panel_is_that_which_looks_away_from_bodies():
    x, layers = sheets(0.01, 0.02)
    cells = layers.cells.copy()
    cells[len(cells) // 2 :] = cells[len(cells) // 2 :, ::-1]
    assert outer_sides(x, cells, layers.order.node_panel, layers.bodies).tolist() == [1.0, -1.0]
    assert outer_sides(x, cells, layers.order.node_panel, ()).tolist() == [0.0, 0.0]


def test_layers_that_do_not_come_to_their_order_are_reported(monkeypatch):
    monkeypatch.setattr("restshape.physics.cloth.self_contact.layer_order.ROUNDS", 1)
    x, layers = sheets(0.03, 0.02)
    assert not layers.in_order(x, np.ones(len(x), bool), 5e-3)[1]


def test_another_order_is_one_in_which_panels_lie_otherwise():
    order = sheets(0.0, 0.1, 0.2)[1].order
    assert not is_another_order(order, replace(order, node_layer=2.0 * order.node_layer))
    assert is_another_order(order, replace(order, node_layer=-order.node_layer))
    assert is_another_order(None, order) and not is_another_order(order, None)


def test_what_no_way_leads_out_of_bodies_is_counted():
    x = np.array([[0.0, 0, 0.05], [0, 0, 0.0995], [0, 0, 0.2]])
    assert still_inside([_kernels.Body.sphere((0, 0, 0), 0.1)], x, THICK).tolist() == [True, False, False]


def test_edges_that_lie_through_a_body_after_the_way_out_are_reported():
    """Both ends of one go out of a bar on unlike sides; another one is stretched as much, and lies beside it."""
    bar = [_kernels.Body.capsule((-1, 0, 0), (1, 0, 0), 0.05)]
    placed = np.array([[0.0, -0.01, 0.0], [0, 0.01, 0], [0.1, -0.01, 0.1], [0.1, 0.01, 0.1]])
    out = placed + np.array([[0, -0.05, 0], [0, 0.05, 0], [0, -0.05, 0], [0, 0.05, 0]])
    edges = np.array([[2, 3], [0, 1]])
    assert "near (0, 0, 0) mm, where an edge is stretched to 6 times" in through_words(bar, placed, out, edges)
    assert through_words(bar, placed, out, edges[:1]) == "" and through_words(bar, placed, placed, edges) == ""


UNDER = """
[supports.cover]
on = "cover.top"
fix = ["x", "y", "z"]
[bodies.ground]
plane = { point = [0, 0, -0.1], normal = [0, 0, 1] }
[effects.contact]
[effects.cloth]
bending = "hinge"
"""


def test_a_support_that_holds_a_layer_below_a_lower_one_is_refused(tmp_path, capsys):
    lining, cover = (
        panel("lining", "layer = 1", width=0.4, height=0.4),
        panel("cover", "layer = 2", "move = [0.1, 0.1, -0.02]"),
    )
    assert main(["check", str(write_scene(tmp_path, garment(lining, cover, UNDER)))]) == 2
    assert "holds cover below lining, which is of a lower layer" in " ".join(capsys.readouterr().err.split())


def test_lines_meet_all_triangles_of_a_deep_tree():
    x, cells = grid(41, 1.0)
    ways = np.broadcast_to([0.0, 0.0, 1.0], x.shape)
    line, _, way = lines_through(x - 0.1 * ways, ways, x[cells])
    assert set(line) == set(range(len(x))) and way == pytest.approx(0.1)


def test_lines_meet_triangles_where_barycentric_coordinates_say():
    random = np.random.default_rng(3)
    corners = random.normal(size=(40, 3, 3))
    share = random.dirichlet([1, 1, 1], 40)
    places = np.einsum("mk,mka->ma", share, corners)
    ways = random.normal(size=(40, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    far = random.uniform(-2, 2, 40)
    line, cell, way = lines_through(places - far[:, None] * ways, ways, corners)
    own = line == cell
    assert np.array_equal(line[own], np.arange(40)) and way[own] == pytest.approx(far)
    others = places[line] + (way - far[line])[:, None] * ways[line]
    a, b, c = corners[cell].swapaxes(0, 1)
    assert np.abs(np.einsum("ma,ma->m", np.cross(b - a, c - a), others - a)).max() < 1e-9


def test_an_edge_that_two_seams_share_makes_all_that_is_sewn_to_it_neighbours():
    lines = [np.array([0, 1, 2]), np.array([5, 6]), np.array([2, 1, 0]), np.array([8, 9])]
    assert shared_nodes(lines).tolist() == [0, 1, 2]
    assert shared_nodes(lines[:2]).tolist() == []
    # 6 and 9 lie between 1 and 2.
    pairs = np.array([[1, 6], [1, 9], [2, 6], [2, 9]], np.int32)
    assert with_shared(pairs, np.array([1, 2]), 10).tolist() == [[1, 6], [1, 9], [2, 6], [2, 9], [6, 9]]
    assert with_shared(pairs, np.array([], np.int64), 10).tolist() == pairs.tolist()


def test_a_pocket_is_sewn_to_lines_inside_a_panel(tmp_path):
    pocket = panel("pocket", TURNED, "move = [0.05, -0.02, 0.03]", width=0.1, height=0.08)
    text = garment(panel("front", TURNED), pocket, POCKET).replace("tolerance = 1e-8", "tolerance = 1e-4")
    found = first_frame(write_scene(tmp_path, text)).analysis
    row, problem = found.row(), found.problem
    assert row["converged"] and row["crossings"] == 0 and row["seam_gap"] < 1e-4 and not row["untrusted"]
    places, pocket = problem.corners(found.x), problem.mesh.node_piece == 1
    # The face of the pocket bulges by its weight, before the panel.
    assert places[pocket, 1].min() < -1e-3 and np.abs(places[~pocket, 1]).max() < 1e-3


def test_a_line_inside_a_panel_is_not_sewn_flat(tmp_path):
    text = garment(panel("front", TURNED), panel("pocket", TURNED), POCKET.replace("to =", 'stitched = "flat"\nto ='))
    with pytest.raises(UserError, match="inside a panel, where the cloth goes on"):
        load_scene(write_scene(tmp_path, text))


def test_layers_that_pass_through_each_other_are_refused(tmp_path):
    text = garment(panel("front", "layer = 1"), panel("back", "layer = 2"), "[effects.contact]\nself = false")
    with pytest.raises(UserError, match="layers have an order, and self = false"):
        load_scene(write_scene(tmp_path, text))


@pytest.mark.parametrize(("friction", "said"), [(0, True), (0.3, False)])
def test_a_garment_that_neither_supports_nor_friction_hold_is_doubted(tmp_path, capsys, friction, said):
    limb = f"[bodies.limb]\nsphere = {{ center = [0, 0, -1], radius = 0.1 }}\nfriction = {friction}\n[effects.contact]"
    sewn = '[seams.side]\nfrom = "front.left"\nto = "front.right"'
    assert main(["check", str(write_scene(tmp_path, garment(panel("front"), limb, sewn)))]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert ("no body has friction: it may slide off; set bodies.limb.friction" in printed) is said


def test_a_hand_that_holds_a_layer_below_a_lower_one_is_refused(tmp_path, capsys):
    lining, cover = (
        panel("lining", "layer = 1", width=0.4, height=0.4),
        panel("cover", "layer = 2", "at = [1.0, 0.0]", "move = [0.1, 0.1, -0.02]"),
    )
    held = UNDER.replace(
        '[supports.cover]\non = "cover.top"\nfix = ["x", "y", "z"]',
        "[hold]\nat = [1.05, 0.05]\nto = [0.15, 0.15, -0.02]",
    )
    assert main(["check", str(write_scene(tmp_path, garment(lining, cover, held)))]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "hold.to" in said and "it holds cover below lining, which is of a lower layer" in said, said

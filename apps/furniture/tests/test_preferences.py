"""What suggestions keep: symmetry, level, locks; their order; mirrored freedoms against mirrored pieces."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.guidance.preferences import (
    grows,
    kept_modes,
    locked,
    preserved,
    shape_costs,
    way_of_material,
)
from restshape_apps.furniture.guidance.ranked import ranked
from restshape_apps.furniture.guidance.suggested import Suggestion
from restshape_apps.furniture.guidance.support_planks import Reliefs, searched, support_planks
from restshape_apps.furniture.physics.furniture import WEAK, Furniture
from restshape_apps.furniture.pieces import drawn, scales, table
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import FREEDOMS, Piece
from restshape_apps.furniture.shape.symmetry import groups, keeps, mirrors
from restshape_apps.furniture.small_pieces import stretched
from restshape_apps.furniture.tests.furniture_scenes import BENCH, COFFEE_TABLE, HEAD, STEP_STOOL, write_bench

from restshape.errors import UserError
from restshape.scene.load import load_scene
from restshape.scene.plan import plan


def read(tmp_path, text: str) -> Piece:
    path = tmp_path / "piece.toml"
    path.write_text(text)
    return Furniture(piece_of(load_scene(path))).moved()


def bench(tmp_path) -> Piece:
    return Furniture(piece_of(load_scene(write_bench(tmp_path)))).moved()


def after(design: Design, one) -> Piece:
    return one.piece or design.furniture.moved(one.t * one.direction)


def test_mirror_planes_are_found(tmp_path) -> None:
    found = mirrors(bench(tmp_path))
    assert [one.axis for one in found] == [0, 1]
    assert [one.images for one in found] == [(0, 2, 1), (0, 1, 2)]
    # One arm of the scales is longer than the other one; a leg of the table leans.
    assert [one.axis for one in mirrors(scales())] == [1] and mirrors(table()) == ()


@pytest.mark.parametrize("kind", ["bench", "stool"])
def test_mirrored_freedoms_keep_the_piece_symmetric(tmp_path, kind: str) -> None:
    piece = bench(tmp_path) if kind == "bench" else read(tmp_path, STEP_STOOL)
    furniture, planes = Furniture(piece), mirrors(piece)
    free = [tuple(one) for one in furniture.kernel.freedoms()]
    grouped = groups(piece, free, planes)
    assert 0 < len(grouped) < len(free)
    for group in grouped:
        gamma = np.zeros((len(piece.planks), len(FREEDOMS)))
        for plank, number, part in group:
            gamma[plank, number] = 0.01 * part
        assert keeps(piece, furniture.moved(gamma)), group
    # Alone, each of a group of several breaks it.
    for plank, number, _ in next(group for group in grouped if len(group) > 1):
        gamma = np.zeros((len(piece.planks), len(FREEDOMS)))
        gamma[plank, number] = 0.01
        assert not keeps(piece, furniture.moved(gamma))


def test_grouped_modes_have_the_derivative_of_their_sum(tmp_path) -> None:
    furniture = Furniture(read(tmp_path, STEP_STOOL))
    modes = kept_modes(furniture, ())[0]
    assert any(modes.mates)
    for k in range(len(modes)):
        assert modes.directions[k].reshape(-1, 8) == pytest.approx(modes.direction(np.array([k]), np.ones(1)))
    some = modes.some(np.array([len(modes) - 1, 0]))
    assert some.directions == pytest.approx(modes.directions[[len(modes) - 1, 0]])


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["bookshelf", "chair-1", "chair-2", "piece-28", "scales", "shelf-1", "shelf-2", "table"]
)
def test_the_first_suggestion_keeps_symmetry_and_level(name: str) -> None:
    design = Design(drawn(name), Guidance())
    found = design.suggestion_list.found
    if design.furniture.test().valid:
        assert not found
        return
    assert preserved(design.piece, after(design, found[0])) == (True, True)


def test_a_stool_is_mended_on_both_sides(tmp_path) -> None:
    design = Design(read(tmp_path, STEP_STOOL), Guidance())
    found = design.suggestion_list.found
    assert len(found) > 1
    for one in found:
        moved = after(design, one)
        assert preserved(design.piece, moved) == (True, True) and Furniture(moved).test().valid
    # Of each kind the nearest comes first, and these in the order of their ways.
    ways = [way_of_material(design.piece, after(design, one)) for one in found]
    kinds = [one.kind for one in found]
    first = [ways[kinds.index(kind)] for kind in dict.fromkeys(kinds)]
    assert first == sorted(first)
    assert len(set(kinds[: len(set(kinds))])) == len(set(kinds))


@pytest.mark.parametrize("lock", ["height", "upper place", "lower place", "lside level", "upper height"])
def test_locks_are_kept(tmp_path, lock: str) -> None:
    design = Design(read(tmp_path, STEP_STOOL), Guidance(keep=(lock,)))
    name = lock.rpartition(" ")[0]
    for one in design.suggestion_list.found:
        moved = after(design, one)
        old, new = ({p.name: p for p in piece.planks} for piece in (design.piece, moved))
        if lock.endswith("place"):
            assert new[name].corners() == pytest.approx(old[name].corners(), abs=1e-9)
        tops = [max(p.corners()[:, 2].max() for k, p in each.items() if name in ("", k)) for each in (old, new)]
        if lock.endswith("height"):
            assert tops[0] == pytest.approx(tops[1], abs=1e-9)
        assert preserved(design.piece, moved)[0]
    assert design.suggestion_list.found or design.suggestion_list.why


def test_a_lock_is_not_given_up() -> None:
    piece = drawn("shelf-1")
    names = [plank.name for plank in piece.planks]
    free = Furniture(piece)
    locks = tuple(f"{name} place" for name in names)
    assert [len(modes) for modes in kept_modes(free, locks)] == [0]
    found = Design(piece, Guidance(keep=locks)).suggestion_list.found
    # Planks may be added and fasteners changed; nothing that was drawn goes elsewhere or becomes thicker.
    assert {one.kind for one in found} == {"a support plank", "closer fasteners"}
    for one in found:
        for old, new in zip(piece.planks, one.piece.planks):
            assert new.corners() == pytest.approx(old.corners(), abs=1e-6)


THICK = replace(stretched(0.35, 40.0), spacing=0.04)
"""A bench that thicker planks mend."""


@pytest.mark.parametrize(
    ("lock", "thicker"), [("", True), ("level", True), ("height", False), ("seat place", False), ("symmetry", True)]
)
def test_thicker_planks_obey_locks(lock: str, thicker: bool) -> None:
    design = Design.closed(THICK, Guidance(keep=(lock,) if lock else ()))
    found = design.suggestion_list.found
    assert any(one.kind == "thicker planks" for one in found) == thicker
    tops = [max(plank.corners()[:, 2].max() for plank in after(design, one).planks) for one in found]
    if lock == "height":
        assert tops == pytest.approx([max(plank.corners()[:, 2].max() for plank in design.piece.planks)] * len(tops))


def test_support_planks_come_with_their_mirror_images(tmp_path) -> None:
    # A table whose joints all break under two planes of symmetry: one prop would stand under one corner.
    design = Design(read(tmp_path, COFFEE_TABLE), Guidance())
    found = design.suggestion_list.found
    supports = [one for one in found if one.kind == "a support plank"]
    assert supports and "; and its mirror images across x and y" in supports[0].words
    for one in supports:
        new = one.piece.planks[len(design.piece.planks) :]
        # They lie at (+-x, +-y) about the middle.
        assert len(new) == 2 ** len(one.words.rpartition("across ")[2].split(" and ")) > 1, one.words
        assert len({plank.name for plank in new}) == len(new)
        assert np.abs([plank.centre for plank in new]) == pytest.approx(np.abs([new[0].centre] * len(new)), abs=1e-6)
        assert preserved(design.piece, one.piece) == (True, True)
        assert Furniture(one.piece).test().valid == one.valid and supports[0].valid


def test_boards_that_are_images_of_those_that_were_found_are_not_suggested_again(tmp_path) -> None:
    # A post on a foot with a board on either side: boards below the one are those below the other.
    arms = "\n".join(
        f"[planks.{name}]\nfrom = [{x}, 0, 0.4]\nto = [{end}, 0, 0.4]\nwidth = [0, 0.2, 0]\n"
        f'[weights.box-{name}]\non = "{name}"\nmass = "20 kg"\nat = [0.25, 0, 0.5]'
        for name, x, end in (("right", 0.009, 0.25), ("left", -0.009, -0.25))
    )
    text = f"""{HEAD}
[wood]
name = "pine"
thickness = "18 mm"
[fastener]
name = "screw"
spacing = "60 mm"
[planks.foot]
from = [-0.3, 0, 0.009]
to = [0.3, 0, 0.009]
width = [0, 0.3, 0]
[planks.post]
from = [0, 0, 0.018]
to = [0, 0, 0.5]
width = [0, 0.2, 0]
{arms}
[effects.gravity]
"""
    path = tmp_path / "stand.toml"
    path.write_text(text)
    # As drawn: its joints are not closed before.
    piece = piece_of(load_scene(path))
    found = support_planks(weak(piece))
    places = [
        tuple(sorted(tuple(plank.centre.round(4)) for plank in one.piece.planks[len(piece.planks) :])) for one in found
    ]
    assert places and len(set(places)) == len(places)


@pytest.mark.slow
def test_a_lone_plank_comes_after_what_keeps_symmetry(tmp_path) -> None:
    design = Design(read(tmp_path, COFFEE_TABLE), Guidance())
    (prop,) = searched(Reliefs(weak(design.piece)), 1, 36, (), False)
    lone = Suggestion.supported(design.piece, prop)
    assert preserved(design.piece, lone.piece) == (True, False)
    thicker = next(one for one in design.suggestion_list.found if one.kind == "thicker planks")
    order = ranked(design.piece, [(lone, lone.piece), (thicker, thicker.piece)])
    assert order == [thicker, lone]
    # Where symmetry is locked none breaks it.
    assert not locked(design.piece, lone.piece, ["symmetry"]) and locked(design.piece, lone.piece, ["top place"])
    for one in Design(design.piece, Guidance(keep=("symmetry",))).suggestion_list.found:
        assert keeps(design.piece, after(design, one))


def weak(piece: Piece) -> Furniture:
    furniture = Furniture(piece)
    assert furniture.test().flaws == WEAK
    return furniture


def test_material_goes_by_volume(tmp_path) -> None:
    piece = bench(tmp_path)
    moved = piece.placed(
        np.array([plank.centre + (k == 0) * np.array([0.0, 0.0, 0.1]) for k, plank in enumerate(piece.planks)]),
        np.array([plank.axes for plank in piece.planks]),
        np.array([plank.size for plank in piece.planks]),
    )
    volumes = [float(np.prod(plank.size)) for plank in piece.planks]
    assert way_of_material(piece, moved) == pytest.approx(0.1 * volumes[0] / sum(volumes))


@pytest.mark.parametrize(
    ("lock", "what"), [("seat", "cannot be kept"), ("seat level", "no plank"), ("place", "cannot")]
)
def test_a_lock_of_nothing_is_refused(tmp_path, lock: str, what: str) -> None:
    path = write_bench(tmp_path, BENCH + f'\n[effects.guidance]\nkeep = ["{lock}"]\n')
    with pytest.raises(UserError, match=what):
        plan(load_scene(path))


def test_what_a_suggestion_costs_the_shape_is_said(tmp_path) -> None:
    piece = bench(tmp_path)
    furniture, gamma = Furniture(piece), np.zeros((len(piece.planks), len(FREEDOMS)))
    assert shape_costs(piece, piece) == ""
    # The top, 1.2 m long, goes aside along x: still symmetric across y, and longer in all by less than a tenth.
    gamma[piece.index("top"), 0] = 0.05
    assert shape_costs(piece, furniture.moved(gamma)) == "lop-sided across x"
    # Both legs, 0.3 m deep as the top is, are 0.1 m deeper.
    gamma[:] = 0.0
    gamma[[piece.index(name) for name in ("left", "right")], 7] = 0.1
    deeper = furniture.moved(gamma)
    assert shape_costs(piece, deeper) == "400 mm along y in all, not 300 mm" and grows(piece, deeper)
    gamma *= 0.25
    assert shape_costs(piece, furniture.moved(gamma)) == "" and not grows(piece, furniture.moved(gamma))


def test_suggestions_show_what_they_cost() -> None:
    design = Design(scales(), Guidance())
    found = design.suggestion_list.found
    assert found
    for one in found:
        costs = "" if one.settings else shape_costs(design.piece, after(design, one))
        assert one.costs == costs and one.whole.endswith(costs) and costs in one.summary


@pytest.mark.parametrize(("part", "first"), [(0.004, "shape"), (0.05, "fasteners"), (0.3, "fasteners")])
def test_fasteners_come_before_shapes_that_move_more_and_thickness_after(tmp_path, part: float, first: str) -> None:
    piece = bench(tmp_path)
    move = np.zeros((len(piece.planks), len(FREEDOMS)))
    move[:, 0] = part * piece.size
    moved = piece.placed(
        np.array([plank.centre + np.array([part * piece.size, 0, 0]) for plank in piece.planks]),
        np.array([plank.axes for plank in piece.planks]),
        np.array([plank.size for plank in piece.planks]),
    )
    shape = Suggestion("shape", move, 1.0, (0.0, 1.0), True, name="top: move x")
    closer = Suggestion("fasteners", None, 1.0, (0.0, 1.0), True, piece, settings=(("fastener.spacing", 0.02),))
    thicker = Suggestion("thickness", None, 1.0, (0.0, 1.0), True, piece, settings=(("wood.thickness", 0.025),))
    order = ranked(piece, [(thicker, piece), (closer, piece), (shape, moved)])
    assert order[0].words == first and order[-1] is thicker

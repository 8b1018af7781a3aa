"""Ends that nothing holds: what they missed, and by how much."""

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.pieces import SCENES, drawn
from restshape_apps.furniture.session.plank_changes import drawn as drawn_in
from restshape_apps.furniture.shape.free_ends import free_ends, free_ends_at
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.tests.furniture_scenes import BENCH, write_bench

from restshape.scene.load import load_scene

PLACES = ((0.6, 0.51), (0.49, 0.525))
"""Where the ends of the bench's top are in x and z [m], and where they are moved."""


def piece(tmp_path, old: str = "", new: str = "", more: str = ""):
    return piece_of(load_scene(write_bench(tmp_path, BENCH.replace(old, new) + more)))


def rail(start: list[float], end: list[float], width: list[float]) -> str:
    return f"\n[planks.rail]\nfrom = {start}\nto = {end}\nwidth = {width}\n"


@pytest.mark.parametrize("short", [0.03, 0.12, 0.15])
def test_a_leg_that_ends_below_a_board_is_named(tmp_path, short: float) -> None:
    found = piece(tmp_path, "to = [0.5, 0, 0.5]", f"to = [0.5, 0, {0.5 - short}]")
    (one,) = free_ends(found)
    assert one.gap == pytest.approx(short) and one.aside == 0.0 and not one.tilted
    assert one.words(found) == (
        f"right +x is free: {1e3 * short:.4g} mm from top (joints reach 15 mm); "
        f"make right {1e3 * short:.4g} mm longer at +x"
    )


def test_a_leg_that_hangs_above_the_floor_is_named(tmp_path) -> None:
    found = piece(tmp_path, "from = [0.5, 0, 0]", "from = [0.5, 0, 0.08]")
    (one,) = free_ends(found)
    assert (one.other, one.gap) == (-1, pytest.approx(0.08))
    assert one.missed(found) == "right -x is free: 80 mm from the floor (joints reach 15 mm)"
    assert one.words(found) == f"{one.missed(found)}; make right 80 mm longer at -x"


@pytest.mark.parametrize(
    ("start", "end", "width", "words"),
    [
        ([-0.47, 0, 0.2], [0.48, 0, 0.2], [0, 0.1, 0], ["rail -x is free: 20 mm from left"]),
        ([-0.48, 0.21, 0.2], [0.48, 0.21, 0.2], [0, 0.1, 0], ["10 mm beside left", "10 mm beside right"]),
        # Through both legs, whose inner faces are at -0.49 and 0.49 m, by more than joints reach behind a face.
        (
            [-0.6, 0, 0.2],
            [0.59, 0, 0.2],
            [0, 0.1, 0],
            ["make rail 110 mm shorter at -x", "100 mm beyond"],
        ),
        ([-0.76, 0, 0.2], [0.48, 0, 0.2], [0, 0.1, 0], []),
        # Level, its side just reaches that of the legs.
        (
            [-0.49, 0.2, 0.2],
            [0.49, 0.2, 0.2],
            [0, 0.1, 0],
            [f"passes 0 mm beside {leg}, on its +y side; move rail 100 mm along -y" for leg in ("left", "right")],
        ),
        # On edge beside legs 0.3 m wide: its faces are 8 mm off, its middle line 18 mm, all of it on them by 28 mm.
        (
            [-0.49, -0.168, 0.2],
            [0.46, -0.168, 0.2],
            [0, 0, 0.1],
            [
                "rail -x is free: its centre line passes 18 mm beside left, on its -y side; move rail 28 mm along +y",
                "right (joints reach 15 mm); move rail 28 mm along +y and make rail 30 mm longer at +x",
            ],
        ),
        ([-0.48, 0, 0.2], [0.48, 0, 0.2], [0, 0.1, 0], []),
        ([-0.3, 0, 0.2], [0.2, 0, 0.2], [0, 0.1, 0], ["190 mm from left", "290 mm from right"][:1]),
    ],
)
def test_a_rail_that_is_not_joined_says_what_it_missed(tmp_path, start, end, width, words) -> None:
    found = piece(tmp_path, more=rail(start, end, width))
    said = [one.words(found) for one in free_ends(found)]
    assert len(said) == len(words) and all(part in text for part, text in zip(words, said))


def test_a_drawn_rail_notes_its_free_ends(tmp_path) -> None:
    scene = load_scene(write_bench(tmp_path))

    class Event:
        name, start, to, width = "rail", (-0.46, 0.0, 0.2), (0.49, 0.0, 0.2), (0.0, 0.1, 0.0)
        thickness = wood = fastener = None

    _, note = drawn_in(piece_of(scene), scene, Event())
    assert note == "joined: rail on right; rail -x is free: 30 mm from left (joints reach 15 mm)"


def test_pieces_of_the_application_have_no_end_that_missed() -> None:
    assert not {path.stem: found for path in sorted(SCENES.glob("*.toml")) if (found := free_ends(drawn(path.stem)))}


@pytest.mark.parametrize(("length", "gap", "warned"), [(0.7, 0.24, 1), (0.7, 0.26, 0), (0.4, 0.19, 1), (0.4, 0.21, 0)])
def test_near_is_250_mm_or_half_of_the_length_where_that_is_less(tmp_path, length: float, gap: float, warned: int):
    # The legs of the bench have faces at -0.49 and 0.49 m; the rail ends `gap` before the right one.
    far = 0.49 - gap
    found = piece(tmp_path, more=rail([far - length, 0, 0.2], [far, 0, 0.2], [0, 0.1, 0]))
    assert len([one for one in free_ends(found) if one.side == 1 and one.gap > 0.0]) == warned


def test_an_end_above_a_board_moves_down_onto_it(tmp_path) -> None:
    # Flat between legs that end 25 mm below its middle line, it rests on them all once it is half its thickness lower.
    old, new = (
        "".join(f"{end} = [{sign}{x}, 0, {z}]\n" for end, sign in (("from", "-"), ("to", ""))) for x, z in PLACES
    )
    found = piece(tmp_path, old, new)
    ends = free_ends(found, [found.index("top")])
    assert [one.aside for one in ends] == pytest.approx([0.025, 0.025])
    for one in ends:
        assert one.way == pytest.approx((0.0, 0.0, -0.035)) and one.beside == "+z"


def test_a_board_across_legs_that_it_touches_with_a_strip_was_not_drawn_to_end_there(tmp_path) -> None:
    # The legs' faces are at x = -0.49 and 0.49 m, 0.3 m wide: a board of 0.1 m that overlaps them by 10 mm of it goes
    # aside; by 60 mm it is to end there.
    for inside, ends in ((0.01, 0), (0.06, 2)):
        y = 0.2 - inside
        found = piece(tmp_path, more=rail([-0.56, y, 0.2], [0.56, y, 0.2], [0, 0.1, 0]))
        assert len(free_ends(found)) == ends


def test_an_end_is_not_shortened_off_the_planks_that_carry_it(tmp_path) -> None:
    posts = "".join(
        f"\n[planks.post-{k}]\nfrom = [{x}, 0, 0]\nto = [{x}, 0, 0.19]\nwidth = [0, 0.1, 0]\n"
        for k, x in enumerate((-0.53, 0.53))
    )
    across = rail([-0.56, 0.0, 0.2], [0.56, 0.0, 0.2], [0, 0.1, 0])
    assert len(free_ends(piece(tmp_path, more=across))) == 2
    found = piece(tmp_path, more=across + posts)
    assert sum(joint.j == found.index("rail") for joint in found.joints) == 2
    assert not [one for one in free_ends(found) if one.plank == found.index("rail")]


def test_planks_that_lie_elsewhere_have_the_ends_of_the_piece_there(tmp_path) -> None:
    drawn_piece = piece(tmp_path, "to = [0.5, 0, 0.5]", "to = [0.5, 0, 0.4]")
    furniture, gamma = Furniture(drawn_piece), np.zeros((len(drawn_piece.planks), 8))
    gamma[drawn_piece.index("top"), 2] = 0.02
    raw = furniture.kernel.shape(gamma)
    found = free_ends_at(drawn_piece, raw["centre"], raw["axes"], raw["size"])
    assert found and found == free_ends(furniture.moved(gamma)) != free_ends(drawn_piece)

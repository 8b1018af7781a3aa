"""What suggestions say: amounts with units and directions, ranges that stay while they are followed, and why none."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from furniture_scenes import write_edits
from restshape_apps.furniture.cli.guidance import print_guidance
from restshape_apps.furniture.guidance.amounts import along, amount, ends, in_words, named
from restshape_apps.furniture.guidance.design import Design, Guidance, _distinct
from restshape_apps.furniture.guidance.suggested import Suggestion
from restshape_apps.furniture.guidance.support_planks import SupportPlank, support_planks
from restshape_apps.furniture.physics.furniture import UNSTABLE, WEAK, Furniture
from restshape_apps.furniture.pieces import PIECES, SCENES, chair, drawn, joined, scales, shelf_1, table
from restshape_apps.furniture.shape.directions import room_words
from restshape_apps.furniture.shape.plank_edits import added
from restshape_apps.furniture.shape.planks import FREEDOMS, Plank
from small_scenes import make_replay, rows_of

SAID = re.compile(
    r"(?P<plank>\S+) (?P<moved>moved |turned |)(?P<number>[\d.]+) (?P<unit>mm|deg) ?(?P<longer>longer|shorter|)"
)
"""One change of a plank, as suggestions report it."""

INVALID = [name for name, make in PIECES.items() if Furniture(make()).test().flaws & (UNSTABLE | WEAK)]


def test_numbers_have_units() -> None:
    assert [amount(0.0123456, "m"), amount(1.5, "m"), amount(np.pi / 180.0, "rad")] == ["12.3 mm", "1500 mm", "1 deg"]
    assert amount(0.0123456, "m", 6) == "12.3456 mm"


def test_directions_are_those_of_the_room() -> None:
    assert room_words(np.array([0.0, -1.0, 0.0])) == "-y"
    assert room_words(np.array([0.6, 0.0, -0.8])) == "-z and +x"


def test_words_say_what_a_board_does() -> None:
    # Drawn upwards with its width along y: its x is up, its z against x.
    piece = replace(
        table(), planks=(Plank.between("post", (0, 0, 0), (0, 0, 1), (0, 0.1, 0), 0.02),), joints=(), feet=()
    )
    change = np.zeros((1, 8))
    for number, value, said in (
        (2, -0.02, "post moved 20 mm along its -z (towards +x)"),
        (4, np.radians(3.1), "post turned 3.1 deg about its +y (about +y)"),
        (6, 0.012, "post 12 mm longer along its x (at -z and at +z)"),
        (7, -0.5, "post 500 mm shorter along its y (at -y and at +y)"),
    ):
        change[:] = 0.0
        change[0, number] = value
        assert in_words(piece, change) == said
    change[0, 0] = 0.1
    assert named(piece, change) == "post: length y + post: move x"


@pytest.mark.slow
@pytest.mark.parametrize("name", INVALID)
def test_amounts_are_those_of_the_piece_that_is_shown(name) -> None:
    piece = PIECES[name]()
    design = Design(piece)
    found = design.suggestion_list.found
    assert found
    assert len({suggestion.words for suggestion in found}) == len(found)
    for suggestion in found:
        if suggestion.piece is not None:
            continue
        parts = suggestion.words.split("; ")
        assert len(parts) == np.count_nonzero(suggestion.direction)
        for part in parts:
            said = SAID.match(part)
            k, number = piece.index(said["plank"]), freedom(part)
            alone = np.zeros_like(suggestion.direction)
            alone[k, number] = suggestion.t * suggestion.direction[k, number]
            after = design.furniture.moved(alone)
            assert done(piece.planks[k], after.planks[k], said) == pytest.approx(float(said["number"]), rel=6e-3)
        first = SAID.match(parts[0])
        assert float(first["number"]) == pytest.approx(
            suggestion.t * (1e3 if suggestion.unit == "m" else 180 / np.pi), rel=6e-3
        )


def freedom(part: str) -> int:
    """The number of the design parameter that words are about."""
    kind = "turn" if " turned " in part else "move" if " moved " in part else "length"
    axis = re.search(r"(?:along|about) its [+-]?(\w)", part)[1]
    return FREEDOMS.index(f"{kind} {axis}")


def done(before: Plank, after: Plank, said: re.Match) -> float:
    """What a plank has done, in mm or degrees, as measured on the two of them."""
    if said["unit"] == "deg":
        turn = before.axes.T @ after.axes
        return float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0))))
    if said["longer"]:
        axis = "xyz".index(re.search(r"along its (\w)", said.string)[1])
        grown = float(after.size[axis] - before.size[axis])
        return 1e3 * (grown if said["longer"] == "longer" else -grown)
    axis = "xyz".index(re.search(r"along its [+-](\w)", said.string)[1])
    sign = 1.0 if f"its +{'xyz'[axis]}" in said.string else -1.0
    return 1e3 * sign * float(before.axes[:, axis] @ (after.centre - before.centre))


@pytest.mark.parametrize("make", [table, shelf_1, scales], ids=lambda make: make.__name__)
def test_the_range_that_is_shown_while_sliding_is_the_one_that_was_reported(make) -> None:
    design = Design(make())
    for suggestion in design.suggestion_list.found:
        if suggestion.piece is not None:
            continue
        way = design.followed(suggestion)
        ranges = way.ranges
        assert ranges.holds(suggestion.t)
        low, high = next(pair for pair in ranges.intervals if pair[0] <= suggestion.t <= pair[1])
        assert low == pytest.approx(suggestion.span[0], abs=4e-6 * way.high)
        # Between the few tests of a list narrow gaps may hide; none is wider than what was reported.
        assert high <= suggestion.span[1] + 4e-6 * way.high
        assert suggestion.beyond[1] == (suggestion.span[1] >= way.high * (1.0 - 1e-9))
        unit = {"m": "mm", "rad": "deg"}[suggestion.unit]
        assert suggestion.range_words.startswith("valid from ") and f" {unit}" in suggestion.range_words
        assert ("or beyond" in suggestion.range_words) == suggestion.beyond[1]


def test_turned_and_lengthened_planks_have_different_units() -> None:
    units = {
        suggestion.name.split(": ")[1].split()[0]: suggestion.unit
        for suggestion in Design(table()).suggestion_list.found
        if suggestion.unit
    }
    assert {units[kind] for kind in units if kind != "turn"} == {"m"}
    assert units.get("turn", "rad") == "rad"


def test_why_there_is_no_suggestion() -> None:
    one = Design(scales(kilograms=20.0), Guidance(freedoms=1)).suggestion_list
    assert one.found == ()
    assert re.match(r"\d+ combinations of at most 1 freedoms tried", one.why)
    assert "effects.guidance.freedoms" in one.why
    piece = chair()
    seat, stretcher = (piece.index(name) for name in ("seat", "stretcher"))
    raised = np.zeros((len(piece.planks), 8))
    raised[stretcher, 2] = float(
        piece.planks[stretcher].axes[:, 2] @ (piece.planks[seat].centre - piece.planks[stretcher].centre)
    )
    assert "mm along -z, off seat" in Design(Furniture(piece).moved(raised)).suggestion_list.why
    assert Design(table(kilograms=1.0)).suggestion_list.why == ""


def test_a_replay_prints_ranges_as_they_were_listed_and_marks_open_ends(tmp_path) -> None:
    design = Design(drawn("table"))
    number = next(k for k, one in enumerate(design.suggestion_list.found, 1) if one.unit == "m" and one.beyond[1])
    choose = {"do": "choose", "number": number}, {"do": "slide", "to": 0.5, "frames": 3}
    rows = rows_of(make_replay(SCENES / "table.toml", write_edits(tmp_path, *choose, scene="table.toml")))
    listed = json.loads(rows[0]["suggestions"])[number - 1]
    low, high = listed["range"]
    assert listed["words"] in rows[1]["note"]
    assert [row["at"] for row in rows[2:]] == pytest.approx(
        np.linspace(listed["t"], 0.5 * (low + high), 4)[1:], abs=2e-6
    )
    for row in rows[2:]:
        assert (row["range_low"], row["range_high"]) == pytest.approx((low, high), abs=4e-6)
        assert row["ranges"].endswith(" or beyond")
    assert listed["beyond"] and high == pytest.approx(0.5 * drawn("table").size, rel=1e-6)


ON_A_POST = """
format = "restshape-scene"
version = 1
app = "furniture"
[wood]
thickness = "18 mm"
[planks]
base = { from = [-0.2, 0, 0.009], to = [0.2, 0, 0.009], width = [0, 0.4, 0] }
post = { from = [0, 0, 0.018], to = [0, 0, 0.6], width = [0, 0.3, 0] }
top = { from = [-0.3, 0, 0.609], to = [0.3, 0, 0.609], width = [0, 0.6, 0] }
[effects.gravity]
"""


def test_frames_that_hold_farther_than_ranges_were_sampled_count_as_valid(tmp_path, capsys) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(ON_A_POST)
    turn = {"do": "rotate", "on": "top", "by": "90 deg", "about": "z", "frames": 3}
    rows = rows_of(make_replay(path, write_edits(tmp_path, turn, scene=path.name)))
    assert [row["inside"] for row in rows[1:]] == [-1] * 3
    print_guidance(rows)
    (line,) = (one for one in capsys.readouterr().out.splitlines() if "top: turn z" in one)
    assert line.split()[-2:] == ["3", "3"]


def test_a_replay_says_why_there_are_no_suggestions(tmp_path) -> None:
    overrides = ["parameters.load=20.0", "effects.guidance.freedoms=1"]
    path = write_edits(tmp_path, {"do": "idle"}, scene="scales.toml")
    rows = rows_of(make_replay(SCENES / "scales.toml", path, overrides=overrides))
    assert rows[0]["suggested"] == 0
    assert "combinations of at most 1 freedoms tried" in rows[0]["no_suggestions"]


SUPPORT = re.compile(
    r"a plank of ([\d.]+) mm by ([\d.]+) mm between (\S+|the floor) and (\S+|the floor), its middle at \((.+)\) mm, "
    r"its length along (.+), its width along (.+?)(?:, ([\d.]+) mm thick)?"
    r"(?:, of (\w+))?(?:, not joined to (\S+(?: and \S+)*) beside it)?"
)
AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


def test_ends_of_ranges_have_three_digits_unless_these_are_the_same() -> None:
    assert ends(0.0641764, 0.2295, "m") == ("64.2 mm", "230 mm")
    assert ends(0.0701764, 0.0701958, "m") == ("70.176 mm", "70.196 mm")
    assert ends(0.25, 0.25, "m") == ("250 mm", "250 mm")


def test_suggestions_that_read_the_same_are_one() -> None:
    design = Design(table())
    one = next(one for one in design.suggestion_list.found if one.direction is not None)
    close, worse = replace(one, t=one.t * (1.0 + 1e-6)), replace(one, valid=False)
    assert _distinct([worse, one, close]) == [one]


def test_lines_are_axes_of_the_room_or_directions() -> None:
    assert along(np.array([0.0, -1.0, 0.0])) == "along y"
    # Whichever way along them.
    assert along(np.array([0.6, 0.0, -0.8])) == along(np.array([-0.6, 0.0, 0.8])) == "along (-0.6, 0, 0.8)"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cantilever", "table", "shelf-1", "bookshelf", "turned"])
def test_a_support_plank_can_be_drawn_again_from_its_words(name) -> None:
    piece = PIECES["cantilever" if name == "turned" else name]()
    if name in ("cantilever", "turned"):
        piece = replace(piece, weights=tuple(replace(w, force=(0, 0, 2 * w.force[2])) for w in piece.weights))
    if name == "turned":
        q = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
        piece = replace(piece, planks=tuple(replace(p, centre=q @ p.centre, axes=q @ p.axes) for p in piece.planks))
    # Those of the bookshelf do not hold, so that none of them is shown.
    furniture = Furniture(piece)
    furniture.test()
    supports = [Suggestion.supported(piece, one) for one in support_planks(furniture)]
    assert supports
    for suggestion in supports:
        made = suggestion.piece.planks[-1]
        *said, middle, length, width, thick, wood, beside = SUPPORT.fullmatch(suggestion.words).groups()
        x, y = (
            np.array(AXES.get(way) or [float(part) for part in way.strip("()").split(",")]) for way in (length, width)
        )
        long, wide = (float(part) / 1e3 for part in said[:2])
        centre = np.array([float(part) for part in middle.split(",")]) / 1e3
        ends = centre - 0.5 * long * x, centre + 0.5 * long * x
        again = Plank.between("again", *ends, wide * y, float(thick or 1e3 * piece.planks[0].size[2]) / 1e3)
        corners, others = again.corners(), made.corners()
        away = np.linalg.norm(corners[:, None] - others, axis=2).min(axis=1)
        # Millimetres, and three digits of a size and a direction.
        assert away.max() < 2e-3
        assert (thick is None) == (len({p.size[2] for p in piece.planks}) == 1)
        assert wood is None
        drawn_again = added(piece, replace(made, name="again"), piece.reach)
        assert len(drawn_again.joints) - len(suggestion.piece.joints) == (len(beside.split(" and ")) if beside else 0)
        if beside:
            joint = drawn_again.joints[-1]
            assert {drawn_again.planks[joint.i].name, drawn_again.planks[joint.j].name} & set(beside.split(" and "))


def test_a_support_plank_names_all_planks_that_it_would_be_joined_to_if_drawn() -> None:
    left, right = (
        Plank.between(name, (x, 0, 0), (x, 0, 1), (0, 0.3, 0), 0.018) for name, x in (("left", 0.0), ("right", 0.9))
    )
    low, top = (
        Plank.between(name, (0, 0, z), (0.9, 0, z), (0, 0.3, 0), 0.018) for name, z in (("low", 0.3), ("top", 0.9))
    )
    piece = joined("shelf", [left, right, low, top], fastener="screw", spacing=0.06)
    for x, beside in ((0.45, ""), (0.891 - 0.075, "right"), (0.085, "left")):
        board = Plank.between("support", (x, 0, 0.309), (x, 0, 0.891), (0.15, 0, 0), 0.018)
        words = Suggestion.supported(piece, SupportPlank(piece, (2, 3), 0, Furniture(piece).test(), (), board)).words
        assert words.endswith(f", not joined to {beside} beside it" if beside else "its width along x")


def test_a_support_plank_states_its_thickness_and_wood_where_there_are_several() -> None:
    piece = PIECES["shelf-1"]()
    support = next(
        suggestion for suggestion in Design(piece).suggestion_list.found if suggestion.name == "a support plank"
    )
    assert "thick" not in support.words and "of mdf" not in support.words
    top = len(piece.planks) - 1
    other = replace(piece.planks[top], wood="oak", size=piece.planks[top].size * [1, 1, 1.01])
    support = next(
        suggestion
        for suggestion in Design(replace(piece, planks=(*piece.planks[:top], other))).suggestion_list.found
        if suggestion.name == "a support plank"
    )
    assert ", its width along x, 12 mm thick, of mdf" in support.words

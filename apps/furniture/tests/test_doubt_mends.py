"""Suggestions for a piece that holds, but has a quantity beyond its limit, a free end or a doubt."""

from pathlib import Path

import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.guidance.doubts import doubts
from restshape_apps.furniture.guidance.lengthening import NAME, free_end_warnings
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import Piece
from restshape_apps.furniture.tests.furniture_scenes import BENCH, post, rail, write_bench, write_edits
from small_scenes import make_replay

from restshape.scene.load import load_scene


def design_of(path: Path, **asked: object) -> Design:
    scene = load_scene(path)
    return Design.closed(piece_of(scene), Guidance(quantities=scene.quantities, **asked))


def limited(tmp_path, quantity: str, **asked: object) -> Design:
    """The bench with a limit that it does not keep; its joints hold."""
    return design_of(write_bench(tmp_path, f"{BENCH}[effects.bending]\n[quantities]\nq = {{ {quantity} }}\n"), **asked)


def mass(piece: Piece) -> float:
    return float(Furniture(piece).geometry().mass.sum())


def test_a_limit_of_mass_is_kept_by_narrower_planks_and_by_thinner_ones(tmp_path) -> None:
    design = limited(tmp_path, 'mass = true, max = "5 kg"')
    whole = mass(design.piece)
    assert design.furniture.test().valid and whole > 5.0
    found = design.suggestion_list.found
    assert [bool(one.doubt) for one in found] == [False] * len(found)
    thin = next(one for one in found if one.settings)
    assert thin.settings == (("wood.thickness", 0.018),) and mass(thin.piece) <= 5.0
    seat = next(one for one in found if one.words.startswith("top") and "along its y" in one.words)
    # The end of the range is where the planks weigh 5 kg: a board loses mass in proportion to its width.
    board = float(design.furniture.geometry().mass[design.piece.index("top")])
    assert seat.span[0] == pytest.approx(0.3 * (whole - 5.0) / board, abs=2e-4)
    assert mass(design.after(seat)) < 5.0


@pytest.mark.parametrize("quantity", ['deflection = true, max = "0.5 mm"', 'length = "x", at = "top", max = "1.1 m"'])
def test_what_is_suggested_for_a_limit_keeps_it_and_nothing_nearer_does(tmp_path, quantity: str) -> None:
    design = limited(tmp_path, quantity)
    found = design.suggestion_list.found
    assert found and not design.suggestion_list.why
    for one in found:
        assert Furniture(design.after(one)).test().valid and not doubts(design.after(one), design.guidance.quantities)
        if one.direction is not None:
            before = design.furniture.moved((one.span[0] - 1e-3) * one.direction)
            assert doubts(before, design.guidance.quantities) or not Furniture(before).test().valid


def test_where_nothing_keeps_a_limit_the_reason_says_so(tmp_path) -> None:
    text = f'{BENCH}[quantities]\nheavy = {{ mass = true, max = "0.1 kg" }}\n[effects.guidance]\n'
    (row,) = make_replay(write_bench(tmp_path, text)).frames()
    assert row["constraint_status"] == "fails" and row["flaws"] == 0 and not row["suggestions"]
    assert row["no_suggestions"].endswith("fasteners and thicknesses tried: none brings heavy within its limit")


def test_a_suggestion_for_a_limit_is_chosen_like_others(tmp_path) -> None:
    text = f'{BENCH}[quantities]\nheavy = {{ mass = true, max = "5 kg" }}\n[effects.guidance]\n'
    replay = make_replay(write_bench(tmp_path, text), write_edits(tmp_path, {"do": "choose", "number": 1}))
    assert [row["constraint_status"] for row in replay.frames()] == ["fails", "holds"]


def test_a_moment_that_does_not_count_gets_suggestions_that_end_the_doubt(tmp_path) -> None:
    path = tmp_path / "post.toml"
    path.write_text(post("0.2 m", "500 N"))
    design = design_of(path)
    assert design.furniture.test().valid and design.furniture.test().doubts
    found = design.suggestion_list.found
    assert found and all(not doubts(design.after(one), {}) for one in found)


def test_a_free_end_is_joined_or_the_reason_says_why_not(tmp_path) -> None:
    design = design_of(write_bench(tmp_path, BENCH + rail(-0.49, 0.466, width=0.04)))
    (one,) = design.suggestion_list.found
    assert one.kind == NAME and one.words == "rail 24 mm longer at its end +x, to meet right" and not one.doubt
    # Beside a narrow leg it goes sideways too, by 40 mm and half of its width; its end on the left leg goes along.
    narrow = "to = [0.5, 0, 0.5]\nwidth = [0, 0.1, 0]".join(BENCH.split("to = [0.5, 0, 0.5]\nwidth = [0, 0.3, 0]"))
    design = design_of(write_bench(tmp_path, narrow + rail(-0.49, 0.466, 0.09, 0.04)))
    (one,) = design.suggestion_list.found
    assert one.words == "rail moved 60 mm towards -y and 24 mm longer at its end +x, to meet right" and not one.doubt
    # Nothing is enough where a stick bars its way.
    stick = "\n[planks.stick]\nfrom = [0.476, 0, 0.5]\nto = [0.476, 0, 0]\nwidth = [0.012, 0, 0]\n"
    design = design_of(write_bench(tmp_path, BENCH + rail(-0.49, 0.466, width=0.04) + stick))
    assert design.furniture.test().valid and not design.suggestion_list.found
    assert design.suggestion_list.why.startswith("no free end meets its face by its length or a move beside it")


@pytest.mark.slow
def test_of_two_limits_that_nothing_keeps_at_once_each_is_mended_alone(tmp_path) -> None:
    # A stiffer top is heavier.
    limits = '[quantities]\nq = { deflection = true, max = "0.5 mm" }\nheavy = { mass = true, max = "5 kg" }\n'
    design = design_of(write_bench(tmp_path, f"{BENCH}[effects.bending]\n{limits}"))
    said = {one.words: one.doubt for one in design.suggestion_list.found}
    assert len(said) > 1 and all(("q is" in doubt) != ("heavy is" in doubt) for doubt in said.values())
    assert any("q is" in doubt for doubt in said.values()) and any("heavy is" in doubt for doubt in said.values())


def test_a_piece_beyond_doubt_has_no_suggestions(tmp_path) -> None:
    design = design_of(write_bench(tmp_path, BENCH))
    assert design.suggestion_list.found == () and design.suggestion_list.why == ""


def test_a_rail_that_would_break_once_it_is_joined_is_said_to(tmp_path) -> None:
    # 30 mm short of the right leg; once it meets both, the push goes through its single screws.
    push = "[pushes.shove]\non = 'top'\nforce = [{0}, 0, 0]\nat = [0, 0, 0.5]\n[effects.push]\n"
    for force, holds in ((20, True), (80, False)):
        text = BENCH.replace('"screw"', '"screw"\nspacing = 0.05') + rail(-0.49, 0.46, width=0.04) + push.format(force)
        design = design_of(write_bench(tmp_path, text))
        assert design.furniture.test().valid
        (said,) = free_end_warnings(design.piece, True)
        found = design.suggestion_list
        done = "rail 30 mm longer at its end +x, to meet right"
        if holds:
            assert found.found[0].words == done and "but then" not in said
            continue
        joined = Furniture(design_of(write_bench(tmp_path, text.replace("0.46", "0.49"))).piece).test()
        assert joined.flaws and not found.found
        assert said.endswith(f", but then {'; '.join(joined.words)}")
        assert found.why.startswith(f"{done}, does not hold: {joined.words[0]}"[:200])

"""First suggestions of the shipped pieces, in all frames of their edits; the order of those of a bench with a limit."""

import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.guidance.preferences import preserved, way_of_material
from restshape_apps.furniture.guidance.quantity_limits import violated_limits
from restshape_apps.furniture.guidance.suggested import Suggestion
from restshape_apps.furniture.pieces import SCENES
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.tests.furniture_scenes import SLANTED_BENCH

from restshape.replay.sessions import session_of
from restshape.scene.edit_script import read_script
from restshape.scene.load import load_scene

PIECES = sorted(path.stem for path in SCENES.glob("*.toml"))


def searched(name: str) -> list[Design]:
    """The designs of a shipped piece and its edits that do not hold where a hand lets go."""
    scene, path = load_scene(SCENES / f"{name}.toml"), SCENES.parent / "edits" / f"{name}.jsonl"
    found: list[Design] = []
    for frame in session_of(scene, read_script(path.read_text(), path, scene)).frames():
        free = frame.edit_ended and not frame.gamma.any() and frame.design not in found
        if free and not frame.design.furniture.test().valid:
            found.append(frame.design)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("name", PIECES)
def test_the_first_keeps_symmetry_and_level_where_one_does(name: str) -> None:
    designs = searched(name)
    assert designs
    for design in designs:
        found = design.suggestion_list.found
        for sure in (True, False):
            # Of those that hold beyond doubt, and else of all.
            kept = [preserved(design.piece, design.after(one)) for one in found if not sure or _sure(one)]
            if (True, True) in kept:
                assert kept[0] == (True, True), (name, found[0].words)
                break


def _sure(one: Suggestion) -> bool:
    return one.valid and not one.doubt


@pytest.mark.slow
def test_what_obeys_a_limit_comes_first_then_the_shortest_way_of_material(tmp_path) -> None:
    path = tmp_path / "bench.toml"
    path.write_text(SLANTED_BENCH)
    scene = load_scene(path)
    design = Design.closed(piece_of(scene), Guidance(quantities=scene.quantities))
    found = design.suggestion_list.found
    obeys = [not violated_limits(design.after(one), scene.quantities) for one in found]
    assert obeys == sorted(obeys, reverse=True) and set(obeys) == {True, False}
    for tier in (True, False):
        some = [one for one, good in zip(found, obeys) if good is tier and not one.settings]
        kinds = [one.kind for one in some]
        # Of each kind the nearest, and these in the order of their ways.
        ways = [way_of_material(design.piece, design.after(some[kinds.index(kind)])) for kind in dict.fromkeys(kinds)]
        assert ways == sorted(ways)

"""What explain says of a reach: how many nodes move, what is condensed, and at which price."""

import pytest
from restshape_studies.explain.reach import reach
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

WINDOW = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.55, 0.5), 2))


def lines(folder, *overrides, events=WINDOW):
    scene = load_scene(write_scene(folder, plate(0.12)), overrides)
    return reach(scene, load_script(write_script(folder, events), scene) if events else None)


def test_nothing_is_said_without_a_reach(tmp_path):
    assert lines(tmp_path) == []


@pytest.mark.parametrize(
    ("overrides", "events", "words"),
    [
        (["mesh.reach=0.12"], WINDOW, "are condensed"),
        (["mesh.reach=9"], WINDOW, "the whole is solved for"),
        (["mesh.reach=0.12", "effects.large_deformation={}"], WINDOW, "the whole is solved for"),
        (["mesh.reach=0.12"], [{"do": "set", "key": "mesh.size", "value": 0.2}], "the whole is solved for"),
        (["mesh.reach=0.12"], None, "nothing"),
    ],
)
def test_what_moves_and_what_is_solved_for(tmp_path, overrides, events, words):
    ((name, what, why),) = lines(tmp_path, *overrides, events=events)
    assert name == "reach" and words in what
    if words == "are condensed":
        moved, nodes = int(what.split()[0]), int(what.split()[3])
        assert 0 < moved < 0.25 * nodes
        part, whole = (float(price.split()[-1]) for price in why.split(": ")[1].split(", "))
        assert 0.0 < part < whole

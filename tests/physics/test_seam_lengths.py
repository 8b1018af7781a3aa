"""What `restshape check` shows of seams before anything is sewn: lengths of both sides, and halves left open."""

import pytest
from small_scenes import write_scene
from test_pattern_panels import garment, panel

from restshape.physics.cloth.seams.seam_lengths import inspect_seams
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

ON_FOLD = panel("front", 'mirror = "left"', "move = [0, 0, 0]") + panel("back", 'mirror = "left"', "move = [0, 1, 0]")
HELD = '[supports.held]\non = "front.bottom"\nfix = ["x", "y", "z"]\n'
HIP = '[seams.hip]\nfrom = "front.right"\nto = "back.mirror.{to}"\n'
OTHER = '[seams.other]\nfrom = "front.mirror.right"\nto = "back.right"\n'
PLEATED = """
[seams.waist]
from = "front.top"
to = "band.bottom"
pleats = { one = { at = 0.5, depth = "2 cm" } }
"""


def seen(tmp_path, *tables: str):
    scene = load_scene(write_scene(tmp_path, garment(*tables, HELD)))
    return inspect_seams(scene, outline_from_spec(scene.shape))


def test_sides_of_unlike_lengths_are_warned_of_beyond_their_ease(tmp_path):
    wrong = HIP.format(to="top")
    found = seen(tmp_path, ON_FOLD, wrong, OTHER)
    assert found.rows[0] == ("lengths of hip", "from 150 mm, to 200 mm")
    assert found.warnings[0].startswith("seams.hip.to: 33.3 % longer than the other side")
    assert not any("longer" in one for one in seen(tmp_path, ON_FOLD, wrong + "ease = 0.34\n", OTHER).warnings)


def test_the_other_half_of_a_panel_on_the_fold_is_missed_where_it_is_not_sewn(tmp_path):
    half = seen(tmp_path, ON_FOLD, HIP.format(to="right")).warnings
    assert [one.partition(" ")[0] for one in half] == ["back.mirror.right", "front.right"]
    assert all("seams are not mirrored" in one for one in half)
    assert seen(tmp_path, ON_FOLD, HIP.format(to="right"), OTHER).warnings == ()


def test_a_panel_that_neither_seam_nor_support_reaches_is_warned_of(tmp_path):
    panels = ON_FOLD + panel("pocket", "move = [0, 2, 0]"), HIP.format(to="right"), OTHER
    [loose] = seen(tmp_path, *panels).warnings
    assert loose.startswith("panels.pocket: no seam joins it to another panel and no support holds it")
    assert not seen(tmp_path, *panels, '[supports.pin]\non = "pocket.a"\nfix = ["x", "y", "z"]\n').warnings
    assert seen(tmp_path, *panels, '[seams.own]\nfrom = "pocket.left"\nto = "pocket.right"\n').warnings == (loose,)


def test_a_panel_under_a_hand_is_not_warned_of(tmp_path):
    panels = ON_FOLD + panel("pocket", "move = [0, 2, 0]"), HIP.format(to="right"), OTHER
    outline = outline_from_spec(load_scene(write_scene(tmp_path, garment(*panels, HELD))).shape)
    x, y = outline.centroid(outline.entity("pocket"))
    held = f"[hold]\nat = [{x}, {y}]\nto = [0, 2, 0]\n"
    assert len(seen(tmp_path, *panels).warnings) == 1 and not seen(tmp_path, *panels, held).warnings
    x, y = outline.centroid(outline.entity("front"))
    assert len(seen(tmp_path, *panels, f"[hold]\nat = [{x}, {y}]\nto = [0, 0, 0]\n").warnings) == 1


def test_pleats_take_twice_their_depth(tmp_path):
    found = seen(tmp_path, panel("front"), panel("band", "move = [0, 0, 1]", width=0.16), PLEATED)
    assert found.rows == [("lengths of waist", "from 160 mm (flat 200 mm), to 160 mm")] and not found.warnings
    assert found.data["seam_lengths"] == {"waist": {"from": pytest.approx(0.16), "to": pytest.approx(0.16)}}

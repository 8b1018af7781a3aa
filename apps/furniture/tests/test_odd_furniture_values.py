"""Values of furniture that are hardly meant: fasteners in each other, and thicknesses that lack their unit."""

import warnings
from math import atan, degrees

import pytest
from restshape_apps.furniture.cli.check_planks import checked
from restshape_apps.furniture.cli.plank_doubts import odd_values
from restshape_apps.furniture.pieces import SCENES
from restshape_apps.furniture.shape.plank_scene import piece_of

from restshape.application import application
from restshape.cli.main import main
from restshape.scene.load import load_scene
from restshape.scene.plan import plan

BENCH = """
format = "restshape-scene"
version = 1
app = "furniture"
[parameters]
t = {t}
[wood]
name = "oak"
thickness = {thickness}
[fastener]
name = "{fastener}"
spacing = {spacing}
[planks.seat]
from = [-0.6, 0, 0.515]
to = [0.6, 0, 0.515]
width = [0, 0.3, 0]
thickness = "30 mm"
[planks.left]
from = [-0.5, 0, 0]
to = [-0.5, 0, 0.5]
width = [0, 0.3, 0]
[planks.right]
from = [0.5, 0, 0]
to = [0.5, 0, 0.5]
width = [0, 0.3, 0]
"""


def warned(folder, **keys):
    """The warnings of a check of a bench with some values."""
    given = {"t": '"30 mm"', "thickness": '"30 mm"', "fastener": "dowel", "spacing": '"40 mm"'} | keys
    path = folder / "bench.toml"
    path.write_text(BENCH.format(**given))
    scene = load_scene(path)
    data, rows, _ = checked(scene, plan(scene, application("furniture")))
    assert {("warning", words) for words in data["warnings"]} <= set(rows)
    return data["warnings"]


@pytest.mark.parametrize(
    ("fastener", "near", "enough", "words"),
    [
        ("dowel", '"0.1 mm"', '"24 mm"', "0.1 mm from one 'dowel' of 8 mm to the next is less than 3 diameters"),
        ("dowel", "0.02", '"32 mm"', "20 mm from one 'dowel' of 8 mm"),
        ("screw", '"11.9 mm"', '"12 mm"', "11.9 mm from one 'screw' of 4 mm"),
    ],
)
def test_fasteners_that_are_too_near_each_other_are_warned_of(tmp_path, fastener, near, enough, words):
    (warning,) = warned(tmp_path, fastener=fastener, spacing=near)
    assert warning.startswith("fastener.spacing: ") and words in warning and "mm or more" in warning
    assert warned(tmp_path, fastener=fastener, spacing=enough) == []


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (
            {"thickness": "20"},
            'wood.thickness: a length without a unit is in metres, and 20 m is long for a thickness: "20 mm"',
        ),
        ({"thickness": '"t"', "t": "18"}, "wood.thickness: "),
        ({"spacing": "40"}, "fastener.spacing: "),
    ],
)
def test_a_thickness_in_metres_is_asked_about(tmp_path, keys, words):
    (warning,) = warned(tmp_path, **keys)
    assert warning.startswith(words)


def test_planks_in_millimetres_without_a_unit_are_asked_about(tmp_path):
    path = tmp_path / "bench.toml"
    given = {"t": '"30 mm"', "thickness": '"30 mm"', "fastener": "dowel", "spacing": '"40 mm"'}
    text = BENCH.format(**given).replace("width = [0, 0.3, 0]", 'width = [0, "t*10", 0]', 1)
    for old, new, words in [
        ("width = [0, 0.3, 0]", "width = [0, 300, 0]", "planks.left.width: a length without a unit is in metres"),
        (
            "from = [0.5, 0, 0]",
            "from = [500, 0, 0]",
            "planks.right.from: a length without a unit is in metres, and 500 m",
        ),
        ("from = [0.5, 0, 0]", 'from = ["12 m", 0, 0]', ""),
        ("[planks.left]", '[weights.books]\non = "seat"\nmass = 2000\n[planks.left]', "weights.books.mass: a mass"),
        ("[planks.left]", '[weights.books]\non = "seat"\nmass = "2000 kg"\n[planks.left]', ""),
        # On the face of a leg a weight is hung, and inside it fastened.
        ("[planks.left]", '[weights.coat]\non = "left"\nmass = 2\nat = [0, 0, 0.5]\n[planks.left]', ""),
        ("[planks.left]", '[weights.coat]\non = "left"\nmass = 2\nat = [0, 0, 0]\n[planks.left]', ""),
    ]:
        path.write_text(text.replace(old, new, 1))
        scene = load_scene(path)
        found = odd_values(scene, piece_of(scene))
        assert [one.startswith(words) for one in found] == [True] * bool(words), (new, found)


def test_fasteners_in_edges_of_less_than_twice_their_diameter_are_warned_of(tmp_path):
    (warning,) = warned(tmp_path, thickness='"15.9 mm"')
    assert (
        warning.startswith("planks.left: a 'dowel' of 8 mm goes into an edge of 15.9 mm") and "16 mm or more" in warning
    )
    assert warned(tmp_path, thickness='"16 mm"') == []


@pytest.mark.parametrize(
    ("g", "odd"), [("[0, 0, 9.81]", 1), ("[0, -9.81, 0]", 1), ("[0, 1, -9.7]", 0), ("[0, 0, 0]", 0)]
)
def test_gravity_that_does_not_press_on_the_floor_is_warned_of(tmp_path, g, odd):
    path = tmp_path / "bench.toml"
    text = BENCH.format(t='"30 mm"', thickness='"30 mm"', fastener="dowel", spacing='"40 mm"')
    path.write_text(text + f"[effects.gravity]\ng = {g}\n")
    found = plan(load_scene(path), application("furniture")).warnings
    assert len(found) == odd and all("points down" in one for one in found)


def test_suggestions_are_sought_where_no_load_presses_on_the_floor(tmp_path, capsys):
    """Rows of stability, parts of that load, are no numbers: they are left out, and nothing warns."""
    path = tmp_path / "bench.toml"
    text = BENCH.format(t='"30 mm"', thickness='"30 mm"', fastener="dowel", spacing='"40 mm"')
    path.write_text(text + "[effects.gravity]\ng = [0, -9.81, 0]\n")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert main(["replay", str(path)]) == 0
    assert "falls under its weights" in "".join(capsys.readouterr())


def test_a_thickness_with_its_unit_or_of_less_than_a_metre_is_not(tmp_path):
    assert warned(tmp_path, thickness='"1.2 m"') == [] == warned(tmp_path, thickness="0.02")


@pytest.mark.parametrize(("rise", "steep"), [(0.08, False), (0.1, True), (0.4, True), (-0.4, True)])
def test_a_weight_on_a_slope_is_warned_of(tmp_path, rise, steep):
    desk = f"[planks.desk]\nfrom = [-0.5, 0, 0.3]\nto = [0.5, 0, 0.3]\nwidth = [0, 0.3, {rise}]\n"
    path = tmp_path / "bench.toml"
    text = BENCH.format(t='"30 mm"', thickness='"30 mm"', fastener="dowel", spacing='"40 mm"')
    path.write_text(text + desk + '[weights.book]\non = "desk"\nmass = 1\n[effects.gravity]\n')
    scene = load_scene(path)
    found = odd_values(scene, piece_of(scene))
    assert len(found) == steep
    if steep:
        slope = abs(rise) / 0.3
        words = f"a slope of {degrees(atan(slope)):.3g} deg and is taken as held there: without that it needs friction"
        assert found[0] == f"weights.book: it lies on {words} of {slope:.2g}"


def test_a_replay_has_the_warning_too(tmp_path, capsys):
    warned(tmp_path, spacing='"0.1 mm"')
    assert main(["replay", str(tmp_path / "bench.toml")]) == 0
    assert "less than 3 diameters" in "".join(capsys.readouterr())


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.toml")), ids=lambda path: path.stem)
def test_our_scenes_have_no_odd_values(path):
    scene = load_scene(path)
    assert odd_values(scene, piece_of(scene)) == []

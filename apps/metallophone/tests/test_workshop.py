"""What leaves the program for a workshop: drawings with holes for the cord, the sheet, the sound; what is refused."""

import json
import wave
from argparse import Namespace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import restshape_apps.metallophone as metallophone
from matplotlib.text import Text
from restshape_apps.metallophone.workshop import sheet
from restshape_apps.metallophone.workshop.bar import Bar, bar_of
from restshape_apps.metallophone.workshop.sheet_tables import material, places

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.export.edited_frame import EditedFrame, frame_of_script
from restshape.outputs.kinds import ExportFile
from restshape.scene.edit_script import Script
from restshape.scene.load import load_scene
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec

TEMPLATE = Path(metallophone.__file__).parent / "template" / "scene.toml"
LENGTH, WIDTH = 170.0, 30.0
STILL = 0.2242
"""Share of the length of a free slender bar at which its first mode is still (cos beta cosh beta = 1)."""


def frame(*overrides: str) -> EditedFrame:
    """The first frame of the template: a bar of aluminium of 170 x 30 x 4 mm."""
    scene = load_scene(TEMPLATE, overrides)
    return frame_of_script(scene, Script.empty(scene), 0)


def bar(cord: float, *overrides: str) -> Bar:
    return bar_of(frame(*overrides), Namespace(to=None, cord=cord))


def test_a_drawing_has_the_area_of_the_bar_with_the_holes_for_its_cord(tmp_path):
    out, numbers = tmp_path / "bar.dxf", tmp_path / "bar.json"
    words = ["--as", "dxf", "--kerf", "0.2mm", "--cord", "4mm", "--to", "A5", "--out", str(out), "--json", str(numbers)]
    assert main(["export", str(TEMPLATE), *words]) == 0
    space = ezdxf.readfile(out).modelspace()
    holes = space.query('CIRCLE[layer=="HOLES"]')
    assert [circle.dxf.radius for circle in holes] == pytest.approx([1.9, 1.9], abs=1e-9)
    across = sorted(circle.dxf.center.x / LENGTH for circle in holes)
    assert across == pytest.approx([STILL, 1.0 - STILL], abs=2e-3)
    # Four sides moved out by 0.1 mm, with a quarter of a circle around each corner.
    lines = [entity.dxf for entity in space.query('LINE[layer=="CUT"]')]
    ends = np.array([[(*line.start.vec2,), (*line.end.vec2,)] for line in lines])
    np.testing.assert_allclose(ends.reshape(-1, 2).min(axis=0), (-0.1, -0.1), atol=1e-9)
    np.testing.assert_allclose(ends.reshape(-1, 2).max(axis=0), (LENGTH + 0.1, WIDTH + 0.1), atol=1e-9)
    arcs = space.query('ARC[layer=="CUT"]')
    assert len(lines) == 4 and [arc.dxf.radius for arc in arcs] == pytest.approx([0.1] * 4, abs=1e-9)
    found = json.loads(numbers.read_text())
    assert found["area"] == pytest.approx(1e-6 * (LENGTH * WIDTH - 2 * np.pi * 2.0**2), rel=1e-9)
    assert [text.dxf.text for text in space.query("TEXT")] == ["A5"]
    assert any("holes for the cord move the first tone by" in note for note in found["notes"])


def test_the_tone_that_a_quantity_names_is_the_wanted_one():
    named = bar(0.0, 'quantities.tune={ cents = "F5" }', 'quantities.high={ cents = "F7", mode = 3 }')
    assert named.wanted and named.target == "F5"
    assert named.cents == pytest.approx(1200.0 * np.log2(named.analysis.frequencies[0] / 698.4565), abs=1e-3)
    nearest = bar(0.0)
    assert not nearest.wanted and abs(nearest.cents) <= 50.0


def test_holes_for_a_cord_move_the_tone_as_their_area():
    """Small holes of one stress field: what they take of stiffness and mass goes with the square of the diameter."""
    small, large = bar(2e-3), bar(4e-3)
    assert small.drilled_cents < 0.0
    assert large.drilled_cents / small.drilled_cents == pytest.approx(4.0, rel=0.25)
    assert large.undrilled[0] == pytest.approx(bar(0.0).analysis.frequencies[0], rel=2e-3)


def test_a_scene_goes_on_with_the_holes_for_its_cord(tmp_path):
    out, surface = tmp_path / "bored.toml", tmp_path / "bored.stl"
    assert main(["export", str(TEMPLATE), "--as", "toml", "--cord", "4mm", "--out", str(out)]) == 0
    scene = load_scene(out)
    bored = frame_of_script(scene, Script.empty(scene), 0)
    # The bar hangs at these holes from now on, whatever is tuned.
    assert bored.outline.names("hole") == list(scene.effects["modal"]["hanging"]["at"]) == ["hang_1", "hang_2"]
    found = bar_of(bored, Namespace(to=None, cord=0.0)).analysis.frequencies[0]
    assert found == pytest.approx(bar(4e-3).analysis.frequencies[0], rel=1e-6)
    assert main(["export", str(TEMPLATE), "--as", "stl", "--cord", "4mm", "--out", str(surface)]) == 0
    count = int.from_bytes(surface.read_bytes()[80:84], "little")
    assert main(["export", str(TEMPLATE), "--as", "stl", "--out", str(surface)]) == 0
    assert count > int.from_bytes(surface.read_bytes()[80:84], "little")


def test_a_drawing_for_a_workshop_is_read_back_by_its_layers(tmp_path):
    out = tmp_path / "bar.dxf"
    assert main(["export", str(TEMPLATE), "--as", "dxf", "--cord", "4mm", "--out", str(out)]) == 0
    back = outline_from_spec(ShapeSpec(file="bar.dxf", layers={"CUT": "rim", "HOLES": "cord"}), tmp_path)
    assert back.area() == pytest.approx(1e-6 * (LENGTH * WIDTH - 2 * np.pi * 2.0**2), rel=1e-9)
    assert len(back.names("hole")) == 2


@pytest.mark.weekly
def test_holes_for_a_cord_do_the_same_in_tetrahedra_as_in_plates():
    solid = bar(4e-3, "effects.modal.model=solid", "mesh.order=2", "effects.modal.modes=1")
    assert solid.drilled_cents == pytest.approx(bar(4e-3).drilled_cents, rel=0.02)


def test_a_bar_is_struck_in_its_middle_and_a_square_where_it_moves():
    assert bar(4e-3).strike == pytest.approx((0.085, 0.015), abs=2e-4)
    # The line between the hanging points of a square is still: its first mode is a saddle.
    square = "shape.vertices={ a = [0, 0], b = [0.17, 0], c = [0.17, 0.17], d = [0, 0.17] }"
    found = bar(0.0, square)
    place = np.abs(found.strike - 0.085)
    assert found.hanging.found and place.min() > 0.06
    assert place.max() <= 0.085 - 3e-3


def test_a_slender_tail_does_not_draw_the_blow_to_itself():
    """It moves eleven times as far as the bar between its hanging points."""
    corners = ((0, -30), (120, -30), (120, 30), (0, 30), (0, 3), (-60, 3), (-60, -3), (0, -3))
    vertices = ", ".join(f'{name} = ["{x} mm", "{y} mm"]' for name, (x, y) in zip("abcdefgh", corners))
    sides = [*zip("abcdefgh", "bcdefgha")]
    lines = ", ".join(f'{p}{q} = {{ line = ["{p}", "{q}"] }}' for p, q in sides)
    outline = "shape.outline=" + json.dumps([p + q for p, q in sides])
    found = bar(0.0, f"shape.vertices={{ {vertices} }}", f"shape.edges={{ {lines} }}", outline)
    (first, second), (x, y) = sorted(found.hanging.places[:, 0]), found.strike
    assert first + 0.02 < x < second - 0.02 and abs(y) < 1e-3


def test_the_sheet_has_dimensions_tones_places_and_tolerances(tmp_path, monkeypatch):
    pages = []
    monkeypatch.setattr(sheet, "save_pages", lambda figures, *_: pages.extend(figures))
    asked, wanted = frame(), Namespace(to="A5", cord=4e-3)
    sheet.write_sheet(asked, wanted, tmp_path / "bar.pdf")
    (page,) = pages
    texts = [text.get_text() for text in page.findobj(Text) if text.get_text()]
    known = bar_of(asked, wanted)
    mass = 2700.0 * 4e-3 * 1e3 * 1e-6 * (LENGTH * WIDTH - 2 * np.pi * 2.0**2)
    cents = 1200.0 * np.log2(known.analysis.frequencies[0] / 880.0)
    heights = {f"{1e3 * place[0]:.1f}" for place in known.hanging.places}
    wanted_texts = {"A5", "170.00", "30.00", "4 mm", "70 GPa, 0.33", f"{mass:.2f} g", "scale 1 : 1, mm", "85", *heights}
    assert wanted_texts <= set(texts), wanted_texts - set(texts)
    assert any(f"computed {known.analysis.frequencies[0]:.2f} Hz, {cents:+.1f} cents" in text for text in texts)
    # Of a uniform slender bar f goes with the thickness, and with the square roots of E and 1 / rho.
    row = texts.index("0.1 mm more of thickness")
    assert float(texts[row + 1]) == pytest.approx(1200.0 * 0.1 / 4.0 / np.log(2.0), rel=0.03)
    assert texts[texts.index("1 % more of E") + 1] == "+8.6"
    boxes = [text.get_window_extent() for text in page.findobj(Text) if text.get_text() and text.get_visible()]
    width, height = page.bbox.width, page.bbox.height
    assert all(box.x0 >= 0 and box.y0 >= 0 and box.x1 <= width and box.y1 <= height for box in boxes)


def test_a_sheet_is_one_page_of_ours_that_may_be_replaced(tmp_path):
    out = ExportFile(tmp_path / "bar.pdf")
    assert main(["export", str(TEMPLATE), "--as", "pdf", "--out", str(out)]) == 0
    data = out.read_bytes()
    assert data.startswith(b"%PDF-") and data.count(b"/Type /Page ") == 1 and out.ours()
    out.write_bytes(data.replace(b"restshape export", b"another program "))
    assert not out.ours()
    assert main(["export", str(TEMPLATE), "--as", "pdf", "--out", str(out)]) == 2


def test_an_exported_sound_has_the_first_tone(tmp_path):
    out = tmp_path / "bar.wav"
    assert main(["export", str(TEMPLATE), "--as", "wav", "--out", str(out)]) == 0
    with wave.open(str(out), "rb") as file:
        rate, sound = file.getframerate(), np.frombuffer(file.readframes(file.getnframes()), "<i2")
    heard = float(np.argmax(np.abs(np.fft.rfft(sound)))) * rate / len(sound)
    assert heard == pytest.approx(bar(0.0).analysis.frequencies[0], abs=2.0 * rate / len(sound))


def test_a_frame_of_an_edit_is_drawn_as_it_is_then(tmp_path):
    script, out, numbers = (tmp_path / name for name in ("edits.jsonl", "bar.dxf", "bar.json"))
    lines = [
        {"format": "restshape-edits", "version": 1, "scene": str(TEMPLATE), "units": "mm"},
        {"t": 0.0, "do": "press", "on": "c", "at": [170, 30]},
        {"t": 0.1, "do": "drag", "path": [[168, 28]], "frames": 2},
    ]
    script.write_text("\n".join(map(json.dumps, lines)))
    words = ["--as", "dxf", "--frame", "-1", "--unit", "in", "--out", str(out), "--json", str(numbers)]
    assert main(["export", str(TEMPLATE), str(script), *words]) == 0
    lines = [entity.dxf for entity in ezdxf.readfile(out).modelspace().query('LINE[layer=="CUT"]')]
    corners = np.array([(*line.start.vec2,) for line in lines])
    assert (
        corners.max() == pytest.approx(170.0 / 25.4) and np.hypot(*(corners - (168 / 25.4, 28 / 25.4)).T).min() < 1e-9
    )
    sheared = 170 * 30 - 0.5 * (2 * 30 + 2 * 170)
    assert json.loads(numbers.read_text())["area"] == pytest.approx(1e-6 * sheared, rel=1e-9)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--as", "pdf", "--to", "H5"], "no tone is named 'H5'"),
        (["--as", "csv", "--cord", "3mm"], "without holes for a cord"),
        (["--as", "toml", "--to", "C5"], "no tone is written there"),
        (["--as", "dxf", "--cord", "0mm"], "is no diameter of a hole"),
        (["--as", "dxf", "--cord", "40mm"], "40 mm off the border"),
        (["--as", "dxf", "--layers", "names", "--kerf", "1mm"], "layers by name"),
        (["--as", "pdf", "--kerf", "1mm"], "a pdf file has none"),
        (["--as", "dxf", "--kerf", "3 Hz"], "length"),
    ],
)
def test_what_makes_no_sense_is_refused_in_words(words, message, tmp_path, capsys):
    out = tmp_path / f"bar.{words[1]}"
    assert main(["export", str(TEMPLATE), *words, "--out", str(out)]) == 2
    assert message in capsys.readouterr().err
    assert not out.exists()


def test_the_sheet_names_holes_of_the_scene_and_what_its_formulas_take():
    formula = 'material.aluminium.thickness="T*(1 - x)"'
    hole = 'shape.holes={ eye = { circle = { center = ["150 mm", "15 mm"], radius = "3 mm" } } }'
    found = bar(4e-3, "parameters={ T = 0.004, idle = 1.0 }", formula, hole)
    assert ["eye, hole of 6.00 mm", "150.0", "15.0"] in places(found)
    assert ["with (SI)", "T = 0.004"] in material(found)


def test_other_scenes_have_no_sheet(tmp_path, capsys):
    scene = Path(metallophone.__file__).parents[1] / "solid" / "scenes" / "plate.toml"
    assert main(["export", str(scene), "--as", "pdf", "--out", str(tmp_path / "plate.pdf")]) == 2
    assert "a scene of 'solid' is not written as pdf" in capsys.readouterr().err


def test_a_bar_that_has_no_place_to_hang_from_gets_no_holes():
    """Its first mode has its nodal lines along the supported border."""
    with pytest.raises(UserError, match="no place to hang the bar is fixed"):
        bar(4e-3, 'supports.rim={ on = "outline", fix = ["z"] }')


def test_the_surface_of_an_undercut_bar_is_closed_and_has_its_volume(tmp_path):
    """h = t (1 - c ((x - L / 2) / (L / 2))^2) has the mean t (1 - c / 3)."""
    t, c, out = 4e-3, 0.4, tmp_path / "bar.stl"
    formula = f'material.aluminium.thickness="{t}*(1 - {c}*((x - 0.085)/0.085)^2)"'
    assert main(["export", str(TEMPLATE), "--as", "stl", "--set", formula, "--out", str(out)]) == 0
    rows = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(out.read_bytes()[84:], rows)["corners"].astype(float)
    volume = float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6.0
    # Linear on triangles of 8 mm.
    assert volume == pytest.approx(1e3 * t * LENGTH * WIDTH * (1.0 - c / 3.0), rel=2e-3)
    _, places = np.unique(corners.reshape(-1, 3).round(5), axis=0, return_inverse=True)
    sides = places.reshape(-1, 3)[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    assert {tuple(side) for side in sides} == {tuple(side[::-1]) for side in sides}
    ends = corners.reshape(-1, 3)[corners.reshape(-1, 3)[:, 0] == 0.0]
    assert ends[:, 2].max() == pytest.approx(1e3 * t * (1.0 - c), rel=1e-6) and corners[..., 2].min() == 0.0

"""Bad input of garments: each message says what, where and what to do."""

import ezdxf
import pytest
from test_pattern_beside_drape import SCENE

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.scene.load import load_scene
from restshape.shape.build import outline_of
from restshape.shape.patterns.pattern_drawing import read_pattern_dxf
from restshape.shape.patterns.pattern_svg import read_pattern_svg

LONG = '[seams.long]\nfrom = "front.side"\nto = "back.up"\n'


def refused(folder, *changes: tuple[str, str]) -> UserError:
    """What is said of the scene with some of its text changed."""
    text = SCENE
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    (folder / "bad.toml").write_text(text)
    with pytest.raises(UserError) as found:
        load_scene(folder / "bad.toml")
    return found.value


@pytest.mark.parametrize(
    ("seams", "what", "where"),
    [
        ('[seams.s]\nfrom = "front.sid"\nto = "back.up"\n', "the edge 'front.sid', which is not there", "seams.s.from"),
        ('[seams.s]\nfrom = "front.side"\nto = "front.a"\n', "'front.a', which is 'vertex'", "seams.s.to"),
        ('[seams.s]\nfrom = "front.side"\nto = "front.side"\n', "would be sewn to itself", "seams.s"),
        (
            LONG + '[seams.s]\nfrom = "back.up"\nto = "front.side"\nreverse = true\n',
            "'long' and 's' both join 'front.side' and 'back.up', in unlike ways",
            "seams.s",
        ),
        (
            LONG + '[seams.s]\nfrom = ["front.side", "front.hem"]\nto = "back.up"\n',
            "both join 'front.side' and 'back.up', in unlike ways",
            "seams.s",
        ),
        (LONG + '[seams.s]\nfrom = "back.up"\nto = "front.side"\n', "both join 'front.side' and 'back.up'", "seams.s"),
        (LONG + 'stiffness = "3 kg"\n', "a mass", "seams.long.stiffness"),
    ],
)
def test_seams_that_make_no_sense(tmp_path, seams, what, where):
    error = refused(tmp_path, (LONG, seams))
    assert what in error.what and where in error.where and error.do


def test_an_edge_may_be_in_two_seams_with_unlike_others(tmp_path):
    """As where two layers are sewn to one waist."""
    (tmp_path / "good.toml").write_text(
        SCENE.replace(LONG, LONG + '[seams.s]\nfrom = "front.side"\nto = "front.left"\n')
    )
    assert len(load_scene(tmp_path / "good.toml").seams) == 3


def test_a_sewn_fold(tmp_path):
    fold = ('outline = ["hem", "side", "top", "left"]\n', 'outline = ["hem", "side", "top", "left"]\nmirror = "left"\n')
    error = refused(tmp_path, fold, (LONG, LONG.replace("front.side", "front.left")))
    assert "about which the panel is unfolded" in error.what and "mirror" in error.do and "seams.long" in error.where


@pytest.mark.parametrize(
    ("place", "what"),
    [
        ("at = [0.2, 0.1]", "panels front and back would overlap"),
        ("at = [0.05, 0.05]", "back would lie inside panel front"),
    ],
)
def test_panels_that_overlap(tmp_path, capsys, place, what):
    text = SCENE.replace('grain = "30 deg"', "at = [0, 0]").replace('angle = "25 deg"', place)
    if "inside" in what:
        text = text.replace("b = [0, 0.4]\nc = [0.2, 0.2]", "b = [0, 0.1]\nc = [0.1, 0.05]")
    (tmp_path / "bad.toml").write_text(text)
    assert main(["check", str(tmp_path / "bad.toml")]) == 2
    printed = " ".join(capsys.readouterr().err.split())
    assert what in printed and "bad.toml: panels" in printed and "packed in rows" in printed


def test_places_in_messages_are_those_of_the_panel(tmp_path):
    crossed = SCENE.replace("c = [0.3, 0.4]\nd = [0, 0.4]", "c = [0, 0.4]\nd = [0.3, 0.4]")
    scene = tmp_path / "bad.toml"
    scene.write_text(crossed.replace('grain = "30 deg"', 'at = [0.7, 0.4]\nangle = "90 deg"'))
    with pytest.raises(UserError, match=r"edge front\.left near \(0\.15, 0\.2\) m of panel front"):
        outline_of(load_scene(scene))


def test_panels_of_unlike_units(tmp_path):
    error = refused(tmp_path, ("b = [0, 0.4]\nc = [0.2, 0.2]", "b = [0, 40]\nc = [20, 20]"))
    assert "it is 40 m long, and panel front 0.4 m" in error.what and "panels.back" in error.where
    assert 'such as "40 cm"' in error.do


def test_a_pattern_in_the_wrong_unit_is_noted(tmp_path, capsys):
    drawing = ezdxf.new("R2010", units=ezdxf.units.M)
    drawing.modelspace().add_lwpolyline([(0, 0), (40, 0), (40, 60)], close=True, dxfattribs={"layer": "1"})
    drawing.saveas(tmp_path / "large.dxf")
    assert main(["pattern", str(tmp_path / "large.dxf"), "--out", str(tmp_path / "large.svg")]) == 0
    assert "is 60 m long: check the unit of the file" in capsys.readouterr().out


def test_a_curve_of_an_unknown_kind_is_named_with_its_line(tmp_path):
    drawing = ezdxf.new("R2010")
    face = drawing.modelspace().add_3dface([(0, 0), (1, 0), (1, 1), (0, 1)], dxfattribs={"layer": "1"})
    drawing.saveas(tmp_path / "faces.dxf")
    with pytest.raises(UserError, match=r"3DFACE on layer '1', line \d+ cannot be part") as found:
        read_pattern_dxf(tmp_path / "faces.dxf")
    line = int(found.value.what.split("line ")[1].split()[0])
    assert (tmp_path / "faces.dxf").read_text().splitlines()[line - 1].strip() == face.dxf.handle


def test_what_an_svg_has_besides_is_counted_and_named(tmp_path):
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100"><title>t</title>'
        '<g><rect id="front" width="50" height="40"/><text>size 38</text><text>cut 2</text></g><hatch/></svg>'
    )
    assert read_pattern_svg(tmp_path / "a.svg").notes == ("not read: 2 <text>, 1 <hatch>",)

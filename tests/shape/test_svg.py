"""SVG drawings: areas against closed forms, names, units and transforms, and what no drawing may ask for."""

import math

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from restshape.errors import UserError
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.drawings.imported_shape import imported_shape
from restshape.shape.outline import Outline

KAPPA = 0.5522847498


def svg(body: str, size: str = 'width="100mm" height="50mm" viewBox="0 0 200 100"', more: str = "") -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" {size} {more}>{body}</svg>'
    )


def read(folder, text: str, **more) -> Outline:
    (folder / "x.svg").write_text(text, encoding="utf-8")
    return outline_from_spec(ShapeSpec.model_validate({"file": "x.svg", **more}), folder)


PLATE = '<rect id="plate" width="200" height="100"/>'
ROUND = f"M 60,50 C 60,{50 + 10 * KAPPA} {50 + 10 * KAPPA},60 50,60 S 40,{50 + 10 * KAPPA} 40,50 "
ROUND += f"{50 - 10 * KAPPA},40 50,40 60,{50 - 10 * KAPPA} 60,50 z"
HOLES = {
    "circle": ('<circle id="h" cx="50" cy="50" r="10"/>', 100 * math.pi, "arc", 1e-12),
    "ellipse": ('<ellipse id="h" cx="50" cy="50" rx="30" ry="10"/>', 300 * math.pi, "spline", 1e-6),
    "turned": (
        '<g transform="translate(50 50) rotate(30)"><ellipse id="h" rx="30" ry="10"/></g>',
        300 * math.pi,
        "spline",
        1e-6,
    ),
    "scaled": ('<circle id="h" r="1" transform="matrix(30 0 0 10 50 50)"/>', 300 * math.pi, "spline", 1e-6),
    "sheared": ('<circle id="h" r="10" transform="translate(50 50) skewX(40)"/>', 100 * math.pi, "spline", 1e-6),
    "mirrored": (
        '<path id="h" transform="translate(90 50) scale(-1 1)" d="M0 0 h20 a10 10 0 0 1 -20 0 z"/>',
        50 * math.pi,
        "arc",
        1e-12,
    ),
    "drawn for a circle": (f'<path id="h" d="{ROUND}"/>', 100 * math.pi, "arc", 1e-12),
    "quadratic": ('<path id="h" d="M 40 40 H 80 Q 60 80 40 40 z"/>', 2 / 3 * 40 * 20, "spline", 1e-12),
    "cubic": ('<path id="h" d="M 40 40 H 80 C 80 60 40 60 40 40 z"/>', 0.6 * 40 * 20, "spline", 1e-12),
    "with units": ('<circle id="h" cx="50" cy="50" r="0.1in"/>', 9.6**2 * math.pi, "arc", 1e-12),
    "a copy": (
        '<defs><circle id="h" cx="5" cy="5" r="10"/></defs><use xlink:href="#h" x="45" y="45"/>',
        100 * math.pi,
        "arc",
        1e-12,
    ),
    "a symbol": (
        '<symbol id="s"><circle id="h" r="10"/></symbol><use href="#s" transform="translate(50 50)"/>',
        100 * math.pi,
        "arc",
        1e-12,
    ),
}


SHALLOW = 1.02 / 3.0 * 20.0
"""A handle of a curve of 0.05 rad from its chord at both ends, 2 % longer than that of an arc."""


def test_a_shallow_curve_that_no_program_draws_for_a_circle_is_exact(tmp_path):
    """The area between it and its chord is 0.6 chord - 0.3 (way of a handle along it), times the handles' height."""
    height = SHALLOW * math.tan(0.05)
    path = f"M 40 40 H 60 C {60 - SHALLOW} {40 + height} {40 + SHALLOW} {40 + height} 40 40 z"
    outline = read(tmp_path, svg(PLATE + f'<path id="h" d="{path}"/>'))
    area = (0.6 * 20.0 - 0.3 * SHALLOW) * height
    assert -outline.loop_area(1) == pytest.approx(0.25e-6 * area, rel=1e-12)


@pytest.mark.parametrize("name", list(HOLES))
def test_holes_have_the_area_of_their_closed_form(tmp_path, name):
    body, area, kind, within = HOLES[name]
    outline = read(tmp_path, svg(PLATE + body))
    assert outline.names("hole") == ["h"]
    assert -outline.loop_area(1) == pytest.approx(0.25e-6 * area, rel=within)
    assert kind in {outline.edges[e].kind for e, _ in outline.loops[1].edges}
    assert outline.area() == pytest.approx(0.25e-6 * (20_000 - area), rel=1e-6)


def test_the_origin_stays_and_y_goes_up(tmp_path):
    outline = read(tmp_path, svg(PLATE, 'width="20cm" viewBox="-5 -5 200 100"'))
    np.testing.assert_allclose(outline.bounds(), [[0.0, -0.1], [0.2, 0.0]], atol=1e-12)


@pytest.mark.parametrize(
    ("size", "metres", "doubted"),
    [
        ('width="100mm" height="50mm" viewBox="0 0 200 100"', 5e-4, False),
        ('width="100mm" height="500mm" viewBox="0 0 200 100"', 5e-4, False),
        ('width="2in" height="1in" viewBox="0 0 200 100"', 2 * 0.0254 / 200, False),
        ('height="72pt" viewBox="0,0,200,100"', 0.0254 / 100, False),
        ('viewBox="0 0 200 100"', 0.0254 / 96, True),
        ('width="400" height="200" viewBox="0 0 200 100"', 2 * 0.0254 / 96, True),
        ('width="100%" height="100%"', 0.0254 / 96, True),
        ("", 0.0254 / 96, True),
    ],
)
def test_the_size_of_a_drawing_gives_its_unit(tmp_path, size, metres, doubted):
    outline = read(tmp_path, svg(PLATE, size))
    assert outline.area() == pytest.approx(20_000 * metres**2, rel=1e-12)
    drawing = imported_shape(ShapeSpec(file="x.svg"), tmp_path)
    assert drawing is not None and bool(drawing.doubt) == doubted


GROUPS = """
<g id="layer1" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:label="Cut lines">
  <path id="bottom" d="M0 100 h200"/><path id="tip" d="M200 100 v-100"/>
  <path class="x" d="M200 0 h-200 v100"/>
</g>
<g id="window"><path d="M20 20 h20"/><path d="M40 20 v20"/><path d="M40 40 L20 20"/></g>
<g id="region_pad"><rect x="60" y="20" width="20" height="20"/></g>
<rect id="soft" class="region" x="90" y="20" width="20" height="20"/>
<g style="display:none"><circle id="hidden" r="5"/></g>
<g id="notes"><text>not drawn</text><path id="arrow" d="M150 50 h20"/></g>
<clipPath id="c"><circle r="5"/></clipPath><mask id="m"><circle r="5"/></mask><!-- a comment -->
"""


def test_ids_and_groups_are_names_and_layers_choose_among_them(tmp_path):
    with pytest.raises(UserError, match=r"open at .*path 'arrow'"):
        read(tmp_path, svg(GROUPS))
    layers = {"Cut lines": "border", "window": "window", "region_pad": "region_pad"}
    outline = read(tmp_path, svg(GROUPS), layers=layers)
    assert outline.names("hole") == ["window"] and outline.names("region") == ["region_pad"]
    assert len(outline.entity("border").edges) == 4
    outline = read(tmp_path, svg(GROUPS.replace('<path id="arrow" d="M150 50 h20"/>', "")))
    assert set(outline.names("region")) == {"region_pad", "soft"} and outline.names("hole") == ["window"]
    assert outline.length(outline.entity("tip").edges[0]) == pytest.approx(0.05)
    with pytest.raises(UserError, match="no layer 'cut'") as found:
        read(tmp_path, svg(GROUPS), layers={"cut": "border"})
    assert "'Cut lines'" in found.value.do


def test_gaps_are_closed_within_the_tolerance_and_reported(tmp_path):
    body = '<path id="a" d="M0 0 h200 v100 h-200"/><path id="b" d="M0.4 99.7 L0 0"/>'
    with pytest.raises(UserError, match=r"nearest open end, of path 'b', is 0.00025 m away") as found:
        read(tmp_path, svg(body))
    assert "shape.tolerance" in found.value.do
    with pytest.raises(UserError, match="open"):
        read(tmp_path, svg(body), tolerance="0.2 mm")
    outline = read(tmp_path, svg(body), tolerance="0.3 mm")
    # The corner (0, 100) moves to the middle of the gap, (0.2, 99.85).
    assert outline.area() == pytest.approx(0.25e-6 * (20_000 - 0.5 * 200 * 0.15 - 0.5 * 100 * 0.2), rel=1e-9)
    drawing = imported_shape(ShapeSpec(file="x.svg", tolerance=3e-4), tmp_path)
    assert drawing is not None and len(drawing.gaps) == 1
    assert drawing.gaps[0].size == pytest.approx(2.5e-4) and drawing.gaps[0].between == ("path 'a'", "path 'b'")
    assert drawing.gaps[0].at == pytest.approx((0.1e-3, -49.925e-3))


def test_a_drawing_of_matplotlib(tmp_path):
    """Its page is in pt, its circles are of eight Bézier curves, and its axes are groups of other names."""
    figure = Figure(figsize=(4, 3))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, 4), ylim=(0, 3))
    axes.add_patch(Rectangle((0.5, 0.5), 3, 2, fill=False, gid="plate"))
    axes.add_patch(Circle((2, 1.5), 0.5, fill=False, gid="bore"))
    figure.savefig(tmp_path / "page.svg")
    spec = ShapeSpec.model_validate({"file": "page.svg", "layers": {"plate": "rim", "bore": "bore"}})
    outline = outline_from_spec(spec, tmp_path)
    assert outline.area() == pytest.approx((6.0 - math.pi * 0.25) * 0.0254**2, rel=1e-5)
    assert {outline.edges[e].kind for e in outline.entity("bore").edges} == {"arc"}
    drawing = imported_shape(spec, tmp_path)
    assert drawing is not None and drawing.doubt == ""


LAUGHS = "".join(f'<g id="l{i}"><use xlink:href="#l{i + 1}"/><use xlink:href="#l{i + 1}"/></g>' for i in range(24))
HOSTILE = {
    "copies of copies": (
        svg(f'<defs>{LAUGHS}<rect id="l24" width="1" height="1"/></defs><use xlink:href="#l0"/>'),
        "copies",
    ),
    "a copy of itself": (svg('<g id="a"><use xlink:href="#a"/></g>'), "none may hold itself|deeper"),
    "depth": (svg("<g>" * 5000 + "</g>" * 5000), "deeper than 32"),
    "no XML": ("<svg", "no SVG"),
    "another tree": ("<html/>", "it is <html>"),
    "entities": (
        '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa">'
        + "".join(f'<!ENTITY {b} "{f"&{a};" * 20}">' for a, b in zip("abcdefg", "bcdefgh"))
        + "]>"
        + svg("<text>&h;</text>"),
        "no SVG",
    ),
    "a long style": (svg(f"<style>{'a' * 30_000}</style>"), "style sheet"),
    "a long path": (svg(f'<path d="M0 0{" h1" * 2_000_000}"/>'), "shapes with their copies"),
    "infinite": (svg('<path id="p" d="M0 0 h1e999 v1 z"/>'), "path 'p' has a coordinate that is no finite number"),
    "a coordinate that is no number": (
        svg('<g><path id="p" d="M 0 0 L 100 0 L NaN 50 Z"/></g>'),
        "path 'p': d has no number at ' 0 0 L 100 0 L NaN 50 Z'",
    ),
    "an infinite corner": (svg('<polygon points="0,0 1,0 1,1e400"/>'), "polygon without an id has a coordinate"),
    "a radius that is no number": (svg('<circle id="c" cx="1" cy="1" r="nan"/>'), "circle 'c': r has no number"),
    "a transform that is none": (
        svg('<rect id="r" width="1" height="1" transform="matrix(1 0 0 inf 0 0)"/>'),
        "rect 'r': transform has no number",
    ),
    "a transform beyond numbers": (
        svg('<path id="p" transform="scale(1e200)" d="M 0 0 h 1e200 v 1 z"/>'),
        "path 'p' has a coordinate that is no finite number",
    ),
    "far": (svg('<path d="M0 0 h1e99 v1 z"/>'), "farther"),
    "a broken path": (svg('<path d="M0 0 h x"/>'), "SVG|no curve"),
    "a broken box": (svg(PLATE, 'viewBox="0 0 a b"'), "viewBox"),
    "nothing": (svg(""), "no curve"),
}


@pytest.mark.parametrize("name", list(HOSTILE))
def test_what_no_drawing_may_ask_for_is_refused(tmp_path, name):
    text, why = HOSTILE[name]
    with pytest.raises(UserError, match=why) as found:
        read(tmp_path, text)
    assert found.value.where == "x.svg"

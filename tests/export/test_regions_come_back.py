"""Regions of a drawing that was exported come back as regions, under the names that the scene gives to its layers."""

import ezdxf
import numpy as np
import pytest

from restshape.export.dxf_drawing import write_dxf
from restshape.export.svg_drawing import write_svg
from restshape.mesh.entity_area import entity_area
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec

CLIP = ShapeSpec(
    outline=["foot", "nose", "crest", "back"],
    vertices={"a": [0, 0], "b": [0.08, 0], "c": [0.08, 0.03], "d": [0, 0.04]},
    edges={
        "foot": {"line": ["a", "b"]},
        "nose": {"arc": ["b", "c"], "bulge": 0.7},
        "crest": {"spline": ["c", "d"], "through": [[0.06, 0.046], [0.03, 0.035]]},
        "back": {"arc": ["d", "a"], "bulge": -0.1},
    },
    holes={"bore": {"circle": {"center": [0.07, 0.016], "radius": 0.006}}},
    regions={
        "pad": {"circle": {"center": [0.025, 0.018], "radius": 0.009}},
        "bush": {"polygon": [[0.045, 0.008], [0.056, 0.008], [0.056, 0.022], [0.045, 0.022]]},
    },
)
EDGES = {name: name for name in ("foot", "nose", "crest", "back", "bore")}
WRITTEN = {"dxf": {"region_pad": "pad", "region_bush": "bush"}, "svg": {"pad": "pad", "bush": "bush"}}


@pytest.mark.parametrize(("kind", "write"), [("dxf", write_dxf), ("svg", write_svg)])
def test_regions_whose_layers_get_other_names_stay_regions(tmp_path, kind, write):
    """A disc of 9 mm and a rectangle of 11 mm x 14 mm, in a clip of a line, two arcs and a spline."""
    first = outline_from_spec(CLIP)
    write(first, tmp_path / f"clip.{kind}")
    layers = EDGES | WRITTEN[kind]
    back = outline_from_spec(ShapeSpec(file=f"clip.{kind}", layers=layers), tmp_path)
    assert sorted(back.names("region")) == ["bush", "pad"] and back.names("hole") == ["bore"]
    assert back.area() == pytest.approx(first.area(), rel=1e-9)
    assert entity_area(back, "pad") == pytest.approx(np.pi * 0.009**2, rel=1e-9)
    assert entity_area(back, "bush") == pytest.approx(0.011 * 0.014, rel=1e-9)
    for name in ("nose", "crest", "back"):
        (i,), (j,) = back.entity(name).edges, first.entity(name).edges
        assert back.edges[i].kind == first.edges[j].kind
        assert back.length(i) == pytest.approx(first.length(j), rel=1e-9)


def test_a_layer_that_the_scene_names_a_region_is_one(tmp_path):
    drawing = ezdxf.new("R2010", units=ezdxf.units.MM)
    space = drawing.modelspace()
    for layer, radius in (("PLATE", 30), ("Core", 10)):
        space.add_circle((0, 0), radius, dxfattribs={"layer": layer})
    drawing.saveas(tmp_path / "disc.dxf")
    shape = ShapeSpec(file="disc.dxf", layers={"PLATE": "rim", "Core": "region_core"})
    assert outline_from_spec(shape, tmp_path).names("region") == ["region_core"]

"""What `restshape check` shows of panels: where they lie, how large they are, and regions of one half of a fold."""

import math

import pytest
from small_scenes import write_scene
from test_pattern_panels import garment, panel

from restshape.cli.bare_numbers import bare_numbers
from restshape.mesh.entity_area import entity_area
from restshape.physics.cloth.panel_inspection import inspect_panels
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

PATCH = "regions = { patch = { polygon = [[0.05, 0.05], [0.1, 0.05], [0.1, 0.1]] } }"
HELD = '[supports.held]\non = "front.bottom"\nfix = ["x", "y", "z"]\n'
HEAVY = "[material.heavy]\nE = 1e6\nnu = 0.3\nrho = 5000\nthickness = 3e-4\nregion = {}\n"


def scene_of(folder, *tables: str):
    return load_scene(write_scene(folder, garment(*tables, HELD)))


def test_places_of_panels_are_those_of_their_outlines(tmp_path):
    scene = scene_of(tmp_path, panel("front"), panel("back", "move = [0, 0, 3]"), panel("belt", "angle = 0.5"))
    outline, found = outline_from_spec(scene.shape), inspect_panels(scene)
    vertices = dict(zip(outline.vertex_names, outline.points, strict=False))
    for name, place in found.data["panel_places"].items():
        assert vertices[f"{name}.a"] == pytest.approx(place["at"])
    assert found.data["panel_places"]["belt"]["angle"] == 0.5
    assert found.rows[2][1].endswith("turned by 28.6479 deg in the pattern plane")
    assert not bare_numbers(scene, 0.3)


@pytest.mark.parametrize(
    ("region", "warned"),
    [
        ('"front.patch"', "its image front.mirror.patch is not"),
        ('"front.mirror.patch"', "its image front.patch is not"),
        ('["front.patch", "front.mirror.patch"]', ""),
    ],
)
def test_a_region_that_one_half_has_alone_is_warned_of(tmp_path, region, warned):
    found = inspect_panels(scene_of(tmp_path, panel("front", 'mirror = "left"', PATCH), HEAVY.format(region))).warnings
    assert len(found) == bool(warned) and all(warned in one for one in found)


def test_the_area_of_a_panel_is_its_own_less_its_holes(tmp_path):
    holed = panel("front", 'mirror = "left"', "holes = { bore = { circle = { center = [0.1, 0.08], radius = 0.02 } } }")
    outline = outline_from_spec(scene_of(tmp_path, holed, panel("back", "move = [0, 0, 3]")).shape)
    front, back = 2.0 * (0.2 * 0.15 - math.pi * 0.02**2), 0.2 * 0.15
    assert [entity_area(outline, name) for name in ("front", "back", "all")] == pytest.approx(
        [front, back, front + back]
    )

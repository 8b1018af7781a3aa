"""Suggestions for a board that sags too far shorten its span, and stay within the limit by beam theory."""

import json

import pytest
from furniture_scenes import write_edits
from restshape_apps.furniture.physics.fasteners import wood
from small_scenes import make_replay, rows_of

G, LIMIT = 9.80665, 3e-3

LEDGE = """
format = "restshape-scene"
version = 1
app = "furniture"
[wood]
name = "oak"
thickness = "20 mm"
[fastener]
name = "screw"
spacing = "40 mm"
[planks.wall]
from = [0, 0.2, 0.01]
to = [0, 0.2, 1.61]
width = [1, 0, 0]
[planks.foot]
from = [0, -1.2, 0.01]
to = [0, 1.2, 0.01]
width = [1, 0, 0]
[planks.shelf]
from = [0, 0.19, 1.2]
to = [0, -0.711, 1.2]
width = [0.9, 0, 0]
[weights.books]
on = "shelf"
mass = "25 kg"
at = [0.5, 0, 0.5]
[effects.gravity]
[effects.bending]
[quantities]
sag = { deflection = true, at = "shelf", max = "3 mm" }
"""


@pytest.mark.slow
def test_a_deep_shelf_is_made_shallower_or_thicker_by_what_a_cantilever_needs(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(LEDGE)
    row = rows_of(make_replay(path, write_edits(tmp_path), "auto"))[-1]
    depth, material = 0.901, wood("oak")

    def sag(depth, thick):
        own = material.density * 0.9 * thick * G
        return (25 * G * depth**3 / 3 + own * depth**4 / 8) / (material.E * 0.9 * thick**3 / 12)

    assert row["violated_constraints"].startswith(f"sag is {1e3 * sag(depth, 0.02):.4g} mm")
    shorter, *_, thicker = json.loads(row["suggestions"])
    assert "shelf" in shorter["words"] and "shorter along its x" in shorter["words"]
    assert sag(depth - shorter["range"][0], 0.02) == pytest.approx(LIMIT, rel=2e-3)
    assert sag(depth - shorter["t"], 0.02) < LIMIT
    thick = dict(zip(*[iter(thicker["set"])] * 2))["wood.thickness"]
    # The next board of usual thickness is 8 mm thinner.
    assert sag(depth, thick) < LIMIT < sag(depth, thick - 0.008)

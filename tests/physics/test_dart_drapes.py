"""Drapes of cloth with darts: their derivative by a dart's width, and frames that go on from the last mesh."""

import numpy as np
import pytest
from drape_designs import HELD, DrapeDesign, sheet
from small_scenes import make_replay, write_scene, write_script

from restshape.scene.load import revise
from restshape.shape.build import outline_from_spec

DART = '[darts.dart]\nedge = "right"\nlength = 0.08\nwidth = 0.03\n'
WIDER = [{"t": 0, "do": "set", "key": "darts.dart.width", "value": 0.04, "frames": 2}]


def moved_by_width(design: DrapeDesign) -> np.ndarray:
    """Rates (n, 2) of the mesh's nodes as the dart gets wider: on edges those of the outline, inside none."""
    mesh, width, h = design.analysis.space, design.scene.darts["dart"].width, 1e-5
    ends = [outline_from_spec(revise(design.scene, "darts.dart.width", width + s * h).shape).points for s in (1, -1)]
    rates, out = (ends[0] - ends[1]) / (2 * h), np.zeros_like(mesh.X)
    for edge in range(len(mesh.outline.edges)):
        on = np.unique(mesh.facets[mesh.facet_edge == edge])
        way = mesh.outline.point(edge, np.array([0.0, 1.0]))
        share = (mesh.X[on] - way[0]) @ (way[1] - way[0]) / np.sum((way[1] - way[0]) ** 2)
        out[on] = mesh.outline.point(edge, share, rates)
    return out


def test_the_remainder_of_the_derivative_by_the_width_is_of_second_order(tmp_path):
    design = DrapeDesign(tmp_path, sheet("hinge", HELD, DART, size=0.04))
    dX = moved_by_width(design)
    assert np.abs(dX).max() == pytest.approx(0.5, rel=1e-6)
    first, second = design.remainders(dX, 1e-3)
    assert second > 1e-10, "nothing to compare with"
    assert 1.8 < np.log2(first / second) < 2.2


def test_a_wider_dart_keeps_the_mesh_and_rests_as_a_new_one_of_its_numbers(tmp_path):
    scene, script = write_scene(tmp_path, sheet("hinge", HELD, DART, size=0.04)), write_script(tmp_path, WIDER)
    reused, rebuilt = (make_replay(scene, script, name=name) for name in ("auto", "rebuild"))
    rows = list(reused.frames())
    assert [row["level"] for row in rows[1:]] == [1, 1]
    again = list(rebuilt.frames())
    assert all(row["converged"] for row in [*rows, *again])
    assert rows[-1]["seam_gap"] == pytest.approx(again[-1]["seam_gap"], rel=0.2)
    areas = [replay.analysis.problem.lumped.area.sum() for replay in (reused, rebuilt)]
    assert areas[0] == pytest.approx(areas[1], rel=1e-12)
    lowest = [replay.analysis.problem.corners(replay.analysis.x)[:, 2].min() for replay in (reused, rebuilt)]
    assert lowest[0] == pytest.approx(lowest[1], rel=2e-2)

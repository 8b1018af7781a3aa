"""Moments that durability does not count: fasteners one by one, levers by hand, and words in a frame."""

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.physics.uncounted_moments import uncounted_moments, uncounted_uses
from restshape_apps.furniture.pieces import SCENES, drawn
from small_scenes import make_replay

G = 9.80665
POST = """format = "restshape-scene"
version = 1
app = "furniture"
title = "a post on a board"
[wood]
name = "pine"
thickness = "18 mm"
[fastener]
name = "screw"
spacing = "20 mm"
[floor]
friction = 0.9
[planks.base]
center = [0, 0, "9 mm"]
size = [4, 4]
[planks.post]
from = [0, 0, "18 mm"]
to = [0, 0, "1018 mm"]
width = [0, WIDTH, 0]
[pushes.across]
on = "post"
at = [0.5, 0, 0]
force = [1, 0, 0]
[pushes.along]
on = "post"
at = [0.5, 0, 0]
force = [0, FORCE, 0]
[effects.gravity]
[effects.push]
"""


def post(width: str, force: str) -> str:
    """A post whose joint is as long as it is wide, pushed at its top along the joint."""
    return POST.replace("WIDTH", f'"{width}"').replace("FORCE", f'"{force}"')


def analysed(tmp_path, text: str):
    path = tmp_path / "scene.toml"
    path.write_text(text)
    replay = make_replay(path)
    rows = list(replay.frames())
    return replay.analysis, rows[-1]


@pytest.mark.parametrize(("width", "nails"), [(0.02, 1), (0.04, 2), (0.1, 5), (0.3, 15)])
def test_a_post_pushed_along_its_joint_draws_its_screws(tmp_path, width: float, nails: int) -> None:
    force = 20.0
    analysis, row = analysed(tmp_path, post(f"{width} m", f"{force} N"))
    furniture = analysis.design.furniture
    geometry, forces = furniture.geometry(), analysis.forces[2]
    drawn_out, turned = uncounted_uses(furniture, forces, geometry.length, furniture.nails())
    # About the end of the line, on which the post turns: the farthest of screws in the middles of equal parts.
    places = (np.arange(nails) + 0.5) * width / nails
    moment, weight = force * 1.0, 420.0 * 0.018 * width * 1.0 * G
    pull = moment * places[-1] / (places**2).sum() - weight / nails
    assert furniture.nails()[0] == nails
    assert drawn_out[0] == pytest.approx(pull / 549.0, rel=5e-3)
    assert turned[0] == pytest.approx(0.0, abs=1e-6)
    assert ("bends joint post on base" in row["note"]) == (pull > 549.0) == (nails < 5)
    assert row["constraint_status"] == "holds"


@pytest.mark.parametrize("nails", [2, 3, 7])
def test_a_twist_shears_each_fastener_by_its_distance_from_the_middle(tmp_path, nails: int) -> None:
    analysis, _ = analysed(tmp_path, post("0.1 m", "1 N"))
    furniture, forces = analysis.design.furniture, analysis.forces[0]
    forces.twist[:] = [0.0, 3.0]
    length = np.array([0.1])
    places = (np.arange(nails) + 0.5) * 0.1 / nails - 0.05
    _, turned = uncounted_uses(furniture, forces, length, np.array([float(nails)]))
    assert turned[0] == pytest.approx(3.0 * places[-1] / (places**2).sum() / furniture.strength[0, 1])


def test_one_screw_holds_no_twist(tmp_path) -> None:
    # The arm's load lies 0.3 m beside its only screw.
    arm = """
[planks.arm]
from = ["9 mm", 0, 0.8]
to = ["209 mm", 0, 0.8]
width = [0, 0, "24 mm"]
[planks.out]
from = [0.2, 0.009, 0.8]
to = [0.2, 0.6, 0.8]
width = ["18 mm", 0, 0]
[weights.w]
on = "out"
at = [0.5, 0, 0.5]
mass = "MASS"
"""
    text = post("0.9 m", "1 N").split("[pushes.across]")[0] + "[effects.gravity]\n" + arm
    analysis, row = analysed(tmp_path, text.replace("MASS", "0.5 kg"))
    joint = [analysis.design.piece.planks[one.i].name for one in analysis.design.piece.joints].index("arm")
    own = 420.0 * 0.018 * 0.018 * 0.591 * G * 0.3
    assert analysis.forces[0].twist[joint, 1] == pytest.approx(0.5 * G * 0.6 + own, rel=0.05)
    assert row["constraint_status"] == "holds" and "what twists joint arm on post is more" in row["note"]


def test_scenes_of_the_application_have_none_of_it() -> None:
    for path in sorted(SCENES.glob("*.toml")):
        furniture = Furniture(drawn(path.stem))
        furniture.test()
        cases = [furniture.forces(case) for case in range(len(furniture.cases))]
        still = np.zeros((len(furniture.piece.planks), 8))
        assert uncounted_moments(furniture, cases, still) == "", path.stem

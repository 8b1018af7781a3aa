"""Seams of cloth that something holds where it is."""

import logging
import re

from small_scenes import make_replay, write_scene
from test_pattern_panels import garment, panel

from restshape.physics.cloth.relaxation.close_seams import PATIENCE

PANELS = panel("left", "move = [-0.25, 0, 0]") + panel("right", "move = [0.05, 0, 0]")
SEAM = '[seams.middle]\nfrom = "left.right"\nto = "right.left"\n'
HELD = '[supports.held]\non = ["left", "right"]\nfix = ["x", "y", "z"]\n'
POST = "[bodies.{name}]\ncapsule = {{ start = [{x}, 0.07, -0.3], end = [{x}, 0.07, 0.3], radius = 0.02 }}\n"


def pulls(folder, caplog, *tables: str) -> list[float]:
    """With what part of their stiffness seams have pulled, round by round, in the first frame."""
    replay = make_replay(write_scene(folder, garment(PANELS, SEAM, *tables)))
    with caplog.at_level(logging.INFO, logger="restshape.physics"):
        next(iter(replay.frames()))
    return [float(found[1]) for found in re.finditer(r"Seams open by \S+ m: pulled with (\S+) of", caplog.text)]


def test_seams_of_cloth_at_rest_pull_harder_until_they_have_all_of_their_stiffness(tmp_path, caplog):
    found = pulls(tmp_path, caplog, HELD)
    assert found == sorted(found) and found[0] < 0.1 and found[-1] == 1.0


def test_cloth_that_no_step_moves_is_given_up_far_from_rest(tmp_path, caplog):
    posts = POST.format(name="one", x=-0.15) + POST.format(name="other", x=0.15)
    found = pulls(tmp_path, caplog, posts, "[effects.contact]\n")
    assert len(found) == PATIENCE and found[-1] < 1.0

"""By how much planks overlap, where, and what is said to do: against the test of overlap, which knows no sizes."""

from dataclasses import replace

import numpy as np
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.guidance.overlap_advice import overlap_advice
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.report.guided import runs
from restshape_apps.furniture.shape.overlap_sizes import overlap_sizes
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import Piece, Plank
from restshape_apps.furniture.tests.furniture_scenes import BENCH, write_bench, write_edits
from scipy.spatial.transform import Rotation
from small_scenes import make_replay

from restshape.scene.load import load_scene


def design(tmp_path, old: str = "", new: str = "", more: str = "") -> Design:
    return Design.closed(piece_of(load_scene(write_bench(tmp_path, BENCH.replace(old, new) + more))), Guidance())


def overlaps(piece: Piece) -> tuple[tuple[int, int], ...]:
    return tuple(pair for pair in Furniture(piece).geometry().overlaps if pair[1] >= 0)


def test_two_planks_touch_once_one_has_gone_as_far_as_is_said() -> None:
    rng = np.random.default_rng(3)
    tried = 0
    for _ in range(200):
        planks = tuple(
            Plank(name, rng.normal((0, 0, 5), 0.05), Rotation.random(random_state=rng).as_matrix(), size)
            for name, size in zip("ab", rng.uniform(0.02, 0.4, (2, 3)))
        )
        piece = Piece(planks, (), ())
        if not overlaps(piece):
            continue
        tried += 1
        (one,) = overlap_sizes(piece, overlaps(piece))

        def apart(far: float, piece: Piece = piece, way: np.ndarray = one.way) -> Piece:
            first, other = piece.planks
            return replace(piece, planks=(first, replace(other, centre=other.centre + far * way)))

        assert not overlaps(apart(one.depth)) and overlaps(apart(one.depth - 3e-4))
        for plank in planks:
            assert np.all(np.abs(plank.axes.T @ (one.place - plank.centre)) <= plank.size)
    assert tried > 100


def test_a_leg_through_the_floor_names_the_floor_the_amount_and_the_mend(tmp_path) -> None:
    for deep in (0.04, 0.06, 0.2):
        found = design(tmp_path, "from = [0.5, 0, 0]", f"from = [0.5, 0, {-deep}]")
        assert found.furniture.test().words[0] == f"overlapping: right and the floor by {1e3 * deep:.4g} mm"
        first = found.suggestion_list.found[0]
        assert first.valid and first.words == f"right {1e3 * deep:.4g} mm shorter at its end -x, to meet the floor"
        (said,) = overlap_advice(found.piece, found.furniture.geometry().overlaps)
        assert said.startswith(
            f"right goes {1e3 * deep:.4g} mm into the floor: make it {1e3 * deep:.4g} mm shorter at -x"
        )


# A block of 20 mm lies across, 4 mm in the top, whose upper face is at z = 0.52 m.
BLOCK = "\n[planks.block]\nfrom = [-0.1, 0, 0.526]\nto = [0.1, 0, 0.526]\nwidth = [0, 0.1, 0]\n"


def test_the_status_says_by_how_much_along_what_and_where(tmp_path) -> None:
    found = design(tmp_path, more=BLOCK)
    words = found.furniture.test().words
    assert "overlapping: top and block by 4 mm along z at (0, 0, 518) mm" in words
    assert found.advice == "move block 4 mm along +z, off top"


def test_frames_of_a_drag_that_differ_in_overlap_are_one_row_with_the_worst(tmp_path) -> None:
    path = write_bench(tmp_path, BENCH + BLOCK)
    # From 4 mm deep to 7 mm, and 50 mm aside.
    drag = {"do": "drag", "to": [0.05, 0, 0.523], "frames": 3}
    rows = list(make_replay(path, write_edits(tmp_path, {"do": "press", "on": "block"}, drag)).frames())
    (span,) = runs(rows)
    assert "top and block by up to 7 mm along z at (50, 0, 516) mm" in span[2]

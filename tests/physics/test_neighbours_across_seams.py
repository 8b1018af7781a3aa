"""Parts that are sewn together do not count as crossings: they are no deeper in each other than the seam is open."""

import numpy as np
from small_scenes import make_replay, write_scene
from test_pattern_panels import garment, panel

LEFT = panel("left", "move = [-0.2, 0, 0]")
RIGHT = panel("right", "move = [0.01, 0, 0]", height=0.18)
SEAM = '[seams.middle]\nfrom = "left.right"\nto = "right.left"\nease = 0.3\n'
HELD = '[supports.held]\non = ["left.left", "right.right"]\nfix = { x = "-0.4*x", y = 0, z = 0 }\n'


def through(x: np.ndarray, edges: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """How deep (k,) [m] edges are in triangles that they pass through at x (n, 3): the way out on a side, or beside."""
    e, c = (part.ravel() for part in np.mgrid[: len(edges), : len(cells)])
    apart = ~(edges[e][:, :, None] == cells[c][:, None, :]).any(axis=(1, 2))
    p, q, (a, b, d) = *x[edges[e[apart]]].swapaxes(0, 1), x[cells[c[apart]]].swapaxes(0, 1)
    normal = np.cross(b - a, d - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    below, above = (np.einsum("ij,ij->i", normal, end - a) for end in (p, q))
    with np.errstate(divide="ignore", invalid="ignore"):
        at = p + (below / (below - above))[:, None] * (q - p)
    beside = []
    for one, other in ((a, b), (b, d), (d, a)):
        inwards = np.cross(normal, other - one)
        beside.append(np.einsum("ij,ij->i", inwards, at - one) / np.linalg.norm(inwards, axis=1))
    inside = (below * above < 0.0) & (np.min(beside, axis=0) > 0.0)
    return np.min([*beside, np.abs(below), np.abs(above)], axis=0)[inside]


def test_what_is_sewn_is_no_deeper_in_each_other_than_the_seam_is_open(tmp_path):
    """Sides of unlike nodes, with a wrinkle: edges beside the seam pass through triangles by micrometres, uncounted."""
    replay = make_replay(write_scene(tmp_path, garment(LEFT, RIGHT, SEAM, HELD)))
    (row,) = replay.frames()
    problem = replay.analysis.problem
    corners = problem.corners(replay.analysis.x)
    depths = through(corners, problem.surface.edges, problem.surface.cells)
    assert row["converged"] and row["crossings"] == 0
    assert len(depths) and depths.max() <= row["seam_gap"] < 1e-3

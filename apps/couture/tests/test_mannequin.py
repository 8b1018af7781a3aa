"""Mannequins are closed surfaces whose girths are those that are asked for."""

import json
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path

import meshio
import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.physics.cloth.mannequin.mannequin_surface import Mannequin
from restshape.scene.body_sizes import BODIES, Sizes

PATTERNS = Path(__file__).parents[1] / "patterns"
CM = 0.01


def random_sizes() -> Sizes:
    """Sizes of a body that no one has thought of."""
    share = np.random.default_rng(14).uniform(size=5)
    height = 1.2 + 0.8 * share[0]
    low, high = np.array([0.48, 0.36, 0.5, 0.22]), np.array([0.58, 0.52, 0.6, 0.25])
    return Sizes(height, *(height * (low + (high - low) * share[1:])))


@pytest.fixture(scope="module", params=["standard", "broad", "random"])
def body(request) -> Mannequin:
    """A coarse body of each kind."""
    sizes = (BODIES.get(request.param) or random_sizes()).completed()
    return Mannequin(sizes, sizes.height / 62)


def section(nodes: np.ndarray, triangles: np.ndarray, level: float) -> list[np.ndarray]:
    """The closed curves (n, 2) in which a plane z = level cuts a surface, by the sides that it passes."""
    above = nodes[:, 2] > level
    sides = np.sort(np.stack([triangles[:, [i, (i + 1) % 3]] for i in range(3)], axis=1), axis=2)
    cut = above[sides[..., 0]] != above[sides[..., 1]]
    names, index = np.unique(sides[cut], axis=0, return_inverse=True)
    a, b = nodes[names[:, 0]], nodes[names[:, 1]]
    share = (level - a[:, 2]) / (b[:, 2] - a[:, 2])
    places = (a + share[:, None] * (b - a))[:, :2]
    pairs = index.reshape(-1, 2)  # each triangle that is cut has two such sides
    graph = csr_matrix((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(names),) * 2)
    count, label = connected_components(graph, directed=False)
    return [places[label == k] for k in range(count)]


def girth(curve: np.ndarray) -> float:
    """The length [m] of a tape around a curve."""
    return float(ConvexHull(curve).area)


def test_its_surface_is_closed_and_manifold_and_faces_outwards(body):
    nodes, triangles = body.nodes, body.triangles
    assert len(triangles) >= 5000 and np.unique(triangles).size == len(nodes)
    sides = {tuple(side) for triangle in triangles.tolist() for side in pairwise([*triangle, triangle[0]])}
    assert len(sides) == 3 * len(triangles) and all(side[::-1] in sides for side in sides)
    # One piece without handles; around each node the triangles are one fan, or this would not hold.
    assert len(nodes) - len(sides) // 2 + len(triangles) == 2
    graph = csr_matrix((np.ones(len(sides)), tuple(np.array(sorted(sides)).T)), shape=(len(nodes),) * 2)
    assert connected_components(graph, directed=False)[0] == 1
    a, b, c = (nodes[triangles[:, k]] for k in range(3))
    # A body of this height and hip holds about what a cylinder of half its hip does.
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    assert volume == pytest.approx(0.55 * body.sizes.height * body.sizes.hip**2 / (4.0 * np.pi), rel=0.3)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 1e-7


def test_it_has_the_sizes_that_are_asked_for(body):
    sizes = body.sizes
    assert np.ptp(body.nodes[:, 2]) == pytest.approx(sizes.height, abs=CM) and abs(body.nodes[:, 2].min()) < 2e-3
    for name in ("bust", "waist", "hip"):
        curves = section(body.nodes, body.triangles, body.level(name))
        trunk = min(curves, key=lambda curve: abs(curve[:, 0].mean()))
        assert girth(trunk) == pytest.approx(getattr(sizes, name), abs=0.5 * CM)
    (trunk,) = section(body.nodes, body.triangles, body.level("shoulder"))
    assert np.ptp(trunk[:, 0]) == pytest.approx(sizes.shoulder, abs=0.5 * CM)


def test_the_girth_of_a_section_is_that_of_its_polygon():
    from restshape.physics.cloth.mannequin.tube import section as half_ellipses

    half, front, back = half_ellipses(0.9, 1.3, 0.6)
    angle = np.linspace(0.0, 2.0 * np.pi, 4001)
    y = np.where(np.sin(angle) < 0.0, front, back) * np.sin(angle)
    assert girth(np.column_stack([half * np.cos(angle), y])) == pytest.approx(0.9, rel=1e-6)
    assert half / (0.5 * (front + back)) == pytest.approx(1.3) and front / (front + back) == pytest.approx(0.6)


@pytest.mark.parametrize("name", BODIES)
def test_the_bodies_beside_the_patterns_are_what_the_command_makes(name, tmp_path):
    out, report = tmp_path / "body.obj", tmp_path / "body.json"
    assert main(["mannequin", "--body", name, "--size", "27 mm", "--out", str(out), "--json", str(report)]) == 0
    made, kept = meshio.read(out), meshio.read(PATTERNS / f"{name}.obj")
    assert np.array_equal(made.cells_dict["triangle"], kept.cells_dict["triangle"])
    assert np.abs(made.points - kept.points).max() < 5e-5 and out.stat().st_size < 500_000
    found = json.loads(report.read_text())
    assert found["sizes"] == asdict(BODIES[name].completed())
    assert found["triangles"] == len(made.cells_dict["triangle"])


@pytest.mark.parametrize(
    ("wrong", "place", "what"),
    [
        ({"bust": 3.0}, "--bust", "168 cm with bust 300 cm cannot be made"),
        ({"height": 17.0}, "--height", "height 1700 cm"),
        ({"upper_arm": 0.1}, "--upper-arm", "upper arm 10 cm"),
        ({"bust": 1.3, "shoulder": 0.36}, "--shoulder", "arms of this body meet its trunk at the level of the bust"),
    ],
)
def test_sizes_that_no_body_has_are_refused(wrong, place, what):
    with pytest.raises(UserError) as caught:
        Mannequin(Sizes(**wrong).completed(), 0.03)
    assert caught.value.where == place and what in caught.value.what and caught.value.do


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (["--bust", "88 kg"], "a mass, but a length is wanted"),
        (["--bust", "-88 cm"], "'-88 cm' is no length of a body"),
        (["--size", "2 m"], "triangles of 2 m do not suit a body of 168 cm"),
        (["--out", "body.stl"], "body.stl is no .obj file"),
    ],
)
def test_bad_options_are_refused(words, what, tmp_path, capsys):
    assert main(["mannequin", "--out", str(tmp_path / "body.obj"), *words]) == 2
    assert what in capsys.readouterr().err and not any(tmp_path.iterdir())


@pytest.mark.slow
def test_a_picture_has_its_measures(tmp_path):
    assert main(["mannequin", "--size", "28 mm", "--picture", str(tmp_path / "body.png")]) == 0
    assert (tmp_path / "body.png").stat().st_size > 20_000

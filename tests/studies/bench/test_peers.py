"""The same edits through other solvers: what is handed over, how answers are compared, and what is said of them."""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from restshape_studies.commands.bench_peers import check, draw, named_peers
from restshape_studies.peers import comparison
from restshape_studies.peers.cases import CASES
from restshape_studies.peers.comparison import compare, distance, of_case
from restshape_studies.peers.installed import HERE, PROGRAMS, WAYS, run
from restshape_studies.peers.page import losses, page
from restshape_studies.peers.played import play, scene_path

from restshape.errors import UserError
from restshape.scene.load import load_scene

ROOT = Path(__file__).parents[3]
INSTALLED = Path(os.environ.get("RESTSHAPE_PEERS", ROOT / ".peers"))
STATIC = CASES["static-2000"]
DRAPE = CASES["drape"]


@pytest.mark.slow
@pytest.mark.cli
@pytest.mark.parametrize("peer", STATIC.peers)
def test_a_peer_agrees(peer):
    if not (INSTALLED / peer / "python").is_file():
        pytest.skip(f"{peer} is not installed: scripts/peers.sh {INSTALLED} {peer}")
    found = compare(STATIC, [peer], INSTALLED, 2, print)
    for way in WAYS:
        one = found["peers"][peer][way]
        assert one.get("distance", 1.0) < STATIC.tolerance and one.get("frames") == 2, (way, one)


@pytest.fixture(scope="module")
def handed(tmp_path_factory):
    """The folder that a peer is handed, of a plate that is dragged for two frames."""
    folder = tmp_path_factory.mktemp("handed")
    return folder, play(STATIC, 2, folder)


def imported(name):
    """A module of the exchange, which a peer's Python runs."""
    sys.path.insert(0, str(HERE / "exchange"))
    try:
        return __import__(name)
    finally:
        sys.path.pop(0)


def test_meshes_and_moved_places_are_handed_over(handed):
    folder, times = handed
    case = imported("handed").read_case(folder)
    assert times["levels"] == [3, 0, 1, 1] and case.mesh_of == [0, 0, 0, 0] and case.problem == "static"
    (mesh,) = case.meshes
    assert len(mesh.cells) == times["elements"] and 2 * len(mesh.points) == times["unknowns"]
    left = mesh.points[mesh.nodes_on("left")]
    assert len(left) > 10 and np.abs(left[:, 0]).max() < 1e-12
    hole = [name for name in mesh.facets if name.startswith("window")]
    shift = (case.places[3] - case.places[1])[mesh.nodes_on(*hole)]
    assert shift == pytest.approx(np.broadcast_to([0.002, 0.0], shift.shape), abs=1e-9)
    # The border's sides bound the area, with the material on their left.
    ends = mesh.points[np.concatenate(list(mesh.facets.values()))]
    corners = mesh.points[mesh.cells]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]).sum()
    assert 0.5 * (ends[:, 0, 0] * ends[:, 1, 1] - ends[:, 0, 1] * ends[:, 1, 0]).sum() == pytest.approx(area)


def test_a_new_mesh_makes_a_new_solver():
    made = []

    class Solver:
        def __init__(self, mesh, parameters):
            made.append((mesh, parameters))

        def frame(self, points):
            return 2 * points

    places = [np.full((3, 2), float(k)) for k in range(4)]
    case = SimpleNamespace(meshes=["a", "b"], mesh_of=[0, 0, 1, 1], places=places, parameters={})
    answers, seconds, processor, short = imported("play").play(Solver, case)
    assert made == [("a", {}), ("b", {})] and len(seconds) == len(processor) == 4 and short == ""
    Solver.short = "not there yet"
    assert imported("play").play(Solver, case)[3] == "not there yet"
    assert [one[0, 0] for one in answers] == [0, 2, 4, 6]


def save(path, *answers):
    """Answers as a file."""
    np.savez(path, **{f"answer_{k}": np.array(one) for k, one in enumerate(answers)})
    return path


def test_distances_are_relative_to_the_rise_above_the_origin(tmp_path):
    ours = save(tmp_path / "a.npz", [300.0, 300.0], [300.0, 302.0])
    theirs = save(tmp_path / "b.npz", [300.0, 300.0], [300.0, 302.02])
    assert distance(ours, theirs, 300.0) == pytest.approx(0.01)
    assert distance(ours, save(tmp_path / "c.npz", [300.0, 300.0], [300.0, float("nan")]), 300.0) != 0
    assert np.isnan(distance(ours, tmp_path / "c.npz", 300.0))


@pytest.mark.parametrize(("factor", "counts"), [(1 + 1e-6, True), (1.01, False), (float("nan"), False)])
def test_a_time_counts_only_where_answers_agree(tmp_path, factor, counts):
    save(tmp_path / "restshape.npz", [1.0, 2.0])
    save(tmp_path / "answers.npz", [factor, 2.0 * factor])
    other = {"processor_ms": 6.0, "version": "Other 1", "short": ""}
    found = comparison._beside(STATIC, {"processor_ms": 2.0}, other, tmp_path)
    assert (found.get("ratio") == 3.0) is counts and ("failed" in found) is not counts
    found = comparison._beside(STATIC, {"processor_ms": 2.0}, other | {"short": "a residual of 0.3"}, tmp_path)
    assert found["failed"].startswith("a residual of 0.3; its answers differ by") and "ratio" not in found


def test_finite_elements_and_cloth_have_their_own_peers():
    assert of_case(STATIC, tuple(PROGRAMS)) == ["dolfinx", "scikit-fem", "ngsolve", "freefem"]
    assert of_case(DRAPE, tuple(PROGRAMS)) == ["newton"]
    assert all((HERE / PROGRAMS["newton"] / f"{way}.py").is_file() for way in WAYS)


@pytest.mark.weekly
@pytest.mark.cli
def test_the_drape_of_a_peer_is_ours_and_its_residual_is_said():
    if not (INSTALLED / "newton" / "python").is_file():
        pytest.skip(f"newton is not installed: scripts/peers.sh {INSTALLED} newton")
    tuned = compare(DRAPE, ["newton"], INSTALLED, 0, print)["peers"]["newton"]["tuned"]
    apart = tuned["distance"] if "distance" in tuned else float(tuned["failed"].rsplit(" ", 1)[1])
    assert apart < DRAPE.tolerance


def test_what_the_drape_is_handed_is_the_scene(tmp_path):
    times = play(DRAPE, 0, tmp_path)
    case, given = imported("handed").read_case(tmp_path), DRAPE.parameters
    assert times["levels"] == [3] and case.problem == "drape"
    pins = [np.intersect1d(case.meshes[0].nodes_on(one), case.meshes[0].nodes_on(two)) for one, two in given["pins"]]
    assert case.meshes[0].points[np.concatenate(pins)] == pytest.approx(np.array([[0, 0.5], [0.5, 0.5]]))
    scene = load_scene(scene_path(DRAPE.scene))
    cotton = scene.material["cotton"]
    stiffness = cotton.E * cotton.thickness
    assert given["mu"] == pytest.approx(stiffness / 2 / (1 + cotton.nu)) and given["bending"] == cotton.bending
    assert given["lam"] == pytest.approx(stiffness * cotton.nu / (1 - cotton.nu**2))
    assert given["density"] == pytest.approx(cotton.rho * cotton.thickness)


def test_forces_of_the_cloth_peer_are_the_gradient_of_its_energy():
    sys.path.insert(0, str(HERE / "newton"))
    try:
        forces = __import__("forces")
    finally:
        sys.path.pop(0)
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.9, 1.0], [-0.1, 1.1]])
    flat = np.column_stack([points, np.zeros(4)])
    edges = np.array([[3, 1, 2, 0], [1, -1, 0, 3]])
    stiffness = forces.hinge_stiffness(flat, edges, 0.3)
    length = np.hypot(0.9, 1.0)
    assert stiffness == pytest.approx([0.3 * length / (0.5 * (0.9 + 1.0) + 0.045 + 0.05), 0.0], rel=0.1)
    cells = np.array([[0, 1, 2], [0, 2, 3]])
    cloth = forces.ClothForces(points, cells, edges, stiffness, 1.3, 2.0, 0.1, [])
    rng = np.random.default_rng(3)
    x, way, h = flat + 0.2 * rng.normal(size=(4, 3)), rng.normal(size=(4, 3)), 1e-6
    slope = (cloth.energy(x + h * way) - cloth.energy(x - h * way)) / (2 * h)
    assert slope == pytest.approx(-(cloth.forces(x) * way).sum(), rel=1e-7)
    # Without load it is at rest in the plane, and pulled it resists as Lame's numbers say.
    free = forces.ClothForces(points, cells, edges, stiffness, 1.3, 2.0, 0.0, [])
    assert np.abs(free.forces(flat)).max() < 1e-12
    pulled = (free.energy(flat * [1 + 1e-4, 1, 1]) - free.energy(flat)) / free.area.sum()
    assert pulled == pytest.approx(0.5e-8 * (1.3 + 2 * 2.0), rel=1e-3)


def record(ratio):
    """A case, as `compare` gives it, with a peer that takes so many times restshape's time."""
    own = {"processor_ms": 2.0, "ms": 2.0, "first_ms": 9.0, "peak_mb": 100.0}
    other = own | {"processor_ms": 2.0 * ratio, "ratio": ratio, "distance": 1e-8, "version": "Other 1", "ms": None}
    own |= {"version": "0", "elements": 10, "unknowns": 12, "frames": 3}
    ways = {"documented": other, "tuned": {"cannot": "it has no such element"}}
    return {"title": "a case", "note": "", "machine": "a CPU", "restshape": own, "peers": {"other": ways}}


def test_the_page_begins_with_what_is_lost(tmp_path):
    found = {"won": record(4.0), "lost": record(0.5), "worse": record(0.25)}
    assert [(one.case, one.times) for one in losses(found)] == [("worse", 4.0), ("lost", 2.0)]
    text = page(found, "restshape bench peers")
    assert text.index("## Where restshape loses") < text.index("## won") and "it has no such element" in text
    assert "Other 1" in text and "a CPU" in text and "Nowhere" in page({"won": record(4.0)}, "restshape bench peers")
    args = SimpleNamespace(cases="newmark", peers="", frames=None, picture=tmp_path / "peers" / "README.md")
    draw({"still": record(4.0)}, args, args.picture)
    assert "restshape bench peers --cases newmark" in args.picture.read_text()


def test_a_peer_that_is_not_installed_is_named_with_how_to_install_it(tmp_path):
    with pytest.raises(UserError) as problem:
        named_peers("freefem", tmp_path)
    assert problem.value.do == f"scripts/peers.sh {tmp_path} freefem"
    with pytest.raises(UserError, match="no peer is installed"):
        named_peers("", tmp_path)
    (tmp_path / "ngsolve").mkdir()
    (tmp_path / "ngsolve" / "python").touch()
    assert named_peers("", tmp_path) == ("ngsolve",)


@pytest.mark.parametrize("wrong", [{"scenes": ["a"]}, {"frames": 0}, {"repeat": 0}, {"cases": "x"}, {"peers": "x"}])
def test_bad_arguments_are_refused(tmp_path, wrong):
    given = {"scenes": [], "frames": None, "repeat": 1, "cases": "", "peers": "", "installed": tmp_path}
    with pytest.raises(UserError):
        check(SimpleNamespace(**given | wrong))


@pytest.mark.cli
def test_a_process_is_measured_and_ended_in_time():
    ended = run([sys.executable, "-S", "-c", "import sys; sys.exit('at a loss')"], 10.0)
    assert ended.code == 1 and ended.said == "at a loss" and ended.peak_mb > 1 and 0 < ended.seconds < 10
    assert "has not ended" in run([sys.executable, "-S", "-c", "while True: pass"], 0.1).said


@pytest.mark.parametrize(("words", "said"), [((), "no folder"), (("x", "matlab"), "no peer matlab")])
def test_the_script_says_what_it_wants(tmp_path, words, said):
    command = ["bash", str(ROOT / "scripts" / "peers.sh"), *words]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 1 and said in done.stderr and "try:" in done.stderr

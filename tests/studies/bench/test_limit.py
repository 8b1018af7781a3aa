"""The least time of a frame: bytes and operations counted by hand, and rates of this machine. No time is asserted."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc
from restshape_studies.bench import limit
from restshape_studies.bench.job import Job
from restshape_studies.bench.limit import ANSWER, BESIDE, Applied, Sizes, Work, least, record, sizes_of, works
from restshape_studies.bench.process import request
from restshape_studies.pictures.limit import draw_limits
from small_scenes import across, drag, plate, write_scene, write_script

from restshape import _kernels
from restshape.errors import UserError
from restshape.measurement import measure_bandwidth

# A square of two triangles: 4 nodes, 5 edges. The matrix has a block a node and two an edge, the factor one of each.
SQUARE = Sizes(
    nodes=4,
    dim=2,
    fields=2,
    cells=2,
    corners=3,
    points=1,
    blocks=4 + 2 * 5,
    preconditioner=Applied.substitution(4 * (4 + 5), 2, 4),
    recorded=20,
    observed=True,
)


def test_bytes_of_two_triangles_are_those_counted_by_hand():
    vector = places = 4 * 2 * 8
    matrix = 14 * (4 * 8 + 4) + 5 * 4
    factor = 9 * (4 * 8 + 4)
    applied = SQUARE.preconditioner
    assert (SQUARE.matrix, applied.stored, SQUARE.vector) == (matrix, factor, vector) == (524, 324, 64)
    assert applied.bytes == 2 * factor + 4 * vector and applied.flops == 4 * 36
    moved = {name: work.bytes for name, work in works(SQUARE, 1).items()}
    cells = 2 * 3 * 4
    assert moved["relocate"] == 4 * places + cells == 280
    # Places, cells, where each of 9 pairs a cell lies, 56 numbers of the matrix, the right side.
    assert moved["values"] == places + cells + 2 * 9 * 2 + 56 * 8 + vector == 636
    # Two products; both passes of a substitution and its four vectors; eleven vectors of the iteration, three before.
    assert moved["krylov"] == 2 * matrix + 2 * factor + 4 * vector + 11 * vector + 3 * vector == 2848
    assert moved["observe"] == cells + places + vector == 152
    assert moved["residual"] == matrix + 2 * vector
    assert moved["estimate"] == 2 * 152 + 2 * 4 * 3 * 8
    assert moved["record"] == 152 + 2 * 20 * 8


def test_a_working_set_is_what_was_touched_since_the_data_were_in_use():
    sets = {name: work.working_set for name, work in works(SQUARE, 1).items()}
    iterated = 524 + 324 + 6 * 64
    assert sets["krylov"] == sets["residual"] == sets["observe"] == iterated
    assert sets["relocate"] == sets["values"] == iterated + 4 * 64 + 24 + 2 * 9 * 2 + 20 * 8
    assert sets["estimate"] == 152 + 4 * 3 * 8 and sets["record"] == 152 + 20 * 8


def test_operations_of_two_triangles_are_those_counted_by_hand():
    flops = {name: work.flops for name, work in works(SQUARE, 1).items()}
    # A cell: gradients 14, times both moduli 12, six blocks of four numbers of three operations, 36 sums.
    assert flops["values"] == 2 * (14 + 12 + 6 * 4 * 3 + 36) == 268
    assert flops["krylov"] == 2 * (2 * 56) + 4 * 36 + 12 * 8
    assert flops["residual"] == 2 * 56 + 3 * 8


def test_numbers_of_half_the_size_halve_the_factor_and_each_iteration_adds_as_much():
    applied, half = SQUARE.preconditioner, Applied.substitution(36, 2, 4, 4)
    assert applied.stored - half.stored == 36 * 4 and applied.bytes - half.bytes == 2 * 36 * 4
    moved = [works(SQUARE, iterations)["krylov"].bytes for iterations in range(4)]
    assert set(np.diff(moved)) == {SQUARE.matrix + applied.bytes + 11 * SQUARE.vector}
    # Without an iteration: b - A x alone.
    assert moved[0] == SQUARE.matrix + 3 * SQUARE.vector


def test_a_cycle_passes_each_grid_once_and_each_map_twice():
    # Two grids: 3 rows full, and 8 rows of 56 numbers in blocks of two; a map of 8 x 3 numbers.
    cycle = Applied.cycle([(3, 9, 3), (8, 56, 2)], [24])
    fine, coarse, between = 56 * 4 + 14 * 4, 9 * 4 + 4, 24 * 4 + 4 * 4
    # The inverses of the diagonal are passed twice, and six vectors; single numbers, blocks of 2 x 3 of the map.
    assert cycle.bytes == fine + 2 * 4 * 8 * 2 + 6 * 8 * 8 + 2 * between
    assert cycle.stored == fine + coarse + between and cycle.numbers == 9 + 56 + 24
    # Both triangles of an incomplete LU are passed once.
    assert Applied.substitution(36, 2, 4, kind="ilu").bytes == 36 * 8 + 9 * 4 + 4 * 64


def test_a_stage_is_bound_by_what_takes_longer():
    assert least(Work(1e6, 1e3, 1e6), 1e10, 1e9) == (pytest.approx(0.1), "bytes")
    assert least(Work(1e3, 1e6, 1e3), 1e10, 1e9) == (pytest.approx(1.0), "flops")


def rows(ms):
    """Frames whose stages take so many milliseconds each."""
    times = {f"ms_{name}": ms for name in (*ANSWER, *BESIDE)}
    return [{"iterations": k, "ms_answer": 6.0 * ms, **times} for k in (2, 4)]


def test_the_fraction_is_the_limit_over_the_median():
    sets = []

    def bandwidth(working_set):
        sets.append(working_set)
        return 1e9

    found = record(SQUARE, rows(0.01), bandwidth, 1e30)
    assert found["iterations"] == 3.0 and found["rest_ms"] == pytest.approx(0.02)
    krylov = found["stages"]["krylov"]
    assert krylov["bytes"] == works(SQUARE, 3)["krylov"].bytes
    assert krylov["fraction"] == pytest.approx(1e3 * krylov["bytes"] / 1e9 / 0.01)
    # Working sets of a frame, of an iteration, of the estimate and of a recording, each measured once.
    assert len(sets) == len(set(sets)) == 4
    parts = [found["stages"][name]["least_ms"] for name in (*ANSWER, *BESIDE)]
    assert found["whole"]["least_ms"] == pytest.approx(sum(parts))
    assert found["whole"]["ms"] == pytest.approx(0.09) and found["answer"]["ms"] == pytest.approx(0.06)


def test_the_triad_is_one_and_its_rate_a_number():
    a, b, c = np.zeros(100), np.arange(100.0), np.full(100, 0.5)
    assert 0.0 < _kernels.triad_seconds(a, b, c, 3, 2) < 1.0
    # The last of three passes has the factor 3.
    np.testing.assert_array_equal(a, b + 3.0 * c)
    with pytest.raises(ValueError, match="three arrays"):
        _kernels.triad_seconds(a, b, c[:50], 1, 1)
    with pytest.raises(ValueError, match="pass"):
        _kernels.triad_seconds(a, b, c, 0, 1)
    for rate in (measure_bandwidth(1e4), _kernels.flop_rate(100, 2)):
        assert math.isfinite(rate) and rate > 1e6


def case(folder):
    """A replay of a plate whose hole moves a little."""
    scene = write_scene(folder, plate(0.2))
    script = write_script(folder, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.53, 0.5), 5)))
    return Job(str(scene), str(script), "auto")


@pytest.mark.slow
def test_sizes_are_those_of_the_mesh_and_fractions_are_parts(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(limit, "sizes_of", lambda analysis: seen.append(analysis) or sizes_of(analysis))
    found = limit.measure(request(case(tmp_path)), 3)
    (analysis,) = seen
    cells = analysis.problem.space.cells
    edges = {frozenset(pair) for cell in cells for pair in (cell[:2], cell[1:], cell[::2])}
    sizes = found["sizes"]
    assert sizes["cells"] == len(cells) and sizes["unknowns"] == 2 * len(analysis.problem.space.X)
    assert sizes["blocks"] == sizes["nodes"] + 2 * len(edges)
    # Not less than without fill, not more than a full triangle; numbers of four or eight bytes.
    filled = sizes["preconditioner"]["numbers"]
    assert sizes["nodes"] + len(edges) <= filled / 4 <= sizes["nodes"] * (sizes["nodes"] + 1) / 2
    assert sizes["preconditioner"]["stored"] in (filled * 4 + filled, filled * 8 + filled)
    assert found["frames"] == 3 and list(found["stages"]) == [*ANSWER, *BESIDE]
    for name, entry in found["stages"].items():
        assert set(entry) == {"bytes", "flops", "working_set", "bandwidth", "least_ms", "ms", "fraction", "bound"}
        assert entry["fraction"] is None or 0.0 < entry["fraction"] < 1.5, name
        assert entry["bound"] in ("bytes", "flops")
    assert 0.0 < found["answer"]["fraction"] < 1.5 and found["whole"]["ms"] > found["answer"]["ms"]
    assert json.loads(json.dumps(found)) == found


@pytest.mark.slow
def test_multigrid_has_a_limit_too(tmp_path):
    job = replace(case(tmp_path), petsc=("-solid_pc_type", "gamg"))
    PETSc.Options().setValue("solid_pc_type", "gamg")
    try:
        found = limit.measure(request(job), 2)
    finally:
        PETSc.Options().delValue("solid_pc_type")
    assert found["sizes"]["preconditioner"]["kind"] == "gamg" and 0.0 < found["stages"]["krylov"]["fraction"] < 1.5


@pytest.mark.slow
def test_what_has_no_limit_says_so(tmp_path):
    job = case(tmp_path)
    path = Path(job.scene)
    path.write_text(path.read_text() + "\n[effects.large_deformation]\n")
    with pytest.raises(UserError, match="linear"):
        limit.measure(request(job), 1)
    path.write_text(plate(0.2))
    idle = write_script(tmp_path, [{"do": "idle"}])
    with pytest.raises(UserError, match="no frame moves"):
        limit.measure(request(replace(job, edits=str(idle))), 1)


def test_the_picture_has_a_bar_and_a_limit_a_stage_and_nothing_is_clipped(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    one = record(SQUARE, rows(0.01), lambda working_set: 1e9, 1e9)
    draw_limits({"plate": {"triangles": {"2": one, "20": one}}}, tmp_path / "a.png")
    (figure,) = figures
    figure.draw_without_rendering()
    assert len(figure.axes) == 2
    for axes in figure.axes:
        assert len(axes.patches) == 2 * (len(one["stages"]) + 1)
        assert [bar.get_width() for bar in axes.patches[1:-2:2]] == [e["least_ms"] for e in one["stages"].values()]
        for text in (*axes.texts, axes._left_title, axes.xaxis.label):
            box = text.get_window_extent()
            assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1, text


@pytest.mark.cli
@pytest.mark.parametrize("words", [("--triangles", "many"), ("--frames", 0)])
def test_bad_input(command, words):
    done = command("bench", "limit", *words)
    assert done.returncode == 2 and words[0] in done.stderr and " try: " in done.stderr


@pytest.mark.cli
@pytest.mark.usefixtures("jobs_here")
def test_a_scene_whose_limit_is_not_known_is_refused_with_those_it_is_known_of(command):
    scenes = Path(__file__).parents[2] / "scenes"
    words = (scenes / "building.toml", "--edits", scenes / "building.jsonl", "--triangles", 300)
    done = command("bench", "limit", *words)
    assert done.returncode == 2 and "building.toml: the limit is known of linear steady problems" in done.stderr
    assert " try: take a linear scene" in done.stderr


@pytest.mark.slow
@pytest.mark.cli
@pytest.mark.usefixtures("jobs_here")
def test_the_limit_for_programs_and_people(tmp_path, command):
    words = ("--triangles", 500, "--frames", 2, "--json", "a.json")
    done = command("bench", "limit", *words)
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    one = found["plate"]["triangles"]["500"]
    assert found["plate"]["tolerance"] == 1e-6 and 300 < one["sizes"]["cells"] < 800
    for word in ("bound by", "until the answer", "triad", "working set"):
        assert word in done.stdout
    assert (tmp_path / "results/bench-limit.png").is_file()
    (tmp_path / "results/bench-limit.png").unlink()
    assert command("bench", "limit", "--redraw", "a.json").returncode == 0
    assert (tmp_path / "results/bench-limit.png").is_file()

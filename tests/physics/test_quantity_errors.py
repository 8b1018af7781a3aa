"""Errors of quantities of linear scenes: derivatives against differences, estimates against finer meshes."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from small_scenes import CLAMPED, HEAD, HOLE, STEEL, block, drag, make_replay, meshed, plate, rows_of, write_scene
from small_scenes import write_script as scripted
from thermal_scenes import ANNULUS
from thermal_scenes import solved as heat_solved

from restshape.analysis.static import enriched_errors, quantity_errors
from restshape.application import application
from restshape.cli.schema import scene_schema
from restshape.errors import UserError
from restshape.fem.observer import area
from restshape.fem.quantity_error import dual_solution
from restshape.fem.residuals import tangent_product
from restshape.interface.first_frame import first_frame
from restshape.mesh.enriched_space import EnrichedSpace
from restshape.replay.columns import columns_of
from restshape.replay.constraints import FAILS, HOLDS, UNCERTAIN
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.replay.summary import summarise
from restshape.scene.load import load_scene

CORE = "\n[shape.regions.core]\npolygon = [[1.2, 0.3], [1.7, 0.3], [1.7, 0.7], [1.2, 0.7]]\n"
SOFT = '\n[material.soft]\nE = 70e9\nnu = 0.3\nthickness = 0.01\nregion = ["core"]\n'
PRESSED = '\n[loads.down]\non = "right"\ntraction = ["30 MPa", "-10 MPa"]\n'
ASKED = """
[quantities]
stretch = { displacement = "x", at = "right", reduce = "mean" }
corner = { displacement = "magnitude", at = "c" }
most = { displacement = "y", reduce = "absmax" }
inside = { displacement = "y", at = "core" }
place = { position = "x", at = "right" }
furthest = { position = "y", reduce = "max" }
wall = { reaction = "x", at = "left" }
energy = { energy = "strain" }
part = { energy = "strain", at = "core" }
window = { stress = "von_mises", at = "window" }
side = { stress = "xx", at = "core", reduce = "mean" }
space = { area = true }
"""
BODY = HEAD + block(2.0, 1.0) + CORE + HOLE + STEEL + SOFT + CLAMPED + PRESSED
NAMES = ("stretch", "corner", "most", "inside", "place", "furthest", "wall", "energy", "part", "window", "side")
SMOOTH = ("stretch", "inside", "wall", "energy", "part")
PATCH = Path(__file__).parents[2] / "apps" / "solid" / "scenes" / "patch.toml"
KIRSCH = Path(__file__).parents[2] / "apps" / "solid" / "scenes" / "kirsch.toml"
LIMITED = plate().replace('stretch = { displacement = "x"', 'stretch = { MAX displacement = "x"')


def solved(folder, size, order=1, text=BODY + ASKED):
    """The analysis of the body after its first frame."""
    scene = write_scene(folder, text + meshed(size, order))
    return first_frame(scene).analysis


@pytest.mark.parametrize("order", [1, 2])
def test_what_a_space_holds_comes_to_the_richer_one_as_it_is(tmp_path, order):
    """A polynomial of the space's order at all nodes, also where these have moved."""
    space = solved(tmp_path, 0.3, order, HEAD + block(2.0, 1.0) + CORE + STEEL + SOFT + CLAMPED + PRESSED).problem.space
    richer = EnrichedSpace(space)
    for _ in range(2):
        fields = [part.X[:, :1] * (0.3 + part.X[:, 1:]) ** (order - 1) for part in (space, richer.space)]
        np.testing.assert_allclose(richer.prolonged(fields[0]), fields[1], atol=1e-13)
        (space.mesh if order == 2 else space).X[:] *= (1.1, 0.9)
        if order == 2:
            space.place()
        richer.follow()
    assert len(richer.space.X) > 3 * len(space.X)


def test_triangles_with_curved_sides_are_as_they_are_on_the_richer_space(tmp_path):
    """All nodes but those on curves are where the triangles in two parts each way have them."""
    space = solved(tmp_path, 0.3, 2).problem.space
    richer = EnrichedSpace(space)
    inner = np.setdiff1d(np.arange(len(richer.space.X)), richer.space.facets)
    for _ in range(2):
        np.testing.assert_allclose(richer.prolonged(space.X)[inner], richer.space.X[inner], atol=1e-13)
        space.mesh.X[:] *= (1.1, 0.9)
        space.place()
        richer.follow()


@pytest.mark.parametrize("size", [0.141, 0.1])
def test_the_energy_of_a_patch_is_off_by_the_area_that_parabolas_leave_out(size):
    """Even strain on all of a square with a round hole: the next mesh has 1/16 of the error of the area."""
    given = ("mesh.order=2", f"mesh.size={size}", f"mesh.near.hole={0.3 * size}")
    analysis = first_frame(PATCH, given).analysis
    whole = 1.0 - np.pi * 0.11**2
    value = analysis.observe()["energy"]
    true = value * (whole / area(analysis.problem.space) - 1.0)
    assert analysis.quantity_errors(["energy"])["energy"] / abs(true) == pytest.approx(15 / 16, rel=0.02)


@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_are_those_of_differences(tmp_path, order):
    """Along a change of the free unknowns; of energies the difference is central, so that it is exact."""
    analysis = solved(tmp_path, 0.2, order)
    problem, x, functions = analysis.problem, analysis.x, analysis.state.observer.functions
    change = np.abs(x).max() * 1e-6 * np.random.default_rng(1).standard_normal(x.shape)
    problem.boundary.zero(change)
    observe = analysis.state.observer
    ahead, behind = observe(x + change), observe(x - change)
    for name in SMOOTH:
        found = functions[name].derivative(x)
        rate = (found.load * change).sum()
        if found.lift is not None:
            rate += (found.lift * tangent_product(problem, x, change)).sum()
        assert rate == pytest.approx(0.5 * (ahead[name] - behind[name]), rel=1e-5), name


def test_the_dual_of_a_quantity_gives_its_value(tmp_path):
    """J(u) = load . u = z . f where no support moves."""
    analysis = solved(tmp_path, 0.15)
    problem, x = analysis.problem, analysis.x
    derivative = analysis.state.observer.functions["stretch"].derivative(x)
    z = dual_solution(problem, derivative, lambda rhs: analysis.linear_solve(rhs, 1e-10))
    assert (z * tangent_product(problem, x, x)).sum() == pytest.approx(analysis.observe()["stretch"], rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("order", "size"), [(1, 0.06), (2, 0.12)])
def test_effectivity_against_a_fine_mesh(tmp_path, order, size):
    """Estimate over true error; the force at the only support is known exactly by equilibrium."""
    coarse, fine = solved(tmp_path, size, order), solved(tmp_path, 0.03, 2)
    values, true = coarse.observe(), fine.observe()
    found = coarse.quantity_errors(NAMES)
    for name in ("stretch", "corner", "most", "inside", "place", "energy", "part", "window"):
        assert 0.5 <= found[name] / abs(true[name] - values[name]) <= 2.0, name
    assert found["wall"] <= 1e-6 * abs(values["wall"])


@pytest.mark.parametrize(("order", "size"), [(1, 1.41), (1, 1.0), (2, 1.41)])
def test_stresses_at_a_hole_against_their_closed_form(order, size):
    """Kirsch's: 3 and -1 times what pulls."""
    given = (f"mesh.size={0.025 * size}", f"mesh.near.hole={0.004 * size}", f"mesh.order={order}")
    analysis = first_frame(KIRSCH, given).analysis
    values, errors = analysis.observe(), analysis.quantity_errors(["concentration", "compression"])
    for name, true in (("concentration", 3e6), ("compression", -1e6)):
        assert 0.7 <= errors[name] / abs(true - values[name]) <= 1.3, name


@pytest.mark.parametrize("size", [1.41, 1.0])
def test_a_limit_that_the_exact_stress_violates_does_not_hold_where_the_estimate_is_low(size):
    """Kirsch's 3 times what pulls, below a least value from which the frame's value is more than its estimate away."""
    given = (f"mesh.size={0.025 * size}", f"mesh.near.hole={0.004 * size}", "mesh.order=2")
    analysis = first_frame(KIRSCH, given).analysis
    name = "concentration"
    value, error = analysis.observe()[name], analysis.quantity_errors([name])[name]
    least = 0.5 * (3e6 + value - error)
    assert 3e6 < least < value - error
    row = first_frame(KIRSCH, (*given, f'quantities.concentration.min="{least!r} Pa"')).row
    assert row["q_concentration"] == value and row["constraint_status"] == UNCERTAIN
    assert row["note"].endswith(": twice its estimated error")


@pytest.mark.parametrize(("order", "size"), [(1, 0.12), (2, 0.12), (2, 0.085)])
def test_mean_stresses_of_a_region_against_a_fine_mesh(tmp_path, order, size):
    """Of a soft disc in a stiff plate: at the corners of a soft square the error changes sign between two meshes."""
    text = BODY.replace(CORE, "\n[shape.regions.core]\ncircle = { center = [1.45, 0.5], radius = 0.2 }\n")
    names = {name: name for name in ("xx", "yy", "von_mises")}
    text += "[quantities]\n" + "".join(f'{n} = {{ stress = "{n}", at = "core", reduce = "mean" }}\n' for n in names)
    coarse, fine = solved(tmp_path, size, order, text), solved(tmp_path, 0.04, 2, text)
    values, true, errors = coarse.observe(), fine.observe(), coarse.quantity_errors(names)
    for name in names:
        assert 0.7 <= errors[name] / abs(true[name] - values[name]) <= 1.4, name


CYLINDER = """
[shape]
outline = ["bottom", "outer", "left", "inner"]
vertices = { a = [1, 0], b = [2, 0], c = [0, 2], d = [0, 1] }
edges.bottom = { line = ["a", "b"] }
edges.outer = { arc = ["b", "c"], bulge = "tan(pi/8)" }
edges.left = { line = ["c", "d"] }
edges.inner = { arc = ["d", "a"], bulge = "-tan(pi/8)" }
[material.rubber]
E = 1e6
nu = 0.4999
thickness = 1
[effects.solid]
model = "plane_strain"
[supports]
below = { on = "bottom", fix = ["y"] }
beside = { on = "left", fix = ["x"] }
[loads.inside]
on = "inner"
pressure = PRESSURE
[quantities]
inner = { displacement = "x", at = "a" }
outer = { displacement = "x", at = "b" }
swell = { displacement = "magnitude", at = "outer", reduce = "mean" }
hoop = { stress = "max_principal", at = "inner" }
radial = { stress = "min_principal", at = "inner" }
energy = { energy = "strain" }
"""
"""A quarter of a thick cylinder of rubber under the pressure inside."""


@pytest.mark.parametrize("size", [0.2, 0.12])
@pytest.mark.parametrize("pressure", ["1e4", '"1e4 + 0*x"'])
def test_a_cylinder_of_rubber_against_its_closed_form(tmp_path, size, pressure):
    """Lame's: the means of the dilatation over triangles in four are others than those over the triangles.

    A pressure that is a formula counts by the richer space's samples, too.
    """
    analysis = solved(tmp_path, size, 2, HEAD + CYLINDER.replace("PRESSURE", pressure))
    values, nu = analysis.observe(), 0.4999
    inner, outer = (1e4 / 3 * (1 + nu) / 1e6 * ((1 - 2 * nu) * r + 4 / r) for r in (1, 2))
    true = {"inner": inner, "outer": outer, "hoop": 1e4 * 5 / 3, "radial": -1e4, "energy": 1e4 * inner * np.pi / 4}
    errors = analysis.quantity_errors([*true, "swell"])
    for name, exact in true.items():
        assert 0.5 <= errors[name] / abs(exact - values[name]) <= 2.0, name
    assert errors["swell"] < 1e-3 * values["swell"]


@pytest.mark.parametrize("order", [1, 2])
def test_what_a_dual_leaves_at_supports_is_no_error(monkeypatch, order):
    """Reactions are there, and no error of the mesh: preconditioners of several ranks leave something."""
    analysis = first_frame(
        KIRSCH, (f"mesh.order={order}", "mesh.near.hole=0.01", "quantities.energy.error=true")
    ).analysis
    exact = quantity_errors.SteadyQuantityErrors(analysis)(["energy"])["energy"]
    loose, prescribed = quantity_errors.SteadyQuantityErrors(analysis), analysis.state.problem.boundary.mask != 0
    solve = loose._dual
    monkeypatch.setattr(loose, "_dual", lambda *given: (z := solve(*given)) + 1e-3 * np.abs(z).max() * prescribed)
    assert loose(["energy"])["energy"] == pytest.approx(exact, rel=0.02)


@pytest.mark.mpi
def test_two_ranks_find_the_error_of_one_before_their_solver_has_converged(tmp_path, on_ranks):
    """Kirsch's energy at second order, off by 10^-6; a tolerance of 10^-2 leaves as much on two ranks."""
    found = []
    for ranks, tolerance in ((1, 1e-10), (2, 1e-10), (2, 1e-2)):
        given = ("mesh.order=2", "mesh.near.hole=0.01", "quantities.energy.error=true", f"solve.tolerance={tolerance}")
        words = [word for one in given for word in ("--set", one)]
        done = on_ranks(ranks, "replay", KIRSCH, *words, "--json", f"{ranks}.json")
        assert done.returncode == 0, done.stdout + done.stderr
        found += json.loads((tmp_path / f"{ranks}.json").read_text())["quantity_errors"]["energy"]
    assert found[1:] == pytest.approx(2 * [found[0]], rel=0.02)


@pytest.mark.parametrize("order", [1, 2])
def test_the_distance_from_a_target_curve_has_an_error(tmp_path, order):
    """Of a beam that bends under a load at its end, against a fine mesh."""
    text = HEAD + block(2.0, 0.4) + STEEL + CLAMPED + '[loads.down]\non = "right"\ntraction = [0, "-3 MPa"]\n'
    text += '[goal.level]\npolyline = [[0, 0.4], [2, 0.4]]\n[quantities]\noff = { distance = "level", at = "top" }\n'
    coarse, fine = solved(tmp_path, 0.2, order, text), solved(tmp_path, 0.04, 2, text)
    true = abs(fine.observe()["off"] - coarse.observe()["off"])
    assert 0.5 <= coarse.quantity_errors(["off"])["off"] / true <= 2.0


@pytest.mark.parametrize("order", [1, 2])
def test_uniform_stress_has_no_error(tmp_path, order):
    text = (
        HEAD + block(2.0, 1.0) + STEEL + '[supports.a]\non = "left"\nfix = ["x"]\n[supports.b]\non = "a"\nfix = ["y"]\n'
    )
    text += '[loads.pull]\non = "right"\ntraction = ["30 MPa", 0]\n'
    text += '[quantities]\nwide = { displacement = "x", at = "c" }\ns = { stress = "xx", at = "top" }\n'
    analysis = solved(tmp_path, 0.3, order, text)
    values, errors = analysis.observe(), analysis.quantity_errors(["wide", "s"])
    assert all(errors[name] <= 1e-9 * abs(values[name]) for name in errors)


@pytest.mark.parametrize("size", [0.02, 0.03])
def test_heat_of_a_pipe_against_its_closed_form(tmp_path, size):
    """What enters at a prescribed temperature, what leaves by convection, and the temperature between both."""
    analysis = heat_solved(tmp_path, ANNULUS, f"mesh.size={size}").analysis
    drop = 100.0 / (np.log(2.0) / 15.0 + 1.0 / (0.2 * 50.0))
    true = {"outer": 300.0 + drop / (0.2 * 50.0), "entered": -2.0 * np.pi * drop, "left1": np.pi * drop}
    values, errors = analysis.observe(), analysis.quantity_errors(list(true))
    for name, value in true.items():
        assert 0.5 <= errors[name] / abs(value - values[name]) <= 2.0, name


def test_sampled_loads_and_straight_sides_count(tmp_path):
    """Reactions: all of a parabola's traction, and the weight of what a polygon leaves of round holes."""
    text = HEAD + block() + HOLE + STEEL + CLAMPED + "[effects.gravity]\ng = [0, -9.81]\n"
    text += '[loads.down]\non = "right"\ntraction = [0, "1e6*y*(1 - y)"]\n'
    text += '[quantities]\nheld = { reaction = "y", at = "left" }\n'
    analysis = solved(tmp_path, 0.1, 1, text)
    true = 8000.0 * 9.81 * 0.01 * (1.0 - np.pi * 0.15**2) - 0.01 * 1e6 / 6.0
    error, found = abs(true - analysis.observe()["held"]), analysis.quantity_errors(["held"])["held"]
    assert error > 1.0 and found == pytest.approx(error, rel=0.05)


def test_recording_csv_and_summary_hold_errors(tmp_path):
    text = LIMITED.replace("MAX", "max = 1,").replace("wall = {", "wall = { error = true,")
    script = scripted(tmp_path, drag("window", (0.5, 0.5), [(0.55, 0.5), (0.6, 0.5), (0.5, 9.0)]))
    replay = make_replay(write_scene(tmp_path, text), script, overrides=["solve.estimate=every"])
    columns = columns_of(replay.session.scene, application("plane"))
    assert {"stretch_error", "wall_error"} <= columns.keys() and "peak_error" not in columns
    with Recorder.start(tmp_path / "a.vtkhdf", {}, columns) as recorder:
        replay.recorder = recorder
        rows = rows_of(replay)
    refused = [bool(row["refused"]) for row in rows]
    with Recording(tmp_path / "a.vtkhdf") as recording:
        found = recording.table["stretch_error"]
    np.testing.assert_array_equal(np.isnan(found), refused)
    assert (found[~np.array(refused)] > 0).all()
    errors = summarise(rows, "auto", 1)["quantity_errors"]
    assert list(errors) == ["stretch", "wall"] and [value is None for value in errors["stretch"]] == refused
    json.dumps(errors, allow_nan=False)


def test_a_limit_nearer_than_twice_the_error_is_uncertain_on_both_sides(tmp_path):
    scene = write_scene(tmp_path, LIMITED.replace("MAX", ""))
    analysis = first_frame(scene).analysis
    value, error = analysis.observe()["stretch"], analysis.quantity_errors(["stretch"])["stretch"]
    statuses = {}
    for part in (1.9, 2.1, -1.9, -2.1):
        limited = LIMITED.replace("MAX", f"max = {value + part * error!r},")
        row = first_frame(write_scene(tmp_path, limited)).row
        statuses[part] = row["constraint_status"], row["note"], row["findings"]
    assert statuses[2.1] == (HOLDS, "", "")
    for part in (1.9, -1.9):
        status, note, findings = statuses[part]
        assert status == UNCERTAIN
        side = HOLDS if part > 0.0 else FAILS
        assert note.startswith(f"stretch {side}, but uncertain: ") and note.endswith(": twice its estimated error")
        sizes = {"n": 1e-9, "µ": 1e-6, "m": 1e-3}
        found = [float(number) * sizes[prefix] for number, prefix in re.findall(r"([\d.]+) ([nµm])m", note)]
        assert found == pytest.approx([value, 2.0 * error, value + part * error], rel=0.05)
        assert [one["kind"] for one in json.loads(findings)] == ["uncertainty"]
    status, note, findings = statuses[-2.1]
    assert status == FAILS and not note and [one["kind"] for one in json.loads(findings)] == ["limit"]


def test_a_limit_at_a_singular_place_is_uncertain_where_it_holds(tmp_path):
    text = plate().replace('peak = { stress = "von_mises"', 'peak = { max = "1 GPa", stress = "von_mises"')
    row = first_frame(write_scene(tmp_path, text)).row
    assert row["peak_error"] == np.inf and row["constraint_status"] == UNCERTAIN
    beyond = write_scene(tmp_path, text.replace("1 GPa", "1 Pa"))
    assert first_frame(beyond).row["constraint_status"] == FAILS
    assert summarise([row], "auto", 1)["quantity_errors"]["peak"] == ["singular"]


@pytest.mark.parametrize(
    ("app", "effect"), [("plane", "large_deformation]\n"), ("moving", "dynamics]\ntime_step = 1e-4\nsteps = 1\n")]
)
def test_where_there_is_no_estimate_it_is_refused_or_left_out(tmp_path, app, effect):
    text = LIMITED.replace('app = "plane"', f'app = "{app}"') + f"[effects.{effect}"
    asked = write_scene(tmp_path, text.replace("MAX", "error = true,"))
    with pytest.raises(UserError, match="steady linear scenes") as refusal:
        first_frame(asked)
    assert "quantities.stretch.error" in str(refusal.value)
    row = first_frame(write_scene(tmp_path, text.replace("MAX", "max = 1,"))).row
    assert "stretch_error" not in row and row["constraint_status"] == HOLDS


def test_areas_and_names_of_other_columns_are_refused(tmp_path):
    with pytest.raises(UserError, match="no error estimate"):
        load_scene(write_scene(tmp_path, plate() + "area = { area = true, error = true }\n"))
    text = plate() + 'prediction = { error = true, displacement = "x", at = "c" }\n'
    scene = load_scene(write_scene(tmp_path, text))
    with pytest.raises(UserError, match="another column"):
        columns_of(scene, application("plane"))


@pytest.mark.parametrize("other", ["error", "jump", "max"])
def test_a_quantity_of_the_name_of_a_column_beside_another_is_refused(tmp_path, other):
    """Whether the column is recorded or not: tables alone say which of their columns are quantities."""
    both = "".join(f'{name} = {{ displacement = "x", at = "c" }}\n' for name in ("q", other))
    scene = load_scene(write_scene(tmp_path, plate() + both, "solve = { jumps = false }\n"))
    with pytest.raises(UserError, match=f"a column of it would be q_{other}, which is another column"):
        columns_of(scene, application("plane"))


def test_duals_of_a_drag_start_at_those_before(tmp_path, monkeypatch):
    """As good as from nothing, with no more applications of the preconditioner than the frames take."""
    steps = []
    plain = quantity_errors.KeptOperation

    def counted(solver, rows):
        apply = plain(solver, rows)
        return lambda r: (steps.append(1), apply(r))[1]

    monkeypatch.setattr(quantity_errors, "KeptOperation", counted)
    script = scripted(tmp_path, drag("window", (0.5, 0.5), [(0.5 + 0.01 * k, 0.5) for k in range(1, 13)]))
    replay = make_replay(write_scene(tmp_path, LIMITED.replace("MAX", "error = true,")), script)
    frames = replay.frames()
    first = next(frames)
    steps.clear()
    rows = [row for row in frames if row["level"] == 1]
    # A solve applies it once more than it iterates.
    assert len(steps) <= 1.5 * sum(row["iterations"] + 1 for row in rows), (len(steps), rows)
    cold = quantity_errors.SteadyQuantityErrors(replay.analysis)(["stretch"])["stretch"]
    assert rows[-1]["stretch_error"] == pytest.approx(cold, rel=0.02)
    assert rows[-1]["stretch_error"] != first["stretch_error"]


def test_errors_change_no_frame(tmp_path):
    """The same bits with errors and without."""
    script = scripted(tmp_path, drag("window", (0.5, 0.5), [(0.5 + 0.02 * k, 0.5) for k in range(1, 6)]))
    found = {}
    for word in ("", "error = true,"):
        scene = write_scene(tmp_path, LIMITED.replace("MAX", word))
        replay = make_replay(scene, script)
        found[word] = [(replay.analysis.x.tobytes(), row["iterations"], row["pc_age"]) for row in replay.frames()]
    assert found[""] == found["error = true,"]


def test_one_key_asks_for_all_errors_but_those_of_areas(tmp_path):
    def asked(text, *overrides):
        scene = load_scene(write_scene(tmp_path, BODY + text + meshed(0.2)), overrides)
        return {name for name, quantity in scene.quantities.items() if quantity.wants_error}

    assert asked(ASKED) == set()
    everything = ASKED.replace("[quantities]\n", "[quantities]\nerror = true\n")
    assert asked(everything) == set(NAMES) == asked(ASKED, "quantities.error=true")
    some = everything.replace("wall = {", "wall = { error = false,").replace("corner = {", "corner = { max = 1,")
    assert asked(some) == set(NAMES) - {"wall"}
    assert asked(some.replace("error = true", "error = false")) == set()
    found = solved(tmp_path, 0.2, text=BODY + everything).quantity_errors(NAMES)
    row = first_frame(tmp_path / "scene.toml").row
    assert all(row[f"{name}_error"] == pytest.approx(found[name], rel=0.05, abs=1e-9) for name in NAMES)
    assert "space_error" not in row and "error_error" not in row
    schema = scene_schema()["properties"]["quantities"]
    assert schema["properties"]["error"]["type"] == "boolean" and schema["additionalProperties"]


@pytest.mark.parametrize(
    ("app", "effect"), [("plane", "large_deformation]\n"), ("moving", "dynamics]\ntime_step = 1e-4\nsteps = 1\n")]
)
def test_one_key_for_all_errors_is_a_note_where_there_are_none(tmp_path, app, effect):
    text = plate().replace('app = "plane"', f'app = "{app}"').replace("[quantities]", "[quantities]\nerror = true")
    row = first_frame(write_scene(tmp_path, text + f"[effects.{effect}")).row
    assert row["note"] == f"no errors of quantities are estimated here: {quantity_errors.NONE_HERE}"
    assert len(row["note"]) <= 160 and "stretch_error" not in row
    # A scene of a motion may ask for frequencies too, which have no error there.
    assert "frequencies without a motion" in row["note"]


def test_a_truth_in_quotes_is_advised_to_drop_them(tmp_path):
    text = plate().replace("[quantities]", '[quantities]\nerror = "true"')
    with pytest.raises(UserError, match="drop the quotes: write true") as refusal:
        load_scene(write_scene(tmp_path, text))
    assert refusal.value.where.startswith("scene.toml: quantities.error (line ")


def test_limits_that_exclude_each_other_are_refused(tmp_path):
    text = plate().replace("stretch = {", 'stretch = { min = "3 mm", max = "2 mm",')
    with pytest.raises(UserError, match="at least 3 mm and at most 2 mm") as refusal:
        load_scene(write_scene(tmp_path, text))
    assert "quantities.stretch" in refusal.value.where
    load_scene(write_scene(tmp_path, text.replace("3 mm", "2 mm")))


@pytest.mark.parametrize("order", [1, 2])
def test_a_body_without_stress_has_no_error(tmp_path, order):
    """All that is loaded is held: no cell has a part in the derivative of the largest stress."""
    text = HEAD + block() + STEEL + CLAMPED + '[loads.p]\non = "left"\ntraction = [1e6, 0]\n'
    text += '[quantities]\nstrength = { stress = "von_mises", at = "right", max = 1e6 }\n' + meshed(0.5, order)
    row = first_frame(write_scene(tmp_path, text)).row
    assert row["strength_error"] == row["q_strength"] == 0.0 and row["constraint_status"] == HOLDS


LOADS = [("30 MPa", "-10 MPa"), ("60 MPa", "-10 MPa"), ("0 MPa", "-10 MPa"), ("0 MPa", "-11 MPa"), ("50 MPa", "20 MPa")]
"""On the right side: a pull, then a bend, then both."""


def test_estimates_go_on_from_those_of_another_load(tmp_path, monkeypatch):
    """On one mesh, against those of an analysis of its own; the space and the pattern over it are made once."""
    asked = "".join(f"{line}\n" for line in ASKED.splitlines() if "window" in line or "corner" in line)
    text = BODY + "[quantities]\nerror = true\n" + asked + meshed(0.1, 2)
    scene = write_scene(tmp_path, text)
    made = []
    monkeypatch.setattr(enriched_errors, "EnrichedSystem", counted(enriched_errors.EnrichedSystem, made))
    events = [{"do": "set", "key": "loads.down.traction", "value": list(load)} for load in LOADS]
    events.append({"do": "set", "key": "material.soft.E", "value": 20e9})
    rows = rows_of(make_replay(scene, scripted(tmp_path, events)))[1:]
    assert len(made) == 1
    last = f"loads.down.traction={list(LOADS[-1])}"
    own = [[f"loads.down.traction={list(load)}"] for load in LOADS] + [[last, "material.soft.E=20e9"]]
    for row, overrides in zip(rows, own, strict=True):
        cold = first_frame(scene, overrides).analysis.quantity_errors(("corner", "window"))
        for name, error in cold.items():
            assert row[f"{name}_error"] == pytest.approx(error, rel=0.01), name


def counted(kind, made):
    """A class that notes each of its objects."""

    def make(*args):
        made.append(kind(*args))
        return made[-1]

    return make

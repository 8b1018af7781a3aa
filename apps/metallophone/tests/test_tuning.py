"""restshape tune: bars brought to tones, the smallest change, modes that cross and pair, and bad input."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from restshape_apps.metallophone import application
from restshape_apps.metallophone.tuning import tone_rates as tone_rates_module
from restshape_apps.metallophone.tuning.bar import Bar
from restshape_apps.metallophone.tuning.bending import bending_modes
from restshape_apps.metallophone.tuning.bounds import LEAST, bounded
from restshape_apps.metallophone.tuning.cost import tuning_cost
from restshape_apps.metallophone.tuning.descent import CENTS, Descent
from restshape_apps.metallophone.tuning.followed_modes import followed
from restshape_apps.metallophone.tuning.freedoms import Freedom, freedoms_of, with_fixed_curves
from restshape_apps.metallophone.tuning.motions import motions_of
from restshape_apps.metallophone.tuning.report import TuningReport
from restshape_apps.metallophone.tuning.smallest_change import smallest_change
from restshape_apps.metallophone.tuning.tone_rates import tone_rates
from restshape_apps.metallophone.tuning.tuning import tuned
from restshape_apps.metallophone.tuning.wanted import Wanted, wanted_tones
from restshape_verification.metallophone.tines import kalimba

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.scene.load import load_scene

SCENES, TEMPLATE = application.folder / "scenes", application.folder / "template"
PLATE = ["effects.modal.model=plate", 'mesh.size="9 mm"']
UNDERCUT = TEMPLATE / "undercut" / "scene.toml"
THICKNESS = "material.aluminium.thickness"
LENGTH = ["shape.vertices.b.0", "shape.vertices.c.0"]


def bar(name: str, *overrides: str):
    return load_scene(SCENES / f"{name}.toml", [*PLATE, *overrides])


def hertz(*frequencies: float) -> Wanted:
    return Wanted(f"{frequencies[0]} Hz", tuple(f / frequencies[0] for f in frequencies), frequencies)


def settings(*overrides: str) -> list[str]:
    return [word for one in (*PLATE, *overrides) for word in ("--set", one)]


# --- the command ------------------------------------------------------------------------------------------------------


def test_the_tuned_scene_has_the_tone_when_it_is_replayed_and_keeps_its_comments_and_units(tmp_path, capsys):
    scene, out, found = TEMPLATE / "scene.toml", tmp_path / "tuned.toml", tmp_path / "tuned.json"
    assert main(["tune", str(scene), "--to", "F5", "--out", str(out), "--json", str(found)]) == 0
    assert "in tune with F5 (698.46 Hz)" in capsys.readouterr().out
    report = json.loads(found.read_text())
    assert report["in_tune"] and report["solves"] <= 12 and len(report["freedoms"]) == 8
    (frequency,) = report["frequencies"]
    replayed = first_frame(out).analysis.frequencies[0]
    assert replayed == pytest.approx(frequency, rel=1e-6)
    assert abs(1200.0 * np.log2(replayed / (440.0 * 2.0 ** (8 / 12)))) < 0.5
    text = out.read_text()
    assert "# The outline: named edges" in text and ' mm", ' in text


def test_splines_are_written_with_their_knots_so_that_the_file_is_what_was_solved(tmp_path, capsys):
    out, found = tmp_path / "tuned.toml", tmp_path / "tuned.json"
    words = settings('mesh.size="12 mm"', "mesh.order=1", "effects.modal.modes=2")
    assert main(["tune", str(SCENES / "fish.toml"), "--to", "D5", *words, "--out", str(out), "--json", str(found)]) == 0
    assert out.read_text().count("knots = [") == 2
    frequency = json.loads(found.read_text())["frequencies"][0]
    # The mesh of the file is a new one, whose frequencies are off by 15 cents: 1 cent is 6e-4.
    assert first_frame(out).analysis.frequencies[0] == pytest.approx(frequency, rel=1e-5)
    capsys.readouterr()


BAD = {
    "--to H5": "no tone is named 'H5'",
    "--to C7 --overtones 1:0.5": "a ratio is below 1",
    "--to C7 --overtones 2:3": "do not begin with 1",
    "--to C7 --overtones 1:x": "these are no ratios",
    "--to C7 --modes 0": "these are no ranks of modes",
    "--to C7 --overtones 1:3 --modes 1": "1 modes for 2 tones",
    "--to C7 --by fork": "there is no freedom 'fork'",
    f"--to C7 --by {THICKNESS} --by {THICKNESS}": "is named twice",
    "--to C7 --by material.aluminium.E": "no tool changes it",
    "--to C7 --by parameters.idle": "changes neither the outline nor the thickness",
    f"--to C7 --by a --by {THICKNESS} --bound {THICKNESS}=5:1": "the bounds cross",
    f"--to C7 --by {THICKNESS} --bound {THICKNESS}=5:6": "which lies beyond its bounds",
    "--to C7 --by a --bound c=0:1": "'c' is no freedom of this tuning",
    "--to C7 --by c --bound c=0.05:0.2": "bind one alone: --bound shape.vertices.c.0=",
    "--to C7 --by a --bound a=1": "this is no bound",
    "--to C7 --by a --bound a.x=0:1": "there is no freedom 'a.x'",
    "--to C7 --measured 500": "add --rasp",
}


@pytest.mark.parametrize("words", BAD)
def test_what_makes_no_sense_is_refused_in_words(words, tmp_path, capsys):
    scene = tmp_path / "bar.toml"
    text = (SCENES / "bar_100.toml").read_text()
    scene.write_text(text.replace("[shape]", "[parameters]\nidle = 1\n\n[shape]", 1))
    assert main(["tune", str(scene), *words.split(), *settings("effects.modal.modes=1")]) == 2
    assert BAD[words] in capsys.readouterr().err


def test_scenes_of_others_and_recordings_are_refused(tmp_path, capsys):
    other = Path(application.folder).parent / "solid" / "template" / "scene.toml"
    assert main(["tune", str(other), "--to", "C5"]) == 2
    assert "the scene is one of 'solid'" in capsys.readouterr().err
    assert main(["tune", str(tmp_path / "bar.vtkhdf"), "--to", "C5"]) == 2
    assert "name the scene that it was made from" in capsys.readouterr().err


def test_what_tuning_costs_is_measured_for_explain():
    ((what, cost, why),) = tuning_cost(load_scene(TEMPLATE / "scene.toml"))
    assert what == "restshape tune" and "8 freedoms" in cost and "12 solves" in why


# --- the smallest change ----------------------------------------------------------------------------------------------


def test_the_smallest_change_is_that_of_lagrange_where_no_bound_holds():
    random = np.random.default_rng(1)
    root, J, wanted = random.normal(size=(6, 6)), random.normal(size=(2, 6)), random.normal(size=2)
    metric, far = root.T @ root + np.eye(6), np.full(6, 1e3)
    found = smallest_change(metric, J, wanted, -far, far)
    exact = np.linalg.solve(metric, J.T @ np.linalg.solve(J @ np.linalg.solve(metric, J.T), wanted))
    assert found == pytest.approx(exact, abs=1e-6)


def test_bounds_are_kept_and_what_they_do_not_allow_is_missed_by_the_least():
    wanted, low, high = np.array([3.0]), np.array([-1.0, -1.0]), np.array([1.0, 5.0])
    assert smallest_change(np.eye(2), np.ones((1, 2)), wanted, low, high) == pytest.approx([1.0, 2.0], abs=1e-5)
    assert smallest_change(np.eye(2), np.ones((1, 2)), wanted, low, -low) == pytest.approx([1.0, 1.0], abs=1e-9)
    idle = smallest_change(np.eye(2), np.zeros((1, 2)), wanted, low, high)
    assert np.array_equal(idle, np.zeros(2))


HOLED = '[shape.holes]\ncord = { circle = { center = ["50 mm", "15 mm"], radius = "3 mm" } }\n'


@pytest.mark.parametrize("model", ["plate", pytest.param("solid", marks=pytest.mark.weekly)])
def test_derivatives_by_every_kind_of_freedom_are_those_of_solves(model, tmp_path):
    text = (SCENES / "bar_100.toml").read_text()
    text = text.replace("[material", HOLED + "[material").replace('"4 mm"', '"deep*(1 + x/100 mm)"')
    text = text.replace("[shape]", '[parameters]\ndeep = "3 mm"\n[shape]', 1)
    text = text.replace('top = { line = ["c", "d"] }', 'top = { spline = ["c", "d"], through = [["50 mm", "27 mm"]] }')
    path = tmp_path / "bar.toml"
    path.write_text(text)
    own = [f"effects.modal.model={model}", 'mesh.size="12 mm"', "solve.tolerance=1e-9", "effects.modal.modes=2"]
    own += ['mesh.size="20 mm"', "mesh.order=2", "mesh.layers=1"] if model == "solid" else []
    scene = with_fixed_curves(load_scene(path, own))
    words = ["shape.vertices.c.0", "shape.edges.top.through.0.1", "shape.holes.cord.circle.radius", "deep"]
    freedoms = freedoms_of(scene, words)
    made = Bar(scene, freedoms)
    descent = Descent(made, [1, 2], np.ones(2), np.full((len(freedoms), 2), np.nan), 99)
    J, values = CENTS * tone_rates(made, descent.modes, descent._motions), descent.values
    for k in range(len(freedoms)):
        step, found = 1e-4 * (0.1 if freedoms[k].name != "parameters.deep" else 0.003), []
        for sign in (1.0, -1.0):
            aside = values.copy()
            aside[k] += sign * step
            assert made.at(aside) and made.level < 2
            found.append(followed(made, descent.modes.ids, descent.modes.shapes).frequencies)
            assert made.at(values)
        differenced = CENTS * np.log(found[0] / found[1]) / (2.0 * step)
        assert J[:, k] == pytest.approx(differenced, rel=2e-3, abs=2e-5 * np.abs(J).max()), freedoms[k].name


@pytest.mark.parametrize("words", [[], [THICKNESS]])
def test_derivatives_by_directions_are_those_by_nodes(words):
    """Eight numbers of the outline, which go by nodes, and a thickness, which goes by its direction."""
    scene = with_fixed_curves(bar("bar_100", "effects.modal.modes=3"))
    made = Bar(scene, freedoms_of(scene, words))
    descent = Descent(made, [1, 2, 3], np.ones(3), np.full((len(made.freedoms), 2), np.nan), 99)
    velocities = tone_rates_module._velocities(made, descent._motions)
    every = velocities, np.arange(velocities.shape[2])
    one, other = (
        way(made, np.arange(3), *every) for way in (tone_rates_module._by_freedoms, tone_rates_module._by_nodes)
    )
    assert one == pytest.approx(other, rel=1e-9, abs=1e-9 * np.abs(one).max())
    values = made.analysis.state.modes.values[:3, None]
    assert tone_rates(made, descent.modes, descent._motions) == pytest.approx(0.5 * one / values, rel=1e-9, abs=1e-9)


# --- tuning -----------------------------------------------------------------------------------------------------------


def test_one_freedom_ends_at_the_same_number_from_another_start():
    ends = [
        tuned(bar("bar_100", f"{THICKNESS}={start}"), wanted_tones("B6", None, 440.0), [THICKNESS]).found
        for start in (0.0035, 0.005)
    ]
    assert all(found.in_tune and found.last.moved == 0.0 for found in ends)
    assert ends[0].last.values == pytest.approx(ends[1].last.values, rel=2e-4)


def test_three_ratios_of_an_undercut_bar_are_met_by_three_numbers():
    found = tuned(load_scene(UNDERCUT), wanted_tones("C4", "1:4:10", 440.0), ["middle", "between", "reach"])
    assert found.found.in_tune and found.solves <= 25
    assert found.found.last.frequencies == pytest.approx(261.6256 * np.array([1.0, 4.0, 10.0]), rel=3e-4)
    assert found.ranks == (1, 3, 5)


def test_a_bending_mode_stays_one_across_a_torsion():
    # Of 150 mm the second bending lies below the first torsion, of 141 mm above.
    found = tuned(bar("bar_150", "effects.modal.modes=5"), hertz(2930.0), LENGTH, ranks=[2])
    assert found.found.in_tune
    values = dict(found.changes())
    again = first_frame(
        SCENES / "bar_150.toml",
        [
            *PLATE,
            "effects.modal.modes=4",
            *(f'shape.vertices.{name}.0="{values["shape", "vertices", name, "0"]}"' for name in "bc"),
        ],
    ).analysis
    bending = bending_modes(again)
    assert again.frequencies[[1, 2]] == pytest.approx([2830.8, 2930.0], rel=3e-4)
    assert bending[:2] == [0, 2]


def test_of_a_pair_the_mean_is_tuned():
    scene = load_scene(SCENES / "square.toml", ["mesh.size=0.8"])
    found = tuned(scene, hertz(4.3), ["material.steel.thickness"], ranks=[4]).found
    assert found.in_tune and [len(group) for group in found.clusters] == [2]
    assert np.sqrt((found.clusters[0] ** 2).mean()) == pytest.approx(4.3, rel=3e-4)


def test_out_of_reach_is_the_nearest_and_the_bound_that_holds(tmp_path, capsys):
    words = ["--to", "C5", "--by", THICKNESS, "--json", str(tmp_path / "bar.json")]
    assert main(["tune", str(SCENES / "bar_100.toml"), *words, *settings("effects.modal.modes=1")]) == 1
    out = capsys.readouterr().out
    assert "the nearest to C5 (523.25 Hz) is 1050" in out and f"{THICKNESS} is at its lower bound" in out
    report = json.loads((tmp_path / "bar.json").read_text())
    assert not report["in_tune"] and report["freedoms"][THICKNESS]["bound"] == "lower"
    assert report["freedoms"][THICKNESS]["tuned"] == pytest.approx(0.002)


def test_parameters_keep_their_sign_where_no_bound_is_given():
    scene = bar("../template/undercut/scene")
    freedoms = [Freedom(("parameters", name), scene.parameters[name]) for name in ("reach", "middle")]
    start = np.array([freedom.start for freedom in freedoms])
    undercut = Bar(scene, freedoms)
    far = replace(motions_of(undercut, start), reach=np.full(2, 1e-9), thinning=np.zeros(2))
    free = np.full((2, 2), np.nan)
    assert bounded(undercut, far, start, free)[0] == pytest.approx(LEAST * start)
    given = np.array([[-1.0, 1.0], [np.nan, np.nan]])
    assert bounded(undercut, far, start, given)[0] == pytest.approx([-1.0, LEAST * start[1]])
    undercut.freedoms = tuple(replace(freedom, start=-freedom.start) for freedom in freedoms)
    assert bounded(undercut, far, -start, free)[1] == pytest.approx(-LEAST * start)


def test_points_by_formulas_alone_lead_to_the_parameters(tmp_path):
    raw = (SCENES / "bar_100.toml").read_text().replace("[shape]", "[parameters]\nL = 0.1\n\n[shape]", 1)
    points = re.sub(r"^([a-d]) = .*$", r'\1 = ["L", "L"]', raw, flags=re.M)
    path = tmp_path / "bar.toml"
    path.write_text(points)
    scene = load_scene(path)
    with pytest.raises(UserError, match="given by formulas") as refused:
        freedoms_of(scene, [])
    assert "--by L --by material.aluminium.thickness" in str(refused.value.do)


def test_a_bound_that_is_met_at_once_leaves_the_bar_as_it_is():
    found = tuned(bar("bar_100"), wanted_tones("C8", None, 440.0), [THICKNESS], [f"{THICKNESS}=1 mm:4 mm"])
    assert not found.found.in_tune and found.solves == 1 and found.found.at_bounds() == [(0, "upper")]


def test_ratios_out_of_reach_trade_no_bending_mode_for_a_torsion(tmp_path):
    """The second torsion of the bar could be brought to 1 : 3, which no rectangle does to bending."""
    raw = (SCENES / "bar_100.toml").read_text().replace("[shape]", "[parameters]\nL = 0.1\nW = 0.03\n\n[shape]", 1)
    for corner, place in {"b": '["L", 0]', "c": '["L", "W"]', "d": '[0, "W"]'}.items():
        raw = re.sub(rf"^{corner} = .*$", f"{corner} = {place}", raw, flags=re.M)
    (tmp_path / "bar.toml").write_text(raw)
    found = tuned(load_scene(tmp_path / "bar.toml", [*PLATE]), wanted_tones("B6", "1:3", 440.0), ["L", "W"])
    assert not found.found.in_tune and found.ranks == (1, 3)
    assert found.found.last.frequencies[1] / found.found.last.frequencies[0] == pytest.approx(2.75, rel=0.02)
    # What misses is shared by both, which is the least sum of squares.
    first, second = found.found.last.cents
    assert first == pytest.approx(-second, rel=0.25) and found.tolerances.modes == (1, 3)


def test_two_octaves_away_the_nearest_is_found_in_few_solves():
    found = tuned(bar("bar_100", "effects.modal.modes=1"), wanted_tones("C9", None, 440.0))
    assert not found.found.in_tune and found.solves <= 5
    low, high, values = found.found.low, found.found.high, found.found.last.values
    assert values[[0, 2, 4, 6]] == pytest.approx([high[0], low[2], low[4], high[6]])


def test_what_leads_where_the_outline_meets_itself_stops_and_the_rest_goes_on():
    """One end would collapse after 4 solves, far from the tone."""
    found = tuned(load_scene(SCENES / "slender.toml"), wanted_tones("C4", None, 440.0))
    assert found.found.last.worst < 15.0
    found.found.blocked = "edge right would collapse"
    said = TuningReport(found, 440.0).summary()
    assert not found.found.in_tune and "edge right would collapse" in said and said.startswith("gave up on C4")


HOLED_BAR = """format = "restshape-scene"
version = 1
app = "metallophone"
[shape]
outline = ["bottom", "right", "top", "left"]
[shape.vertices]
a = [0, 0]
b = ["150 mm", 0]
c = ["150 mm", "30 mm"]
d = [0, "30 mm"]
[shape.edges]
bottom = { line = ["a", "b"] }
right = { arc = ["b", "c"], bulge = 0.4 }
top = { polyline = ["c", "d"], through = [["100 mm", "28 mm"], ["50 mm", "28 mm"]] }
left = { arc = ["d", "a"], bulge = 0.4 }
[shape.holes]
cord = { circle = { center = ["35 mm", "15 mm"], radius = "2 mm" } }
[material.brass]
name = "brass"
thickness = "4 mm"
[effects.modal]
model = "plate"
modes = 4
[mesh]
size = "8 mm"
"""


def holed_bar(folder, *overrides):
    path = folder / "holed.toml"
    path.write_text(HOLED_BAR)
    return load_scene(path, overrides)


def test_modes_are_found_again_after_trials_on_other_meshes(tmp_path):
    """The first trials have no shape, then another mesh, on which the mode is too unlike to be followed."""
    found = tuned(holed_bar(tmp_path), wanted_tones("A5", None, 440.0), ["b", "c"], ["b.0=140mm:160mm"])
    assert found.found.in_tune and found.solves <= 12 and found.tolerances.modes == (1,)


def test_a_polyline_and_a_hole_are_freedoms_together_and_a_radius_stays_above_0(tmp_path):
    coarse = holed_bar(tmp_path, 'mesh.size="12 mm"', "effects.modal.modes=1")
    assert tuned(coarse, wanted_tones("D#5", None, 440.0), ["top", "cord"]).found.in_tune
    radius = tuned(coarse, wanted_tones("D#5", None, 440.0), ["cord.circle.radius"]).found
    assert radius.at_bounds() == [(0, "lower")] and 0.0 < radius.last.values[0] < 0.001


def test_by_one_tine_of_a_fork_that_tine_is_tuned_and_the_other_stays(tmp_path):
    scene = load_scene(kalimba(tmp_path, [0.03, 0.03], gap=0.006, root=0.002))
    found = tuned(scene, wanted_tones("C6", None, 440.0), ["p7.1", "p8.1"])
    assert found.found.in_tune and found.tolerances.modes == (2,)
    (other,) = found.below
    assert other == pytest.approx(found.found.steps[0].frequencies[0], rel=2e-3)
    assert any("below the tuned tone now" in note for note in TuningReport(found, 440.0).notes())


def test_a_bar_that_is_in_tune_stays_as_it_is(tmp_path, capsys):
    scene, out = application.folder / "scenes" / "c5.toml", tmp_path / "c5.toml"
    assert main(["tune", str(scene), "--to", "C5", "--by", "parameters.length", "--out", str(out)]) == 0
    assert "after 1 solve;" in capsys.readouterr().out
    assert load_scene(out).parameters == load_scene(scene).parameters


def test_several_ranks_are_refused(monkeypatch, capsys):
    monkeypatch.setenv("PMI_RANK", "0")
    scene = application.folder / "scenes" / "c5.toml"
    for words in (["tune", str(scene), "--to", "C5"], ["modes", str(scene)], ["instrument", str(scene)]):
        assert main(words) == 2
        assert "on one rank" in capsys.readouterr().err

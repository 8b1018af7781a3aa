"""Quantities of furniture, against what is found by hand: a nail cantilever, and a bench on two legs alike."""

import csv
import json

import numpy as np
import pytest
from furniture_scenes import BENCH, write_bench, write_edits
from restshape_apps.furniture.physics.fasteners import wood
from restshape_apps.furniture.physics.plank_quantities import require_places
from restshape_apps.furniture.pieces import SCENES
from restshape_apps.furniture.shape.plank_scene import piece_of
from small_scenes import make_replay, rows_of

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.scene.load import load_scene

G = 9.80665
CANTILEVER = (SCENES / "cantilever.toml").read_text() + "\n[effects.bending]\n"


def observed(folder, text, *events):
    """The rows of a scene's text, and of a script of events."""
    path = folder / "scene.toml"
    path.write_text(text)
    return rows_of(make_replay(path, write_edits(folder, *events), "auto"))


def test_a_cantilever_has_the_use_and_the_sag_of_a_beam(tmp_path):
    quantities = """
[quantities]
pull = { utilisation = "pull", at = "beam -x" }
shear = { utilisation = "shear", at = "beam -x" }
most = { utilisation = "largest", at = "beam" }
sag = { deflection = true, at = "beam" }
up = { reaction = "z" }
aside = { reaction = "x", at = "foot -z" }
mass = { mass = true }
beam = { mass = true, at = "beam" }
"""
    row = observed(tmp_path, CANTILEVER + quantities)[0]
    material, arm, deep, thick = wood("mdf"), 0.19, 0.06, 0.012
    beam = material.density * arm * deep * thick
    # Three nails, 20 mm of each in the wood at 5.2 kN/m, on a lever of half the thickness; 190 N of shear a nail.
    moment = G * (0.5 * arm + beam * arm / 2)
    assert row["q_pull"] == pytest.approx(moment / (3 * 5200 * 0.02 * thick / 2), rel=1e-3)
    assert row["q_shear"] == pytest.approx(G * (0.5 + beam) / (3 * 190), rel=1e-3)
    assert row["q_most"] == row["q_pull"] > row["q_shear"]
    stiff = material.E * deep * thick**3 / 12
    end = G * (0.5 * arm**3 / 3 + beam * arm**3 / 8) / stiff
    assert row["q_sag"] == pytest.approx(end, rel=2e-3)
    post, foot = (material.density * 0.2 * thick * length for length in (0.3 - thick, 0.6))
    assert row["q_mass"] == pytest.approx(beam + post + foot, rel=1e-9) and row["q_beam"] == pytest.approx(beam)
    assert row["q_up"] == pytest.approx(G * (0.5 + row["q_mass"]), rel=1e-9)
    assert row["q_aside"] == pytest.approx(0.0, abs=1e-9 * row["q_up"])


def test_a_bench_that_stands_alike_on_both_legs(tmp_path):
    quantities = """
[quantities]
both = { reaction = "z" }
left = { reaction = "z", at = "left" }
foot = { reaction = "z", at = "right -x" }
least = { reaction = "z", reduce = "min" }
margin = { stability_margin = true, at_least = 0.14, limit = 0.16 }
leg = { length = "x", at = "left" }
thick = { length = "z", at = "top" }
wide = { length = "y", reduce = "mean" }
"""
    row = observed(
        tmp_path, "".join(['format = "restshape-scene"\nversion = 1\napp = "furniture"\n', BENCH, quantities])
    )[0]
    weight = 10 * (20 + wood("pine").density * 0.3 * 0.02 * (1.2 + 2 * 0.5))
    assert row["q_both"] == pytest.approx(weight, rel=1e-9)
    assert [row[f"q_{name}"] for name in ("left", "foot", "least")] == pytest.approx([weight / 2] * 3, rel=1e-6)
    # It tips first over the ends of its feet, half a width from the middle; in parts of the way between their corners.
    assert row["q_margin"] == pytest.approx(0.15 / np.hypot(1.02, 0.3), rel=1e-6)
    assert [row[f"q_{name}"] for name in ("leg", "thick", "wide")] == pytest.approx([0.5, 0.02, 0.3], rel=1e-9)
    assert row["constraint_status"] == "holds"


def test_a_limit_makes_a_piece_that_stands_fail(tmp_path):
    text = '[quantities]\nleg = { length = "x", at = "left", limit = "45 cm" }\n'
    text += 'load = { utilisation = "largest", limit = 9 }\n'
    scene = write_bench(tmp_path, BENCH + text)
    row = rows_of(make_replay(scene, write_edits(tmp_path), "auto"))[0]
    assert (row["constraint_status"], row["violated_constraints"], row["flaws"]) == (
        "fails",
        "leg is 500 mm, at most 450 mm",
        0,
    )
    tipped = write_edits(tmp_path, {"do": "press", "on": "left", "parameter": "move z"}, {"do": "drag", "by": -0.7})
    row = rows_of(make_replay(scene, tipped, "auto"))[-1]
    assert (
        row["constraint_status"] == "fails"
        and row["violated_constraints"].startswith("falls")
        and row["violated_constraints"].endswith("; leg is 500 mm, at most 450 mm")
    )


@pytest.mark.slow
def test_quantities_follow_edits_into_tables_and_stay_with_what_is_there(tmp_path):
    text = '[quantities]\nleg = { reaction = "z", at = "left" }\nlong = { length = "x", at = "top" }\n'
    text += "wood = { mass = true }\n"
    scene, out = write_bench(tmp_path, BENCH + text), tmp_path / "run.vtkhdf"
    edits = write_edits(
        tmp_path, {"do": "scale", "on": "top", "factor": 1.1, "along": "x"}, {"do": "delete", "on": "left"}
    )
    files = ["--csv", str(tmp_path / "run.csv"), "--json", str(tmp_path / "run.json"), "--out", str(out)]
    assert main(["replay", str(scene), "--edits", str(edits), *files]) == 0
    with (tmp_path / "run.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["q_long"]) for row in rows] == pytest.approx([1.2, 1.32, 1.32])
    reported = json.loads((tmp_path / "run.json").read_text())["quantities"]
    # What is gone has no number.
    assert reported["leg"][2] is None and reported["leg"][0] > 100.0 and rows[2]["q_leg"] == ""
    plank = wood("pine").density * 0.5 * 0.3 * 0.02
    assert reported["wood"][1] - reported["wood"][2] == pytest.approx(plank, rel=1e-9)
    assert main(["report", str(out), "--animation", "none", "--json", str(tmp_path / "report.json")]) == 0
    units = {row["quantity"]: row["unit"] for row in json.loads((tmp_path / "report.json").read_text())["quantities"]}
    assert units == {"leg": "N", "long": "m", "wood": "kg"}


WRONG = [
    ('a = { stress = "xx" }', "quantities.a.stress (line", "use one of: reaction, utilisation"),
    ("a = { deflection = true }", "quantities.a.deflection (line", "add [effects.bending]"),
    ('a = { utilisation = "pull", at = "lefft" }', "quantities.a.at (line", "did you mean 'left'"),
    ('a = { utilisation = "pull", at = "left up" }', "quantities.a.at (line", "no end 'up'"),
    ('a = { mass = true, at = "left +x" }', "quantities.a.at (line", "whole plank"),
    ('a = { stability_margin = true, at = "left" }', "quantities.a.at (line", "whole piece"),
]


@pytest.mark.parametrize(("line", "place", "do"), WRONG)
def test_what_has_no_meaning_is_refused(tmp_path, line, place, do):
    with pytest.raises(UserError) as caught:
        load_scene(write_bench(tmp_path, f"{BENCH}[quantities]\n{line}\n"))
    assert place in str(caught.value) and do in str(caught.value)


@pytest.mark.parametrize("line", ['a = { utilisation = "pull", at = "left -x" }', 'a = { reaction = "z", at = "top" }'])
def test_a_joint_or_foot_that_is_not_there_is_reported(tmp_path, line, capsys):
    assert main(["replay", str(write_bench(tmp_path, f"{BENCH}[quantities]\n{line}\n"))]) == 2
    reported = capsys.readouterr().err
    assert "quantities.a.at (line" in reported and ("left +x" in reported if "use" in line else "left -x" in reported)


@pytest.mark.parametrize(
    ("start", "at", "far"),
    [
        # From the face of the left leg, 20 mm thick around x = -0.5, whose end is at y = 0.15.
        ([-0.4, 0, 0.2], "shelf -x", "; shelf -x is 90 mm from left, beyond the reach of 15 mm of joints"),
        ([-0.4, 0.0, 0.2], "shelf", "; shelf -x is 90 mm from left, beyond the reach of 15 mm of joints"),
        ([-0.49, 0.27, 0.2], "shelf", "; shelf -x is 70 mm from left, beyond the reach of 15 mm of joints"),
        ([-0.485, 0.0, 0.2], "shelf +x", "; shelf +x is 290 mm from right, beyond the reach of 15 mm of joints"),
    ],
)
def test_a_joint_that_is_not_there_for_want_of_reach_reports_the_gap(tmp_path, start, at, far):
    end = [0.2, start[1], 0.2]
    plank = f"[planks.shelf]\nfrom = {start}\nto = {end}\nwidth = [0, 0.1, 0]\n"
    scene = load_scene(
        write_bench(tmp_path, f'{BENCH}{plank}[quantities]\na = {{ utilisation = "pull", at = "{at}" }}\n')
    )
    with pytest.raises(UserError) as caught:
        require_places(scene.quantities, piece_of(scene))
    assert caught.value.do.startswith("there are: left +x, right +x") and caught.value.do.endswith(far)


def test_other_applications_have_no_quantities_of_planks(tmp_path, capsys):
    plate = SCENES.parent.parent / "solid" / "scenes" / "plate.toml"
    words = ["check", str(plate), "--set", "quantities={ a = { mass = true } }"]
    assert main(words) == 2
    assert "has no quantity of the kind" in capsys.readouterr().err


def test_old_kinds_are_read_as_those_of_today(tmp_path):
    old = """
[quantities]
most = { use = "largest", at = "beam" }
low = { sag = true, at = "beam" }
firm = { margin = true, at_least = 0.1 }
"""
    path = tmp_path / "scene.toml"
    path.write_text(CANTILEVER + old)
    quantities = load_scene(path).quantities
    assert [one.kind for one in quantities.values()] == ["utilisation", "deflection", "stability_margin"]
    assert quantities["firm"].min == 0.1

"""Loads, limits and gravity far off what is meant, in a scene and where a script sets them; bodies without load."""

import pytest
from small_scenes import block, head, write_scene, write_script

BODY = block(0.12, 0.1) + (
    "[material.m]\nE = 2e11\nnu = 0.3\nrho = 7850\nthickness = 0.005\n"
    '[supports.left]\non = "left"\nfix = { x = 0, y = 0 }\n'
)
PULL = '[loads.w]\non = "right"\nforce = [0, -500]\n'
SAG = '[quantities.sag]\ndisplacement = "y"\nat = "right"\nmax = 0.01\n'
MESH = "[mesh]\nsize = 0.05\n"


def warnings_of(run):
    # 1 where a script's event is refused, as that of a limit is.
    assert run.returncode in (0, 1), run.stderr
    return [line for line in (run.stdout + run.stderr).splitlines() if line.startswith("warning")]


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("material.m.E", 210, "material.m: a stiffness of 210 Pa"),
        ("material.m.rho", 7.85, "material.m: with this stiffness and density sound goes at"),
        ("material.m.thickness", 5, "material.m: the thickness of 5 m is more than the 0.12 m"),
        ("loads.w.force", [0, -5e9], "loads: they give 8.33 TPa over the whole shape"),
        ("quantities.sag.max", 1, "quantities.sag.max: a limit without a unit is in metres, and 1 m is more than"),
        ("effects.gravity.g", [0, -9810], "effects.gravity.g: 9810 m/s^2 is 1e+03 times"),
    ],
)
def test_values_of_scenes_and_of_scripts(tmp_path, command, key, value, words):
    scene = write_scene(tmp_path, head("solid") + BODY + PULL + SAG + MESH + "[effects.gravity]\ng = [0, -9.81]\n")
    assert warnings_of(command("check", scene)) == []
    assert any(words in line for line in warnings_of(command("check", scene, "--set", f"{key}={value}")))
    same = [{"t": 0.1 * k, "do": "set", "key": key, "value": value} for k in (1, 2)]
    found = warnings_of(command("check", scene, write_script(tmp_path, same)))
    assert sum(words in line for line in found) == 1 and all(one.startswith("warning: line 2: set ") for one in found)


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("loads.w.force.0", "set loads.w.force.0 sets parameters.p and, with it, loads.v.force.0; "),
        ("parameters.p", ""),
        ("loads.w.force.1", ""),
        ("loads.u.force.0", ""),
    ],
)
def test_a_number_of_a_parameter_that_gives_others_is_warned_of_where_it_is_set(tmp_path, command, key, words):
    loads = "".join(f'[loads.{name}]\non = "right"\nforce = ["{given}", 1]\n' for name, given in zip("wvu", "ppq"))
    scene = write_scene(tmp_path, head("solid") + "[parameters]\np = 5\nq = 7\n" + BODY + loads + MESH)
    script = write_script(tmp_path, [{"do": "set", "key": key, "value": 9}])
    found = warnings_of(command("check", scene, script))
    assert len(found) == bool(words) and all(words in line for line in found)


def test_a_refused_set_of_a_formula_is_one_refused_frame(tmp_path, command):
    loads = '[loads.w]\non = "right"\nforce = ["p+q", 1]\n'
    scene = write_scene(tmp_path, head("solid") + "[parameters]\np = 5\nq = 7\n" + BODY + loads + MESH)
    script = write_script(tmp_path, [{"do": "set", "key": "loads.w.force.0", "value": 9}, {"do": "idle"}])
    found, played = command("check", scene, script), command("replay", scene, script)
    why = "loads.w.force.0 is given by the formula 'p+q'"
    assert found.returncode == 1 and why in found.stdout and "refused edits" in found.stdout, (
        found.stdout + found.stderr
    )
    assert played.returncode == 0 and why in played.stdout + played.stderr, played.stderr


@pytest.mark.parametrize(
    ("more", "says"),
    [("", True), (PULL, False), ("[effects.gravity]\n", False), ("[effects.large_deformation]\n", True)],
)
def test_a_body_that_nothing_loads(tmp_path, command, more, says):
    scene = write_scene(tmp_path, head("solid") + BODY + MESH + more)
    assert sum("all answers are 0" in line for line in warnings_of(command("check", scene))) == says
    assert command("replay", scene).stderr.count("all answers are 0") == says


@pytest.mark.parametrize(
    ("more", "says"),
    [("", True), (PULL, False), ("[effects.ground]\nfrequency = 1\nacceleration = 1\n", False)],
)
def test_a_body_that_nothing_sets_in_motion(tmp_path, command, more, says):
    scene = write_scene(tmp_path, head("vibration") + BODY + MESH + "[effects.dynamics]\n" + more)
    assert any("nothing moves until an edit does" in line for line in warnings_of(command("check", scene))) == says


def test_a_body_whose_support_moves_is_loaded(tmp_path, command):
    scene = write_scene(tmp_path, head("solid") + BODY.replace("y = 0 }", "y = 0.001 }") + MESH)
    assert warnings_of(command("check", scene)) == []


def test_gravity_without_density_is_refused_as_by_replay(tmp_path, command):
    bare = BODY.replace("rho = 7850\n", "")
    scene = write_scene(tmp_path, head("solid") + bare + PULL + MESH + "[effects.gravity]\n")
    checked, replayed = command("check", scene), command("replay", scene)
    assert checked.returncode == replayed.returncode == 2
    assert "the material has no density" in checked.stderr
    assert checked.stderr.replace("restshape check", "restshape replay") == replayed.stderr

"""What is wrong in scenes of heat: `check` refuses it as `replay` does, with place and remedy."""

import math

import pytest
from restshape_studies.stability.scenery import make_replay, rows_of, write_scene, write_script
from thermal_scenes import COOLING, HEAD, SQUARE

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.scene.load import load_scene

BODY = HEAD + SQUARE + "[material.m]\nconductivity = 2\n[mesh]\nsize = 0.5\n"
FIXED = '[supports.w]\non = "left"\nfix = { temperature = 300 }\n'
SOURCE = '[loads.s]\non = "all"\nsource = 1000\n'
AIR = '[loads.air]\non = "right"\nconvection = { film = 5, ambient = 300 }\n'
BALANCED = '[loads.l]\non = "left"\nflux = 100\n[loads.r]\non = "right"\nflux = -100\n'


def refused_twice(folder, capsys, text) -> list[str]:
    """What `check` and `replay` say of a scene that both refuse."""
    scene, said = write_scene(folder, text), []
    for words in (["check", str(scene)], ["replay", str(scene)]):
        assert main(words) == 2
        said.append(capsys.readouterr().err.removeprefix(f"restshape {words[0]}: "))
    assert said[0] == said[1]
    return said


@pytest.mark.parametrize(
    ("text", "place"),
    [
        (BODY, "scene.toml: supports"),
        (BODY + SOURCE, "scene.toml: supports"),
        (BODY + BALANCED, "scene.toml: supports"),
        (BODY + AIR.replace("film = 5", "film = 0"), "scene.toml: supports"),
    ],
)
def test_a_steady_temperature_that_nothing_holds(tmp_path, capsys, text, place):
    said = refused_twice(tmp_path, capsys, text)[0]
    assert place in said and "nothing holds the temperature" in said and "fix = { temperature" in said


@pytest.mark.parametrize("text", [BODY + FIXED, BODY + AIR, BODY + SOURCE + AIR])
def test_one_that_something_holds(tmp_path, capsys, text):
    assert main(["check", str(write_scene(tmp_path, text))]) == 0


def test_nothing_need_hold_a_temperature_in_time(tmp_path, capsys):
    text = COOLING[: COOLING.index("[supports.walls]")] + COOLING[COOLING.index("[effects.storage]") :]
    assert main(["check", str(write_scene(tmp_path, text))]) == 0


def test_an_edit_that_takes_the_last_hold_away_is_refused(tmp_path, capsys):
    scene = write_scene(tmp_path, BODY + AIR)
    script = write_script(tmp_path, [{"t": 0.1, "do": "set", "key": "loads.air.convection.film", "value": 0}])
    assert main(["check", str(scene), str(script)]) == 1
    assert "nothing holds the temperature" in capsys.readouterr().out


@pytest.mark.parametrize("film", ['"-1 W/(m^2 K)"', '"5 - S*3"', '"5*(y - 0.6)"'])
def test_a_film_below_nothing_is_refused(tmp_path, capsys, film):
    scene = write_scene(tmp_path, BODY + AIR.replace("film = 5", f"film = {film}") + "[parameters]\nS = 2\n")
    for command in ("check", "replay"):
        assert main([command, str(scene)]) == 2
        said = capsys.readouterr().err
        assert "loads.air.convection.film" in said and "a film coefficient of -" in said and "is below 0" in said
        assert "is a film coefficient" not in said


def test_a_film_by_place_holds_the_temperature(tmp_path):
    # In one dimension the flux is k (400 - T) = film (T - 300), with k = 2 W/(m K) over 1 m.
    text = BODY + FIXED + AIR.replace("film = 5", 'film = "2*(1 + 0*y)"')
    text += '[quantities]\nT = { temperature = true, at = "right" }\n'
    (row,) = rows_of(make_replay(write_scene(tmp_path, text.replace("temperature = 300 }", "temperature = 400 }", 1))))
    assert row["q_T"] == pytest.approx(350.0, rel=1e-9)


def test_bodies_that_should_store_heat_and_cannot(tmp_path, capsys):
    said = refused_twice(tmp_path, capsys, COOLING.replace("specific_heat = 3\n", ""))[0]
    assert "material.m" in said and "without heat capacity" in said and "specific_heat" in said


@pytest.mark.parametrize(
    ("at", "place", "what"),
    [
        ("", "quantities.q", "a heat flow needs a place"),
        (', at = "a"', "quantities.q.at", "'a', which is a vertex"),
        (', at = "all"', "quantities.q.at", "'all', which is the whole shape"),
    ],
)
def test_a_heat_flow_has_an_edge(tmp_path, capsys, at, place, what):
    said = refused_twice(tmp_path, capsys, BODY + FIXED + f"[quantities]\nq = {{ heat_flow = true{at} }}\n")[0]
    assert place in said and what in said and "an edge, a hole, a region, the outline or a group" in said


def test_no_heat_leaves_by_an_edge_inside(tmp_path, capsys):
    inside = BODY.replace("[shape]", "[shape]\nregions = { core = { polygon = [[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]] } }")
    assert inside != BODY
    text = inside + FIXED + '[quantities]\nq = { heat_flow = true, at = "core" }\n'
    said = refused_twice(tmp_path, capsys, text)
    assert all("quantities.q.at" in one and "nothing leaves the body at 'core'" in one for one in said)


def test_a_flux_on_the_whole_shape_says_what_it_needs(tmp_path):
    with pytest.raises(UserError) as caught:
        load_scene(write_scene(tmp_path, BODY + FIXED + '[loads.f]\non = "all"\nflux = 3\n'))
    assert "a flux cannot act on 'all', which is the whole shape" in caught.value.what
    assert "an edge, a hole, a region, the outline or a group" in caught.value.do
    with pytest.raises(UserError, match="a source cannot act on 'left', which is an edge"):
        load_scene(write_scene(tmp_path, BODY + FIXED + '[loads.f]\non = "left"\nsource = 3\n'))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("effects.storage.initial", "50 degC"),
        ("effects.storage", {"time_step": 0.5, "initial": "50 degC"}),
    ],
)
def test_what_matters_at_the_start_cannot_be_set_later(tmp_path, capsys, key, value):
    scene, event = write_scene(tmp_path, COOLING), {"do": "set", "key": key, "value": value}
    script = write_script(tmp_path, [{"do": "idle", "frames": 2}, event])
    assert main(["check", str(scene), str(script)]) == 1
    assert "effects.storage.initial matters at the start alone" in capsys.readouterr().out
    *_, before, after = rows_of(make_replay(scene, script))
    assert "effects.storage.initial matters" in after["refused"] and "--set" in after["refused"]
    assert not before["refused"]


@pytest.mark.parametrize(
    ("key", "value"), [("effects.storage.time_step", 0.25), ("effects.storage", {"time_step": 1, "initial": 0})]
)
def test_other_settings_of_an_effect_may_be_set(tmp_path, key, value):
    script = write_script(tmp_path, [{"do": "idle"}, {"do": "set", "key": key, "value": value}])
    assert not any(row["refused"] for row in rows_of(make_replay(write_scene(tmp_path, COOLING), script)))


def test_messages_on_heat_in_time_name_the_time_integration(tmp_path, capsys):
    scene = write_scene(tmp_path, COOLING)
    script = write_script(tmp_path, [{"do": "idle"}])
    head, *rest = script.read_text().splitlines()
    script.write_text("\n".join([head.replace("{", '{"analysis": "on demand", ', 1), *rest]) + "\n")
    said = []
    assert main(["check", str(scene), str(script)]) == 2
    said.append(capsys.readouterr().err)
    assert main(["replay", str(scene), "--edits", str(write_script(tmp_path, [])), "--predict", "linear"]) == 2
    said.append(capsys.readouterr().err)
    for text in said:
        assert "integrat" in text and "motion" not in text


@pytest.mark.parametrize(
    ("written", "shown"),
    [
        ("300 K + 10 K*x", "temperature = 300 K + 10 K*x on left\n"),
        ("20 degC + 5*x", "temperature = 20 degC + 5*x on left\n"),
        ("300 + 10*x", "temperature = (300 + 10*x) K on left\n"),
        ("20 degC", "temperature = 293.15 K on left\n"),
    ],
)
def test_check_shows_a_formula_with_one_unit(tmp_path, capsys, written, shown):
    text = BODY + FIXED.replace("300", f'"{written}"')
    assert main(["check", str(write_scene(tmp_path, text))]) == 0
    assert shown in "\n".join(line.rstrip(" |") for line in capsys.readouterr().out.splitlines()) + "\n"


def plate_of_two(first: float, second: float, loads: str = "") -> str:
    """A square whose left and top edges have a temperature each [K]."""
    sides = f'[supports.a]\non = "left"\nfix = {{ temperature = {first} }}\n'
    return BODY + sides + f'[supports.b]\non = "top"\nfix = {{ temperature = {second} }}\n' + loads


def test_edges_that_meet_with_two_temperatures_are_solved_and_warned_of(tmp_path, capsys):
    scene = write_scene(tmp_path, plate_of_two(300, 340) + "[quantities]\nmean = { temperature = true }\n")
    assert main(["check", str(scene)]) == 0
    assert "the temperature jumps by 40 K where" in capsys.readouterr().out
    # of a square with 340 K on one side, 300 K on the next and insulated others the mean is half of both by symmetry,
    # but for the corner, which has that of the support that comes first
    coarse, fine = (rows_of(make_replay(scene, overrides=[f"mesh.size={h}"]))[0]["q_mean"] for h in (0.25, 0.05))
    assert abs(fine - 320.0) < 0.3 * abs(coarse - 320.0) < 0.3


def test_one_edge_with_two_temperatures_is_refused(tmp_path, capsys):
    text = plate_of_two(300, 340).replace('on = "top"', 'on = "left"')
    assert main(["replay", str(write_scene(tmp_path, text))]) == 2
    assert "two supports prescribe different values" in capsys.readouterr().err


def test_loads_where_the_temperature_is_fixed_are_warned_of(tmp_path, capsys):
    assert main(["check", str(write_scene(tmp_path, plate_of_two(300, 300, AIR.replace("right", "top"))))]) == 0
    assert "loads.air changes no temperature at 'top', where a support fixes it" in capsys.readouterr().out
    assert main(["check", str(write_scene(tmp_path, plate_of_two(300, 300, AIR)))]) == 0
    assert "changes no temperature" not in capsys.readouterr().out


def test_where_no_heat_flows_what_the_solver_leaves_is_no_temperature_to_relate_errors_to(tmp_path):
    """Two layers whose outer side becomes insulated: all of it is as hot as the gas, to the tolerance."""
    text = BODY.replace("conductivity = 2\n", "conductivity = 1.1\n") + AIR.replace("right", "left").replace(
        "film = 5, ambient = 300", "film = 60, ambient = 1173.15"
    )
    text += '[material.outer]\nconductivity = 50\nregion = "outer"\n' + AIR.replace("loads.air", "loads.room")
    text += "[shape.regions.outer]\npolygon = [[0.5, 0.2], [0.9, 0.2], [0.9, 0.8], [0.5, 0.8]]\n"
    script = write_script(tmp_path, [{"t": 0.1, "do": "set", "key": "loads.room.convection.film", "value": 0}])
    first, last = rows_of(make_replay(write_scene(tmp_path, text), script))
    assert first["estimate"] > 0.0 and math.isnan(last["estimate"])

"""Tables, events and kinds of quantities that a physics adds to scenes: read, checked, reported."""

from dataclasses import replace
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Annotated, Literal

import pytest
from pydantic import Field

from restshape import application as installed
from restshape.application import Application, Editing
from restshape.cli.options import require_mesh
from restshape.cli.schema import scene_schema, script_schema
from restshape.errors import UserError
from restshape.scene import units as known_units
from restshape.scene.application_registry import clashes_with, refuse_clashes_of
from restshape.scene.edit_script import load_script
from restshape.scene.effect import Effect
from restshape.scene.event_line import EventLine
from restshape.scene.load import load_scene, revise
from restshape.scene.load_kind import LoadKind
from restshape.scene.physics import Physics, Section
from restshape.scene.quantity import QuantityKind
from restshape.scene.solver import DEFINITE, SolverPlan, System
from restshape.scene.values import Strict, number_of, value_of


class Rope(Strict):
    """A rope."""

    length: value_of("length")
    mass: Annotated[number_of("mass"), Field(gt=0)] = 1.0


class Air(Strict):
    """What it hangs in."""

    density: number_of("density") = 1.2


class Sag(EventLine):
    """A rope sags."""

    do: Literal["sag"]
    on: str
    by: number_of("length")


def solver(scene, on, settings) -> SolverPlan:
    """A plan of nothing."""
    return SolverPlan("linear", (System("ropes", DEFINITE, "cg", "", "they pull"),), "they pull")


ROPES = Physics(
    name="ropes",
    summary="what hangs",
    solver=solver,
    sections={"ropes": Section(Rope, "what hangs", named=True, required=True), "air": Section(Air, "around them")},
    events={"sag": Sag},
    quantities={"tension": QuantityKind(Literal[True], "force", "max")},
    effects={"weight": Effect(Air, "they are heavy", required=True), "wind": Effect(Air, "it blows")},
)
ROPE_EDITING = Editing(
    session="nowhere:nothing",
    replayed="nowhere:nothing",
    events="restshape.scene.edit_script:PLAIN_EVENTS",
    check="restshape.scene.checks:check_parameters",
    contents="nowhere:nothing",
)
HANGING = Application(
    name="hanging",
    summary="ropes",
    folder=Path(__file__).parent,
    analysis="",
    physics=(ROPES,),
    editing=ROPE_EDITING,
)
HEAD = 'format = "restshape-scene"\nversion = 1\napp = "hanging"\n'
ROPE = '[parameters]\nl = "50 cm"\n[ropes.a]\nlength = "2*l"\nmass = "300 g"\n'


def scene_of(folder: Path, text: str):
    path = folder / "ropes.toml"
    path.write_text(HEAD + text)
    return load_scene(path)


def test_tables_are_read_with_units_formulas_and_defaults(tmp_path, install):
    install(HANGING)
    scene = scene_of(tmp_path, ROPE + '[quantities]\npull = { tension = true, limit = "2 kN" }\n')
    ropes = scene.sections["ropes"]
    assert set(scene.sections) == {"ropes", "air"} and scene.sections["air"].density == 1.2
    assert ropes["a"].length.evaluate(0, 0, scene.parameters) == 1.0 and ropes["a"].mass == 0.3
    pull = scene.quantities["pull"]
    assert (pull.kind, pull.dimension, pull.reduce, pull.max) == ("tension", "force", "max", 2000.0)
    heavier = revise(scene, "ropes.a.mass", "1 kg")
    assert heavier.sections["ropes"]["a"].mass == 1.0 and heavier.quantities is scene.quantities


@pytest.mark.parametrize(
    ("text", "where", "what", "do"),
    [
        ("", "ropes", "'ropes' is missing", "add it"),
        ("[ropes.a]\nlenght = 1\n", "ropes.a.lenght (line 5)", "no key 'lenght'", "'length'"),
        ('[ropes.a]\nlength = "3 kg"\n', "ropes.a.length (line 5)", "a mass", "12 mm"),
        (ROPE.replace("50 cm", "50 kg"), "ropes.a.length (line 7)", "'2*l' is a mass", "12 mm"),
        (ROPE + "[rope.b]\nlength = 1\n", "rope", "no key 'rope'", "'ropes'"),
        (ROPE + '[quantities]\na = { tension = true, limit = "2 m" }\n', "quantities.a.max", "a force is wanted", ""),
        (ROPE + "[quantities]\na = { tensoin = true }\n", "quantities.a.tensoin", "no key", "'tension'"),
    ],
)
def test_what_is_wrong_in_them_is_reported_with_place_and_remedy(tmp_path, install, text, where, what, do):
    install(HANGING)
    with pytest.raises(UserError) as caught:
        scene_of(tmp_path, text)
    assert where in caught.value.where and what in caught.value.what and do in caught.value.do


def test_an_override_of_a_name_that_is_not_there_lists_those_that_are(tmp_path, install):
    install(HANGING)
    scene = scene_of(tmp_path, ROPE)
    with pytest.raises(UserError, match=r"there is no ropes\.b") as caught:
        revise(scene, "ropes.b.mass", 1.0)
    assert "'a'" in caught.value.do or "a" in caught.value.do.split()


def test_events_of_scripts_are_those_of_the_application(tmp_path, install):
    install(HANGING)
    scene, path = scene_of(tmp_path, ROPE), tmp_path / "edits.jsonl"
    header = '{"format": "restshape-edits", "version": 1}\n'
    path.write_text(header + '{"do": "sag", "t": 0, "on": "a", "by": "1 cm"}\n{"do": "undo", "t": 1}\n')
    sag, undo = load_script(path, scene).events
    assert isinstance(sag, Sag) and sag.by == 0.01 and undo.do == "undo"
    path.write_text(header + '{"do": "hole", "t": 0}\n')
    with pytest.raises(UserError, match="no event 'hole'"):
        load_script(path, scene)


def test_schemas_hold_what_is_added(install):
    install(HANGING)
    scene, script = scene_schema(), script_schema()
    assert {"ropes", "air"} <= set(scene["properties"]) and "ropes" not in scene["required"]
    assert scene["properties"]["ropes"]["description"] == "what hangs"
    assert "tension" in scene["$defs"]["Quantity"]["properties"] and "Sag" in script["$defs"]


def test_a_key_of_another_application_is_refused_by_its_name(tmp_path, install):
    install(HANGING, replace(HANGING, name="other", physics=(Physics("nothing", "nothing", solver),)))
    with pytest.raises(UserError, match="'other' has no table 'ropes'") as caught:
        path = tmp_path / "other.toml"
        path.write_text(HEAD.replace("hanging", "other") + ROPE)
        load_scene(path)
    assert 'app = "hanging"' in caught.value.do and "ropes" in caught.value.where


def test_two_meanings_of_one_key_are_refused_by_name():
    refuse_clashes_of(HANGING)
    for added, key in (
        ({"sections": {"air": Section(Rope, "another one")}}, "'air', and 'ropes' does too"),
        ({"sections": {"mesh": Section(Air, "a mesh")}}, "'mesh', and every scene has one"),
        ({"quantities": {"area": QuantityKind(Literal[True], "area", "sum")}}, "'area', and every"),
        ({"quantities": {"tension": QuantityKind(Literal[True], "stiffness", "max")}}, "'tension', and 'ropes' does"),
        ({"events": {"undo": Sag}}, "'undo', and its edit scripts have one"),
        ({"effects": {"weight": Effect(Air, "light")}}, "'weight', and 'ropes' does too"),
        ({"materials": {"hemp": {"give": 2.0}}}, "value of the material 'hemp.give', and 'heavy' does too"),
    ):
        heavy = Physics("heavy", "weights", solver, effects=HANGING.effects, materials={"hemp": {"give": 1.0}})
        two = replace(HANGING, name="two", physics=(ROPES, heavy, Physics("second", "another", solver, **added)))
        with pytest.raises(UserError) as caught:
            refuse_clashes_of(two)
        assert key in caught.value.what and "'second'" in caught.value.what


def test_a_key_with_two_units_names_both_physics_and_both_units():
    pull = {"loads": {"pull": LoadKind(number_of("force"), ("edge",), "a force")}}
    lift = {"loads": {"pull": LoadKind(number_of("pressure"), ("edge",), "a pressure")}}
    for first, second in (
        (pull, lift),
        ({"boundary": {"w": "force"}}, {"boundary": {"w": "pressure"}}),
        *[({"quantities": {"pull": QuantityKind(Literal[True], one, "max")}} for one in ("force", "pressure"))],
    ):
        with pytest.raises(UserError, match=r"force \[N\].* in 'added0'") as caught:
            refuse_clashes_of(hanging("hanging", first, second))
        assert "'added1' adds" in caught.value.what and "pressure [Pa] in 'added1'" in caught.value.what


def test_a_dimension_of_two_units_names_both_modules():
    units = {name: dict(getattr(known_units, name)) for name in ("DIMENSIONS", "EXAMPLES", "SYMBOLS", "DECLARED_IN")}
    one = "from restshape.scene.units import declare_dimension\ndeclare_dimension('flow', {!r}, '1')"
    try:
        exec(one.format("m^3/s"), {"__name__": "water"})
        with pytest.raises(UserError, match=r"'flow' is that of kg/s in air, and that of m\^3/s in water"):
            exec(one.format("kg/s"), {"__name__": "air"})
    finally:
        for name, before in units.items():
            table = getattr(known_units, name)
            table.clear()
            table.update(before)


def hanging(name: str, *added: dict) -> Application:
    """An application of ropes and of physics that add something; a list holds them, as well as a tuple would."""
    others = [Physics(f"added{i}", "another", solver, **one) for i, one in enumerate(added)]
    return replace(HANGING, name=name, physics=[ROPES, *others])


HEMP = {"materials": {"hemp": {"give": 1.0}}}
SOFT_HEMP = {"materials": {"hemp": {"give": 3.0}}}


@pytest.mark.parametrize("name", ["check", "replay"])
@pytest.mark.parametrize(
    ("added", "what"),
    [
        ((HEMP, SOFT_HEMP), "'added1' adds the value of the material 'hemp.give', and 'added0' does too"),
        (({"sections": {"mesh": Section(Air, "a mesh")}},), "'added0' adds the table 'mesh', and every scene has one"),
    ],
)
def test_a_command_reports_a_key_that_two_physics_of_the_scene_have(tmp_path, install, command, name, added, what):
    install(hanging("hanging", *added))
    path = tmp_path / "two.toml"
    path.write_text(HEAD + ROPE)
    done = command(name, path)
    assert done.returncode == 2 and what in done.stderr


PULLED = {"loads": {"pull": LoadKind(number_of("force"), ("edge",), "a force")}}
PRESSED = {"loads": {"pull": LoadKind(number_of("pressure"), ("edge",), "a pressure")}}


def test_applications_may_mean_different_things_by_a_key(tmp_path, install):
    mine = hanging("hanging", PULLED)
    other = replace(hanging("other"), physics=[ROPES, Physics("others", "another", solver, **PRESSED)])
    install(mine, other)
    path = tmp_path / "two.toml"
    path.write_text(HEAD + ROPE)
    assert load_scene(path).app == "hanging"
    (note,) = clashes_with(mine, [mine, other])
    assert note.startswith("the load of the kind 'pull' of 'added0' means another thing in 'others'")
    assert note.endswith("pressure [Pa] in 'others', force [N] in 'added0'")
    assert clashes_with(mine, [mine]) == []
    assert len(scene_schema()["$defs"]["Load"]["properties"]["pull"]["anyOf"]) >= 2


class Wind(Strict):
    """What blows."""

    speed: value_of("length")


@pytest.mark.parametrize(("speed", "what"), [("sin(z)", "'z'"), ("2 kg + 0*y", "kg"), ("2*l + x", None)])
def test_formulas_in_effects_are_checked(tmp_path, install, speed, what):
    blown = replace(ROPES, effects={**ROPES.effects, "blow": Effect(Wind, "wind")})
    install(replace(HANGING, physics=[blown]))
    path = tmp_path / "wind.toml"
    path.write_text(HEAD + ROPE + f'[effects.blow]\nspeed = "{speed}"\n')
    if what is None:
        assert load_scene(path).effects["blow"]
        return
    with pytest.raises(UserError) as caught:
        load_scene(path)
    assert "effects.blow.speed" in caught.value.where and what in caught.value.what


def test_a_schema_is_not_written_of_an_application_whose_physics_clash(install, command):
    install(HANGING, hanging("clashing", HEMP, SOFT_HEMP))
    done = command("schema", "scene")
    assert done.returncode == 2 and "'hemp.give', and 'added0' does too" in done.stderr


def test_an_application_that_cannot_be_imported_is_named(monkeypatch, install, command):
    install(HANGING)
    lost = EntryPoint("lost", "no_such_package:application", "restshape.applications")
    monkeypatch.setattr(installed, "entry_points", lambda group: [lost])
    installed.applications.cache_clear()
    done = command("list")
    assert done.returncode == 2 and "no_such_package:application" in done.stderr
    assert "the application 'lost' cannot be imported: ModuleNotFoundError" in done.stderr


def test_an_application_without_a_template_says_so(tmp_path, install, command):
    install(HANGING)
    done = command("new", "hanging", "here")
    assert done.returncode == 2 and "'hanging' has no template" in done.stderr and not (tmp_path / "here").exists()


def test_an_application_takes_some_effects_of_its_physics_and_may_need_more_than_they_do():
    assert {name: effect.required for name, effect in HANGING.effects.items()} == {"weight": True, "wind": False}
    still = replace(HANGING, takes=("weight",))
    assert list(still.effects) == ["weight"]
    windy = replace(HANGING, takes=("wind", "weight"), needs=("wind",))
    assert list(windy.effects) == ["wind", "weight"] and all(one.required for one in windy.effects.values())
    with pytest.raises(KeyError, match="rain"):
        list(replace(HANGING, takes=("rain",)).effects)


def test_a_scene_of_an_application_that_is_not_installed_says_so(tmp_path, install):
    install(HANGING)
    path = tmp_path / "chair.toml"
    path.write_text(HEAD.replace("hanging", "benches") + "[planks.a]\nfrom = [0, 0, 0]\n")
    with pytest.raises(UserError) as caught:
        load_scene(path)
    assert caught.value.where == "chair.toml: app" and "'benches'" in caught.value.what
    assert "hanging" in caught.value.do and "install" in caught.value.do


def test_studies_of_meshes_refuse_what_has_none(tmp_path, install):
    install(HANGING)
    with pytest.raises(UserError, match="has no mesh: nothing would be reused"):
        require_mesh(scene_of(tmp_path, ROPE), "nothing would be reused")

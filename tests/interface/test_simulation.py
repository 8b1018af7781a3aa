"""A simulation that a program holds: what it gives, what it writes down, and what it refuses."""

import inspect
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from counted_calls import called

import restshape
from restshape.interface.edits import Edits
from restshape.scene.dart_event import DrawnDart
from restshape.scene.edit_script import EVENTS

BRACKET = Path(__file__).parents[2] / "docs" / "examples" / "bracket.toml"


@pytest.fixture(scope="module")
def bracket():
    return restshape.load(BRACKET, "mesh.size='30 mm'", "mesh.near.window='15 mm'")


@pytest.mark.cli
def test_the_package_imports_nothing_heavy_until_it_is_used():
    program = "import sys, restshape; print({'numpy', 'pydantic', 'petsc4py'} & set(sys.modules), dir(restshape))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("set() ") and "'open'" in done.stdout and "'replay'" in done.stdout


def test_every_offered_name_is_there_and_typed():
    stub = Path(restshape.__file__).with_suffix(".pyi").read_text()
    offered = [name for names in restshape.OFFERED.values() for name in names] + list(restshape.CALLED)
    assert all(callable(getattr(restshape, name)) for name in offered)
    assert sorted(line.split(" as ")[1] for line in stub.splitlines() if " as " in line) == sorted(offered)
    with pytest.raises(AttributeError):
        restshape.nothing  # noqa: B018


@pytest.mark.parametrize("do", [*sorted(EVENTS.keys() - {"drag", "release"}), "dart"])
def test_methods_have_the_keys_of_their_events(do):
    model = DrawnDart if do == "dart" else EVENTS[do]
    parameters = inspect.signature(getattr(Edits, do)).parameters
    fields = {name for name in model.model_fields if name not in ("line", "t", "note", "gesture", "do")}
    named = {name for name, one in parameters.items() if one.kind is not one.VAR_KEYWORD} - {"self"}
    needed = {name for name in named if parameters[name].default is inspect.Parameter.empty}
    required = {name for name in fields if model.model_fields[name].is_required()}
    assert named == fields or (do == "dart" and named < fields)
    assert needed == required


def test_a_hand_calls_little_beside_the_frame_of_a_replay(bracket):
    places = [(0.09 + 0.0005 * step, 0.062) for step in range(8)]
    with restshape.open(bracket) as sim:
        with sim.press("window") as hand:
            by_hand = [called(lambda place=place: hand.to(*place)) for place in places]
        script = sim.script
    run = restshape.replay(bracket, script)
    for _ in range(2):
        next(run)
    replayed = [called(lambda: next(run)) for _ in places]
    # `hand_more_ms` of `bench live` has their time.
    assert 15 < np.median(np.subtract(by_hand, replayed)) <= 31


def test_arrays_are_those_of_the_frame_and_stay(bracket):
    with restshape.open(bracket) as sim:
        first, mesh, stress = sim.frame, sim.frame.mesh, sim.frame.von_mises
        points, values = mesh.points.copy(), stress.copy()
        with sim.press("window") as hand:
            last = hand.to(0.11, 0.06)
            assert last.index == 2 and hand.frame is last is sim.frame
        np.testing.assert_array_equal(mesh.points, points)
        np.testing.assert_array_equal(first.von_mises, values)
        assert last.quantities.keys() == bracket.quantities.keys()
        assert last.displacement.shape == last.mesh.points.shape != ()
        assert last.von_mises.shape == (len(last.mesh.points),)
        assert last.quantities["stress_at_window"] <= last.von_mises.max()
        assert np.abs(last.mesh.points - sim.frame.mesh.points).max() == 0.0 != np.ptp(last.mesh.points)
        with pytest.raises(restshape.UserError, match=r"no field 'heat'.*\n.*displacement"):
            last.field("heat")
        unread = sim.idle()
        sim.idle()
        with pytest.raises(restshape.UserError, match="has gone on, to frame 5"):
            unread.displacement  # noqa: B018
    assert sim.frame.mesh.cells.shape == mesh.cells.shape
    with pytest.raises(restshape.UserError, match="is closed"):
        unread.mesh  # noqa: B018
    with pytest.raises(restshape.UserError, match="is closed"):
        sim.idle()


def test_an_event_that_is_not_valid_leaves_all_as_it_is(bracket):
    with restshape.open(bracket) as sim:
        before = sim.script.text
        for what, do, keys in (
            ("no event 'pres'", "pres", {"on": "window"}),
            ("line 2: factor: -1 is too small", "scale", {"on": "window", "factor": -1}),
            ("a drag before a press", "drag", {"to": [0, 0]}),
            ("line 2: to: nan is not a finite number", "drag", {"to": [0, float("nan")]}),
            ("is no number, text, list or table", "set", {"key": "a", "value": object()}),
        ):
            with pytest.raises(restshape.UserError, match=what):
                sim.do(do, **keys)
        assert sim.script.text == before and sim.frame.index == 0
        with sim.press("window"), pytest.raises(restshape.UserError, match="while 'window' is still grabbed"):
            sim.undo()
        with pytest.raises(restshape.UserError, match="time runs backwards"):
            sim.do("idle", t=0.0)
        assert [event.do for event in sim.script.events] == ["press", "release"]


def test_a_refused_event_raises_with_its_frame_and_the_edit_goes_on(bracket):
    with restshape.open(bracket) as sim:
        with pytest.raises(restshape.RefusedFrame, match="no entity named 'door'") as caught:
            sim.press("door")
        assert caught.value.frame.index == 1 and "frame 1, 'press' in line 2" in str(caught.value)
        assert caught.value.what == "the shape has no entity named 'door'"
        assert caught.value.do.startswith("use one of: a, b, c") and "\n  try: use one of: a" in str(caught.value)
        with sim.press("window") as hand:
            with pytest.raises(restshape.RefusedFrame):
                hand.to(0.1, 5.0, frames=2)
            assert not hand.to(0.1, 0.06).refused
        script = sim.script
    with restshape.open(bracket, strict=False) as sim:
        assert "no entity" in sim.do("press", on="door").refused
    frames = list(restshape.replay(bracket, script))
    assert [bool(frame.refused) for frame in frames] == [False, True, True, False, True, True, False, False]


def test_frames_that_nobody_asks_for_are_computed_all_the_same(bracket):
    with restshape.open(bracket) as sim:
        one = next(iter(sim.each("scale", on="window", factor=1.2, frames=3)))
        assert one.index == 1
        assert sim.set("material.steel.thickness", "12 mm").index == 4
        quantities, script = sim.frame.quantities, sim.script
    assert [frame.quantities for frame in restshape.replay(bracket, script)][-1] == quantities


@pytest.mark.parametrize("to", [[0.1, 0.062], ["10 cm", 0.062]])
def test_a_hand_that_is_moving_gives_the_frame_of_one_that_has_moved(bracket, to):
    with restshape.open(bracket) as sim, restshape.open(bracket) as other:
        with sim.press("window") as hand, other.press("window") as second:
            hand.to(0.095, 0.062), second.to(0.095, 0.062)
            (frame,) = sim.moving(to)
            assert frame is sim.frame and frame.quantities == second.to(*to).quantities
            assert sim.written.last_frames == 1
            # Nobody asks for this one; it is computed before the hand lets go.
            sim.moving([0.11, 0.062])
            wanted = second.to(0.11, 0.062).quantities
        assert sim.frame.index == other.frame.index == 5
        assert sim.script.text == other.script.text and wanted["stress_at_window"] > 0


def test_two_simulations_and_an_analysis_on_demand(bracket):
    with restshape.open(bracket) as sim, restshape.open(bracket, analysis="on demand") as other:
        with sim.press("window") as hand, other.press("window") as second:
            places = np.array([[0.095, 0.062], [0.1, 0.062]])
            wanted = list(hand.along(places))[-1].quantities
            assert np.isnan(second.to(0.1, 0.062).quantities["stress_at_window"])
            assert other.analyse().quantities["stress_at_window"] == pytest.approx(wanted["stress_at_window"], rel=1e-3)
        assert '"analysis": "on demand"' in other.script.text


def test_scenes_and_scripts_of_tables_are_those_of_files(bracket, tmp_path):
    restshape.save_scene(bracket, tmp_path / "saved.toml")
    again = restshape.load(tmp_path / "saved.toml")
    assert again.model_dump() == bracket.model_dump()
    with pytest.raises(restshape.UserError, match=r"already.*\n.*force=True"):
        restshape.save_scene(bracket, tmp_path / "saved.toml")
    tables = again.raw | {"title": "of tables"}
    made = restshape.new_scene(tables, BRACKET)
    assert made.title == "of tables" and made.folder == BRACKET.parent
    with pytest.raises(restshape.UserError, match=r"bracket.toml: material.steel.E"):
        restshape.new_scene(tables | {"material": {"steel": {"E": "12 kg"}}}, BRACKET)
    assert restshape.changed(made, "material.steel.E", "70 GPa").material["steel"].E == 70e9
    script = restshape.new_script(bracket, [{"do": "idle", "frames": 6}, {"do": "undo"}])
    assert [event.t for event in script.events] == [0.0, 0.1001] and script.frame_count == 8
    restshape.save_script(script, tmp_path / "saved.jsonl")
    assert restshape.load_script(tmp_path / "saved.jsonl", bracket).events == script.events
    with pytest.raises(restshape.UserError, match="line 3: there is no event 'undoo'"):
        restshape.new_script(bracket, [{"do": "idle"}, {"do": "undoo"}])


def test_an_error_in_a_frame_closes_the_simulation(bracket, monkeypatch):
    with restshape.open(bracket) as sim:
        sim.idle()
        monkeypatch.setattr(sim._replay, "_frame", lambda edit: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            sim.idle(2)
        assert sim.closed and [event.frame_count for event in sim.script.events] == [1]


def test_an_interrupt_in_frames_that_nobody_asked_for_closes_it_too(bracket, monkeypatch):
    def interrupted(edit):
        raise KeyboardInterrupt

    with restshape.open(bracket) as sim:
        sim.idle()
        next(sim.each("idle", frames=3))
        monkeypatch.setattr(sim._replay, "_frame", interrupted)
        with pytest.raises(KeyboardInterrupt):
            sim.undo()
        assert sim.closed and [event.frame_count for event in sim.script.events] == [1]

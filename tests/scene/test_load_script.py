"""Edit scripts: what stands on each line is what the events hold, in metres; bad lines are reported with their
number."""

import json
import math

import pytest
from cloths import BALL, CONTACT, PIN, cloth

from restshape.errors import UserError
from restshape.scene.edit_script import EVENTS, Script, load_script
from restshape.scene.load import load_scene

HEADER = {"format": "restshape-edits", "version": 1, "scene": "plate.toml", "units": "mm"}


@pytest.fixture
def read(tmp_path):
    """Reads a script of the events given."""

    def read(*events, header=HEADER, tail="\n", **options):
        path = tmp_path / "s.jsonl"
        lines = [json.dumps(line) if isinstance(line, dict) else line for line in (header, *events)]
        path.write_text("\n".join(lines) + tail)
        return load_script(path, **options)

    return read


PRESS = {"t": 0, "do": "press", "on": "window"}
RELEASE = {"t": 1, "do": "release"}


def test_coordinates_are_in_the_units_of_the_header(script_file):
    press, drag, path, release = load_script(script_file).events
    assert press.at == (0.5, 0.5) and drag.to == (0.52, 0.5)
    assert path.path == [(0.54, 0.5), (0.56, 0.5)]
    assert [event.line for event in (press, drag, path, release)] == [2, 3, 4, 5]
    assert release.t == 0.3


def test_text_carries_its_own_unit(read):
    assert read({"t": 0, "do": "press", "on": "a", "at": ["2 cm", 20]}).events[0].at == pytest.approx((0.02, 0.02))
    assert read({"t": 0, "do": "hole", "name": "h", "center": [0, 0], "radius": 5}).events[0].radius == 0.005
    assert read({"t": 0, "do": "rotate", "on": "a", "by": "90 deg"}).events[0].by == pytest.approx(math.pi / 2)
    assert read({"t": 0, "do": "rotate", "on": "a", "by": 0.5}).events[0].by == 0.5


def test_pins_are_names_or_places_in_the_units_of_the_header(read):
    (event,) = read({"t": 0, "do": "pull", "on": "top", "pins": ["a", [20, "3 cm"]]}).events
    assert event.pins == ["a", pytest.approx((0.02, 0.03))]


def test_the_header_says_when_the_analysis_runs(tmp_path, read):
    assert read({"t": 0, "do": "analyse"}).header.analysis == "every frame"
    path = tmp_path / "asked.jsonl"
    header = {"format": "restshape-edits", "version": 1, "scene": "a.toml"}
    path.write_text(json.dumps(header | {"analysis": "on demand"}) + "\n")
    assert load_script(path).header.analysis == "on demand"
    path.write_text(json.dumps(header | {"analysis": "on deman"}) + "\n")
    with pytest.raises(UserError, match="did you mean 'on demand'"):
        load_script(path)


def test_every_event(read):
    events = [
        {"t": 0, "do": "rotate", "on": "a", "by": 1, "about": [0, 0], "frames": 3},
        {"t": 0, "do": "scale", "on": "a", "factor": 2},
        {"t": 0, "do": "set", "key": "material.steel.E", "value": "70 GPa"},
        {"t": 0, "do": "insert", "on": "top", "s": 0.5, "name": "v"},
        {"t": 0, "do": "insert", "on": "top", "at": [1, 2], "name": "w"},
        {"t": 0, "do": "delete", "on": "v"},
        {"t": 0, "do": "arc", "on": "top", "bulge": 0.1},
        {"t": 0, "do": "arc", "on": "top", "through": [1, 2], "frames": 5},
        {"t": 0, "do": "hole", "name": "h", "polygon": [[0, 0], [1, 0], [0, 1]]},
        {"t": 0, "do": "smooth", "on": "top", "strength": 0.3, "pins": ["v"], "frames": 2},
        {"t": 0, "do": "pull", "on": "top", "at": [1, 2], "pins": ["v", [3, "2 mm"]]},
        {"t": 0, "do": "drag", "path": [[1, 3]]},
        {"t": 0, "do": "release"},
        {"t": 0, "do": "analyse"},
        {"t": 0, "do": "idle", "frames": 10},
        {"t": 0, "do": "undo"},
        {"t": 0, "do": "redo", "note": "and again"},
        PRESS,
        {"t": 0.5, "do": "drag", "to": [1, 1], "frames": 2},
        RELEASE,
    ]
    script = read(*events)
    assert [event.do for event in script.events] == [event["do"] for event in events]
    assert {event.do for event in script.events} == set(EVENTS)


@pytest.mark.parametrize(
    ("event", "message"),
    [
        ({"t": 0, "do": "pres", "on": "a"}, "did you mean 'press'"),
        ({"t": 0, "do": "press", "on": "right", "as": [1, 0]}, "there is no 'along', in which the entity goes"),
        ({"t": 0, "do": "press", "on": "a", "along": [0, 0]}, "a direction has a length, and this is zero"),
        ({"t": 0, "do": "press", "on": "a", "along": [1, 0], "as": [0, 0]}, "a direction has a length"),
        ({"t": 0, "do": "press", "on": "a", "along": [1]}, "two numbers"),
        ({"t": 0, "do": "press", "on": "a", "along": "x"}, "a list is wanted"),
        ({"t": 0, "do": "press", "on": "a", "along": ["1 mm", 0]}, "mm"),
        ({"t": 0, "do": "press", "on": "a", "mirror": [[1, 2], [1, 2]]}, "a line goes through two points"),
        ({"t": 0, "do": "pull", "on": "a", "along": [1, 0]}, "there is no key 'along' here"),
        ({"t": 0, "do": "press", "on": "a", "counted": [1, 0]}, "there is no key 'counted' here"),
        ({"t": 0, "do": ["press"], "on": "a"}, "there is no event"),
        ({"t": 0, "on": "a"}, "'do' is missing"),
        ({"do": "press", "on": "a"}, "'t' is missing"),
        ({"t": -1, "do": "press", "on": "a"}, "at least 0"),
        ({"t": 0, "do": "press"}, "'on' is missing"),
        ({"t": 0, "do": "press", "on": "a", "att": [0, 0]}, "did you mean 'at'"),
        ({"t": 0, "do": "press", "on": "a", "line": 3}, "no key 'line'"),
        ({"t": 0, "do": "press", "on": "a", "at": [0]}, "s.jsonl: line 2: at: at least 2 entries"),
        ({"t": 0, "do": "press", "on": 7}, "text in quotes is wanted"),
        ({"t": 0, "do": "rotate", "on": "a", "by": "3 mm"}, "is a length, but an angle is wanted"),
        ({"t": 0, "do": "rotate", "on": "a", "by": 1, "frames": 0}, "at least 1"),
        ({"t": 0, "do": "rotate", "on": "a", "by": 1, "frames": 1.5}, "whole number"),
        ({"t": 0, "do": "scale", "on": "a", "factor": 0}, "greater than 0"),
        ({"t": 0, "do": "insert", "on": "a", "name": "v"}, "exactly one of at, s"),
        ({"t": 0, "do": "insert", "on": "a", "name": "v", "s": 1}, "less than 1"),
        ({"t": 0, "do": "insert", "on": "a", "name": "all", "s": 0.5}, "is a keyword: it stands for everything"),
        ({"t": 0, "do": "arc", "on": "a"}, "exactly one of through, bulge"),
        ({"t": 0, "do": "hole", "name": "h", "center": [0, 0]}, "radius is wanted here, too"),
        ({"t": 0, "do": "hole", "name": "h", "polygon": [[0, 0], [1, 1]]}, "at least 3 entries"),
        ({"t": 0, "do": "drag", "to": [0, 0]}, "a drag before a press"),
        ({"t": 0, "do": "release"}, "a release before a press"),
        ('{"t": 0, "do": "idle", "frames": NaN}', "not a finite number"),
        ('{"t": 1e999, "do": "idle"}', "not a finite number"),
        ("[1, 2]", "a JSON object is wanted"),
        ("{'t': 0}", "this is not JSON"),
        ('{"t": "0}', "starting at column 7"),
        ("[" * 100000, "within each other"),
    ],
)
def test_a_bad_line_is_reported_with_its_number(read, event, message):
    with pytest.raises(UserError, match=message) as caught:
        read(event, {"t": 0, "do": "idle"})
    assert caught.value.where.startswith("s.jsonl: line 2")


def test_a_list_is_not_called_too_short_because_an_entry_of_it_is_wrong(read):
    with pytest.raises(UserError, match="is a mass, but a length is wanted") as caught:
        read({"t": 0, "do": "press", "on": "a", "at": ["3 kg", "2 mm"]})
    assert "entries" not in str(caught.value)


@pytest.mark.parametrize(
    ("events", "line", "message"),
    [
        ([PRESS, RELEASE, {"t": 0.5, "do": "idle"}], 4, "time runs backwards"),
        ([PRESS, PRESS], 3, "while 'window' is still grabbed"),
        ([PRESS, {"t": 0, "do": "undo"}], 3, "while 'window' is still grabbed"),
        ([PRESS, RELEASE, RELEASE], 4, "release before a press"),
    ],
)
def test_events_come_in_order(read, events, line, message):
    with pytest.raises(UserError, match=message) as caught:
        read(*events)
    assert caught.value.where == f"s.jsonl: line {line}"


@pytest.mark.parametrize(
    ("header", "message"),
    [
        (PRESS, "the header is missing"),
        ({"format": "restshape-scene", "version": 1}, "not an edit script"),
        (HEADER | {"version": 2}, "version 2 is not known"),
        ({"format": "restshape-edits"}, "version None"),
        (HEADER | {"units": "kg"}, "is a mass, but a length is wanted"),
        (HEADER | {"unit": "mm"}, "did you mean 'units'"),
    ],
)
def test_headers(read, header, message):
    with pytest.raises(UserError, match=message):
        read(header=header)


IN_SPACE = [
    {"do": "press", "on": "NAME", "at": [0, 0, 0]},
    {"do": "drag", "to": [250, 0, 20]},
    {"do": "drag", "path": [[0, 0], [1, 0, 2]], "frames": 4},
]


DO = "leave out z, or press on one of: supports.pin"


@pytest.mark.parametrize("name", ["ball", "pin", "supports.pin"])
@pytest.mark.parametrize("event", IN_SPACE)
def test_bodies_and_pins_go_to_places_in_space_and_parts_of_the_pattern_do_not(tmp_path, read, name, event):
    scene = cloth(tmp_path, CONTACT, BALL, PIN)
    events = [event] if event["do"] == "press" else [{"do": "press", "on": "NAME"}, event]

    def script(on):
        return read(
            *({"t": k} | one | ({"on": on} if "on" in one else {}) for k, one in enumerate(events)), scene=scene
        )

    assert len(script(name).events) == len(events)
    with pytest.raises(UserError, match="a place in the plane has 2 numbers, and there are 3: a is no body") as printed:
        script("a")
    key = "at" if event["do"] == "press" else "to" if "to" in event else "path.1"
    assert printed.value.where.endswith(f"line {1 + len(events)}: {key}") and printed.value.do == DO


def test_a_torn_last_line_is_reported_and_the_others_stay(read):
    script = read(PRESS, '{"t": 0.1, "do": "dr', tail="")
    assert [event.do for event in script.events] == ["press"]
    assert "line 3" in script.torn and "torn" in script.torn
    assert script.error is not None


def test_a_whole_last_line_without_newline_is_not_torn(read):
    script = read(PRESS, RELEASE, tail="")
    assert script.torn is None and len(script.events) == 2


def test_half_a_line_in_the_middle_is_not_torn_but_bad(read):
    with pytest.raises(UserError, match="not JSON"):
        read(PRESS, '{"t": 0.1, "do": "dr', RELEASE, tail="")


def test_good_lines_before_a_bad_one_can_be_kept(read):
    script = read(PRESS, {"t": 0.1, "do": "drga", "to": [1, 1]}, RELEASE, keep_good=True)
    assert [event.do for event in script.events] == ["press"]
    assert "did you mean 'drag'" in str(script.error) and script.torn is None


def test_another_scene_is_a_warning(scene_file, script_file):
    scene = load_scene(scene_file)
    assert load_script(script_file, scene).warnings == ()
    script_file.write_text(script_file.read_text().replace("plate.toml", "other.toml"))
    assert "other.toml" in load_script(script_file, scene).warnings[0]


def test_no_script(scene_file):
    script = Script.empty(load_scene(scene_file))
    assert script.events == () and script.header.scene == "plate.toml"

"""Numbers without a unit that are meant in another one than SI: what `check` says, and `replay` when it begins."""

import pytest
from small_scenes import HEAD, STEEL, block, head, meshed, write_scene, write_script

from restshape.cli.bare_numbers import bare_numbers
from restshape.cli.check_scene import starting_outline
from restshape.cli.doubts import script_doubts
from restshape.cli.main import main
from restshape.scene.bare_lengths import bare_lengths
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

BODY = HEAD + block(0.3, 0.1) + STEEL
COOLING = (
    head("conduction")
    + block(1.0, 1.0)
    + '[material.m]\nconductivity = 2\nrho = 100\nspecific_heat = 3\n[supports.w]\non = "left"\n'
    + "fix = { temperature = 0 }\n[effects.storage]\ntime_step = 0.5\ninitial = 0\n[mesh]\nsize = 0.5\n"
)
CLAMP = '[supports.left]\non = "left"\nfix = {{ x = 0, y = {} }}\n[loads.right]\non = "right"\ntraction = [1e3, 0]\n'


def scene_of(folder, size="0.02", y="0"):
    return load_scene(write_scene(folder, BODY + CLAMP.format(y) + f"[mesh]\nsize = {size}\n"))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, ""),
        ({"size": '"20 mm"', "y": '"5 mm"'}, ""),
        ({"size": "5"}, "mesh.size: a length without a unit is in metres, and 5 m is more than the 0.3 m"),
        ({"y": "2"}, "supports.left.fix.y: a length without a unit"),
    ],
)
def test_lengths_beyond_the_shape(tmp_path, change, words):
    found = bare_numbers(scene_of(tmp_path, **change), 0.3)
    assert len(found) == bool(words) and all(words in one for one in found)


BEAM = (
    HEAD
    + '[parameters]\nlong = LONG\nhigh = "20 mm"\nn = 400\n[shape]\noutline = ["bottom", "right", "top", "left"]\n'
    + '[shape.vertices]\na = [0, 0]\nb = ["long", 0]\nc = ["long", "high + n*1e-9 m"]\nd = [0, "high"]\n'
    + '[shape.edges]\nbottom = { line = ["a", "b"] }\nright = { line = ["b", "c"] }\ntop = { line = ["c", "d"] }\n'
    + 'left = { line = ["d", "a"] }\n'
    + STEEL
    + '[mesh]\nsize = "10 mm"\n'
)


def test_a_length_of_the_shape_without_a_unit_is_named_with_its_line(command, tmp_path):
    write_scene(tmp_path, BEAM.replace("LONG", "200"), "long.toml")
    line = (tmp_path / "long.toml").read_text().splitlines().index("long = 200") + 1
    for name in ("check", "replay"):
        refused = command(name, "long.toml")
        assert refused.returncode == 2 and f"look at long.toml: parameters.long (line {line}) first" in refused.stderr
        assert '"200 mm" or "200 m"?' in refused.stderr and "parameters.n" not in refused.stderr
    for right in ('"200 mm"', "0.2", "2"):
        write_scene(tmp_path, BEAM.replace("LONG", right), "right.toml")
        assert "parameters.long: a length" not in command("check", "right.toml").stdout
    assert bare_lengths(load_scene(write_scene(tmp_path, BEAM.replace("LONG", "200")))) != []


@pytest.mark.parametrize(("initial", "odd"), [("0", False), ("293.15", False), ('"20 degC"', False), ("20", True)])
def test_temperatures_that_are_too_cold(tmp_path, initial, odd):
    scene = load_scene(write_scene(tmp_path, COOLING.replace("initial = 0", f"initial = {initial}")))
    found = bare_numbers(scene, 1.0)
    assert len(found) == odd
    if odd:
        assert "effects.storage.initial" in found[0] and '20 K is -253.1 degC: "20 degC" or "20 K"?' in found[0]


def test_values_that_a_script_sets_and_angles_that_it_turns_by(tmp_path, capsys):
    scene = scene_of(tmp_path)
    events = [
        {"t": 0.0, "do": "set", "key": "mesh.size", "value": "5 mm"},
        {"t": 0.1, "do": "set", "key": "mesh.size", "value": 5},
        {"t": 0.2, "do": "rotate", "on": "right", "by": 30},
        {"t": 0.3, "do": "rotate", "on": "right", "by": "400 deg"},
    ]
    path = write_script(tmp_path, events)
    script = load_script(path, scene)
    (reported,) = script_doubts(scene, starting_outline(scene), script)
    assert reported.startswith("line 3: set mesh.size: a length without a unit") and '"5 mm" or "5 m"?' in reported
    assert [one.partition(":")[0] for one in script.warnings] == ["line 4"] and '"30 deg"' in script.warnings[0]
    main(["check", str(scene.path), str(path)])
    printed = capsys.readouterr().err
    assert "line 3: set mesh.size" in printed and '"30 deg" or "30 rad"' in printed


def test_a_replay_counts_the_warnings_of_check_when_it_begins(tmp_path, capsys):
    scene = write_scene(tmp_path, BODY.replace("200e9", "200e14") + CLAMP.format("2") + meshed(0.05))
    assert main(["replay", str(scene)]) == 0
    reported = [line for line in capsys.readouterr().err.splitlines() if line.startswith("note:")]
    assert len(reported) == 1 and reported[0].startswith(
        "note: 2 more warnings, which restshape check lists; the first: "
    )

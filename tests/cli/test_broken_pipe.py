"""Output that nobody reads any more ends a command without a word, as it ends the tools of Unix."""

import json

import pytest
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.application import applications
from restshape.cli.options import print_table

COMMANDS = {
    "check": ("check", "plate.toml", "edits.jsonl"),
    "replay": ("replay", "plate.toml", "--edits", "edits.jsonl"),
    "explain": ("explain", "plate.toml", "--seconds", "0"),
    "list": ("list",),
    "schema": ("schema", "scene"),
    "info": ("info",),
    "help": ("--help",),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_a_reader_that_has_gone_ends_a_command_quietly(tmp_path, start_restshape, name):
    write_scene(tmp_path, plate(), "plate.toml")
    write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.55, 0.5), 3)))
    process = start_restshape(*COMMANDS[name])
    process.stdout.close()
    said = [line for line in process.stderr if not line.startswith("note: ")]
    # A shell reports 128 and the number of the signal of a program that a broken pipe ended, which is 13.
    assert process.wait() == 141
    assert said == []


def test_messages_that_nobody_reads_end_a_command_as_well(start_restshape):
    process = start_restshape("check", "nowhere.toml")
    process.stderr.close()
    assert process.wait() == 141


@pytest.mark.slow
def test_what_a_replay_is_asked_to_write_is_there_although_nobody_reads(tmp_path, start_restshape):
    write_scene(tmp_path, plate(), "plate.toml")
    process = start_restshape("replay", "plate.toml", "--json", "found.json", "--csv", "found.csv")
    process.stdout.close()
    assert process.wait() == 141
    assert json.loads((tmp_path / "found.json").read_text())["frames"] == 1
    assert len((tmp_path / "found.csv").read_text().splitlines()) == 2


def test_a_reader_that_stays_gets_a_row_a_line_however_long_it_is(restshape):
    done = restshape("list")
    scenes = [scene for app in applications().values() for scene in app.scenes()]
    lines = done.stdout.split("scenes\n")[1].splitlines()[1:]
    assert done.returncode == 0
    assert len(lines) == len(scenes)
    assert max(map(len, lines)) > 160
    for scene, line in zip(scenes, lines, strict=True):
        assert str(scene) in line and line == line.rstrip()


def test_cells_of_several_lines_are_one_where_nothing_is_a_terminal(capsys):
    print_table("rows", ("a", "b"), [("one\ntwo", "x"), ("three", "y")])
    assert capsys.readouterr().out.splitlines() == ["rows", "a        b", "one two  x", "three    y"]

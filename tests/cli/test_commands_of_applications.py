"""Commands that applications bring: in the help and the list, imported when used, gone with their application."""

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from small_scenes import plate, write_scene

from restshape import application as registry
from restshape.application import Application, Command, Declared, brought_commands
from restshape.cli.main import command_parser, help_parser, main, named_command
from restshape.cli.parser import Parser, add_edits

BROUGHT = {one.name: app for app, many in brought_commands().items() for one in many}


def test_help_and_list_name_each_command(capsys):
    assert BROUGHT["sample-names"] == BROUGHT["sample-of-plane"] == "plane"
    assert main(["list"]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    help_text = " ".join(help_parser().format_help().split())
    for name, app in BROUGHT.items():
        assert any(line[:3] == [app, "restshape", name] for line in lines), name
        assert f"{name} {app}: " in help_text


@pytest.mark.parametrize("name", BROUGHT)
def test_each_has_options_and_a_summary(name):
    summary, module = named_command(name, [])
    text = command_parser(name, summary, module).format_help()
    assert f"usage: restshape {name}" in text and summary in " ".join(text.split())


@pytest.mark.parametrize("name", [name for name in BROUGHT if not name.startswith("sample-")])
def test_each_takes_json_but_those_whose_result_is_the_file_that_they_write(name):
    summary, module = named_command(name, [])
    text = command_parser(name, summary, module).format_help()
    assert "--json" in text or " --out" in text.replace("[--out", "")


def test_names_are_given_once():
    names = [one.name for many in brought_commands().values() for one in many]
    assert len(names) == len(set(names))
    assert all(named_command(name, [])[1].__name__ != f"restshape.cli.{name}" for name in names)


def test_commands_go_with_their_application(monkeypatch):
    assert named_command("sample-names", []) is not None and named_command("sample-of-plane", []) is not None
    rest = {name: app for name, app in registry.applications().items() if name != "plane"}
    monkeypatch.setattr(registry, "applications", lambda: rest)
    assert named_command("sample-names", []) is None and named_command("sample-of-plane", []) is None
    assert "sample-names" not in help_parser().format_help()


def test_one_runs_as_all_commands_do(tmp_path, capsys):
    scene = write_scene(tmp_path, plate(0.3))
    assert main(["sample-names", str(scene), "--json", str(tmp_path / "a.json")]) == 0
    names = capsys.readouterr().out.split()
    assert names and json.loads((tmp_path / "a.json").read_text()) == names
    assert main(["sample-names", str(tmp_path / "none.toml")]) == 2
    assert "restshape sample-names: " in capsys.readouterr().err


@pytest.mark.cli
def test_the_list_imports_no_physics_and_no_command():
    program = "import sys; from restshape.cli.main import main; main(['list'])\n"
    program += (
        "print([name for name in sys.modules if '.physics.' in name or 'pydantic' in name or '_command' in name])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "[]", done.stdout[-500:] + done.stderr


def test_declared_physics_are_those_of_their_paths(tmp_path):
    path = "restshape.physics.heat.heat_declaration:HEAT"
    app = Application("rods", "rods", tmp_path, Declared(path, path), "")
    from restshape.physics.heat.heat_declaration import HEAT

    assert list(app.physics) == [HEAT, HEAT] and app.physics[0] is HEAT and len(app.physics) == 2
    assert Command("a", "b", "restshape.bounds").load().__name__ == "restshape.bounds"


@pytest.mark.parametrize(
    "words",
    [
        ["s.toml", "e.jsonl", "--policy", "auto"],
        ["s.toml", "--policy", "auto", "e.jsonl"],
        ["--policy", "auto", "s.toml", "e.jsonl"],
        ["s.toml", "--edits", "e.jsonl", "--policy", "auto"],
        ["--edits", "e.jsonl", "--policy", "auto", "s.toml"],
    ],
)
def test_edits_stand_anywhere(words):
    args = _parser().parse_args(words)
    assert (args.scene, str(args.edits), args.policy) == ("s.toml", "e.jsonl", "auto")


def test_edits_may_be_left_out_and_are_named_once(capsys):
    assert _parser().parse_args(["s.toml"]).edits is None
    with pytest.raises(SystemExit):
        _parser().parse_args(["s.toml", "e.jsonl", "--edits", "f.jsonl"])
    assert "f.jsonl and e.jsonl: name one" in capsys.readouterr().err


def _parser() -> argparse.ArgumentParser:
    parser = Parser(prog="restshape try")
    parser.add_argument("scene")
    add_edits(parser, "the script")
    parser.add_argument("--policy")
    return parser


def test_the_page_lists_the_commands_that_there_are():
    page = (Path(__file__).parents[2] / "docs" / "commands.md").read_text()
    table = page.partition("## Commands of applications")[2].partition("\n## ")[0]
    rows = [line.split("|")[1:3] for line in table.splitlines() if line.startswith("| `")]
    listed = {app.strip(" `"): sorted(re.findall("`([^`]+)`", names)) for app, names in rows}
    known = {app: sorted(one.name for one in many) for app, many in brought_commands().items() if many}
    # The application of these tests is on no page.
    known.pop("plane")
    assert listed == known

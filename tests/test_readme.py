"""The README's example is what a reader can type in and run."""

import re
import shlex
from pathlib import Path

import pytest

from restshape.cli.main import all_commands, main

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    """The README's only code block in that language."""
    (found,) = re.findall(rf"```{language}\n(.*?)```", README, re.S)
    return found


@pytest.fixture
def example(tmp_path, monkeypatch):
    (tmp_path / "bracket.toml").write_text(block("toml"))
    (tmp_path / "bracket.jsonl").write_text(block("json"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_commands_of_the_example_run(example, capsys):
    shell = "".join(re.findall(r"```sh\n(.*?)```", README.split("## What accuracy costs")[0], re.S))
    lines = [line for line in shell.splitlines() if line.startswith("restshape ")]
    assert [shlex.split(line)[1] for line in lines] == ["check", "replay", "report", "script"]
    for line in lines:
        assert main(shlex.split(line)[1:]) == 0, line
    assert "0 refused" in capsys.readouterr().out
    assert (example / "bracket-report" / "frames.png").stat().st_size > 10_000


def test_the_example_carries_its_load(example, capsys):
    assert main(["replay", "bracket.toml", "--json", "summary.json"]) == 0
    import json

    force = json.loads((example / "summary.json").read_text())["quantities"]["wall_force"][0]
    arm = 0.3 * 0.12 - 0.5 * 0.3 * 0.06  # hull of the four corners, less what the arc and the hole take away
    weight = (force - 2000.0) / (7850 * 9.81 * 0.008)
    assert 0.8 * arm < weight < 1.2 * arm


def test_every_command_named_exists():
    named = set(re.findall(r"^\| `restshape (\w+)", README, re.M))
    assert named <= set(all_commands())


def test_the_commands_of_furniture_run(tmp_path, monkeypatch, capsys):
    (tmp_path / "apps").symlink_to(Path(__file__).parents[1] / "apps")
    monkeypatch.chdir(tmp_path)
    lines = [
        line for line in README.split("## Furniture")[1].split("```")[1].splitlines() if line.startswith("restshape ")
    ]
    assert [shlex.split(line)[1] for line in lines] == ["replay", "report", "script"]
    for line in lines:
        assert main(shlex.split(line)[1:]) == 0, line
    assert main(["check", "apps/furniture/scenes/chair-1.toml", "back.jsonl"]) == 0
    assert " 0 refused" in capsys.readouterr().out
    assert (tmp_path / "table-report" / "guidance.png").stat().st_size > 10_000

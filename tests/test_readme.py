"""The README's example is what a reader can type in and run."""

import json
import re
import shlex
from pathlib import Path

import pytest

from restshape.cli.main import all_commands, main

ROOT = Path(__file__).parents[1]
SHIPPED = [path.parent.name for path in (ROOT / "apps").glob("*/__init__.py")]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SCENES = (ROOT / "docs" / "scenes.md").read_text(encoding="utf-8")
COMMANDS = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")


def block(page: str, language: str) -> str:
    """The page's only code block in that language."""
    (found,) = re.findall(rf"```{language}\n(.*?)```", page, re.S)
    return found


def test_the_example_is_the_one_whose_picture_is_shown():
    for name, language in (("bracket.toml", "toml"), ("bracket.jsonl", "json")):
        assert (ROOT / "docs" / "examples" / name).read_text(encoding="utf-8") == block(README, language)


NO_ANIMATION = ["--animation", "none"]
"""Of a report: the demonstration's animation is enough."""


def commands(page: str) -> list[str]:
    """The lines of the page's shell blocks that run restshape."""
    shell = "".join(re.findall(r"```sh\n(.*?)```", page, re.S))
    return [line for line in shell.splitlines() if line.startswith("restshape ")]


def write(page: str, folder: Path) -> None:
    (folder / "bracket.toml").write_text(block(page, "toml"))
    (folder / "bracket.jsonl").write_text(block(page, "json"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("page", "names"),
    [(README, ["check", "replay", "report"]), (SCENES, ["check", "replay", "report", "script"])],
)
def test_the_commands_of_the_example_run(page, names, tmp_path, monkeypatch, capsys):
    write(page, tmp_path)
    monkeypatch.chdir(tmp_path)
    lines = commands(page)
    assert [shlex.split(line)[1] for line in lines] == names
    for line in lines:
        words = shlex.split(line)[1:]
        assert main([*words, *(NO_ANIMATION if words[0] == "report" else [])]) == 0, line
    assert "0 refused" in capsys.readouterr().out
    assert (tmp_path / "bracket-report" / "frames.png").stat().st_size > 10_000


def test_the_example_carries_its_load(tmp_path, monkeypatch):
    write(SCENES, tmp_path)
    monkeypatch.chdir(tmp_path)
    assert main(["replay", "bracket.toml", "--json", "summary.json"]) == 0
    force = json.loads((tmp_path / "summary.json").read_text())["quantities"]["wall_force"][0]
    arm = 0.3 * 0.12 - 0.5 * 0.3 * 0.06  # hull of the four corners, less what the arc and the hole take away
    weight = (force - 2000.0) / (7850 * 9.81 * 0.008)
    assert 0.8 * arm < weight < 1.2 * arm


def test_the_readme_fits_two_screens():
    assert len(README.splitlines()) <= 88


def section(page: str, name: str) -> list[str]:
    """The lines of the page's section of that name that are not empty."""
    text = re.split(rf"^## {name}$", page, flags=re.M)[1].split("\n## ")[0]
    return [line for line in text.splitlines() if line]


def test_the_readme_leads_on():
    documentation = section(README, "Documentation")
    assert len(documentation) <= 6
    assert len([line for line in documentation if "(docs/commands.md#the-commands)" in line]) == 1
    shown = "\n".join(section(README, "Applications"))
    assert [name for name in SHIPPED if f"[`{name}`](docs/" not in shown] == []
    assert shown.count("<img ") == shown.count("[`")


def test_every_command_is_explained_in_one_row():
    rows = re.findall(r"^\| (`[^|]+) \|", "\n".join(section(COMMANDS, "The commands")), re.M)
    explained = [word for row in rows for word in re.findall(r"`(?:restshape )?(\w+)", row)]
    assert sorted(explained) == sorted(all_commands())

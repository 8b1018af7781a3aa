"""What is committed under results/ is what its commands print."""

from pathlib import Path

import pytest

from restshape.cli.main import main

THESIS = Path(__file__).parents[1] / "results" / "THESIS.md"


def test_the_committed_table_holds(capsys):
    assert main(["tables", "--check", "--out", str(THESIS)]) == 0, capsys.readouterr().out


def test_a_changed_count_is_noticed(tmp_path, capsys):
    text = THESIS.read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if "policy auto" in line and "level 1" in line)
    changed = tmp_path / "THESIS.md"
    cells = line.split(" | ")
    cells[3] = str(int(cells[3]) + 1)
    changed.write_text(text.replace(line, " | ".join(cells)), encoding="utf-8")
    assert main(["tables", "--check", "--out", str(changed)]) == 1
    assert "not there" in capsys.readouterr().out


@pytest.mark.parametrize("name", ["frames.png", "levels.png", "timeline.png"])
def test_the_readme_pictures_are_there(name):
    assert (THESIS.parent / "plate-report" / name).is_file()

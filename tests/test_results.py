"""What is committed under results/ is what its commands print."""

import re
from pathlib import Path

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


def test_what_the_readme_shows_is_there():
    readme = (THESIS.parents[1] / "README.md").read_text(encoding="utf-8")
    named = re.findall(r"\]\(((?:results|docs)/[^)]+)\)", readme)
    assert len(named) >= 5
    assert [name for name in named if not (THESIS.parents[1] / name).is_file()] == []

"""What is committed under results/ is what its commands print."""

import re
from pathlib import Path

from restshape.application import Application
from restshape.cli.main import main

THESIS = Path(__file__).parents[1] / "results" / "THESIS.md"


def test_the_committed_table_holds(capsys):
    assert main(["tables", "--check", "--out", str(THESIS)]) == 0, capsys.readouterr().out


def test_a_changed_count_is_noticed(tmp_path, capsys, monkeypatch):
    row = {"table": "4.2", "row": "level 1", "quantity": "frames", "thesis": 117, "unit": "frames", "timing": False}
    monkeypatch.setattr(Application, "thesis_rows", lambda app, timed: [{**row, "ours": 155}])
    path = tmp_path / "THESIS.md"
    assert main(["tables", "--out", str(path)]) == main(["tables", "--check", "--out", str(path)]) == 0
    capsys.readouterr()
    path.write_text(path.read_text(encoding="utf-8").replace("155", "156"), encoding="utf-8")
    assert main(["tables", "--check", "--out", str(path)]) == 1
    assert "not there" in capsys.readouterr().out


def test_what_the_readme_shows_is_there():
    readme = (THESIS.parents[1] / "README.md").read_text(encoding="utf-8")
    named = re.findall(r"""(?:\]\(|src=")((?:results|docs)/[^)"]+)""", readme)
    assert len(named) >= 5
    assert [name for name in named if not (THESIS.parents[1] / name).is_file()] == []

"""The pages on the Python interface: their programs run, and the page of every name is current."""

import re
import runpy
from pathlib import Path

import restshape

ROOT = Path(__file__).parents[2]


def test_the_programs_of_the_page_run(tmp_path, monkeypatch):
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    coarse = restshape.load(ROOT / "docs/examples/bracket.toml", "mesh.size='30 mm'", "mesh.near.window='15 mm'")
    restshape.save_scene(coarse, tmp_path / "bracket.toml")
    monkeypatch.chdir(tmp_path)
    known = {}
    blocks = re.findall(r"^```python\n(.*?)^```$", text, re.S | re.M)
    for block in blocks:
        exec(block, known)
    assert len(blocks) >= 4 and known["largest"] > 1e6 and known["longer"].frame_count == 7
    assert {path.name for path in tmp_path.iterdir()} >= {"done.jsonl", "thinner.toml", "longer.jsonl"}


def test_the_page_of_every_name_is_current():
    made = runpy.run_path(str(ROOT / "scripts" / "interface_page.py"))
    assert made["PAGE"].read_text(encoding="utf-8") == made["page"]()
    named = {*made["SHOWN"], *made["KINDS"], *made["ELSEWHERE"]}
    assert named == {*(name for names in restshape.OFFERED.values() for name in names), *restshape.CALLED}

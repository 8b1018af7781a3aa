"""The tutorial's commands run in their order, on the files that it prints, with the numbers that it shows."""

import re
import shlex
from pathlib import Path

import ezdxf
import pytest

from restshape.cli.main import main

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
FILES = re.findall(r"[Ss]ave (?:this|it) as\s+`([\w.]+)`:\n\n```(?:toml|json)\n(.*?)```", PAGE, re.S)
BLOCKS = re.findall(r"```(sh|text)\n(.*?)```", PAGE, re.S)
COMMANDS = [line for kind, text in BLOCKS if kind == "sh" for line in text.splitlines()]
MOST = 12
"""Commands from an idea to a drawing."""
WITHIN = 0.03
"""Share by which numbers may differ from those on the page: another mesh is as far."""


def reported(text: str) -> list[tuple[str, list[float]]]:
    """Quantities of a table with their first and last value, in the unit of the table."""
    number = r"([\d.e+-]+)(?: [^\W\d]+²?)?"
    return [(name, [float(a), float(b)]) for name, a, b in re.findall(rf"^(\w+) +{number} +{number}", text, re.M)]


def test_no_more_commands_are_needed_than_promised():
    assert 0 < len(COMMANDS) <= MOST and all(line.startswith("restshape ") for line in COMMANDS)
    assert [name for name, _ in FILES] == ["wrench.toml", "where.jsonl", "final.jsonl", "drawn.toml"]


@pytest.mark.slow
def test_the_commands_go_from_the_idea_to_the_drawing_and_back(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, text in FILES:
        (tmp_path / name).write_text(text, encoding="utf-8")
    printed: dict[str, list[float]] = {}
    compared = 0
    for kind, text in BLOCKS:
        if kind == "text":
            for name, values in reported(text):
                assert printed[name] == pytest.approx(values, rel=WITHIN), text
                compared += 1
            continue
        for line in text.splitlines():
            assert main(shlex.split(line)[1:]) == 0, line
            # The first table with a name is that of its values.
            printed |= dict(reversed(reported(capsys.readouterr().out)))
    assert compared == 4
    (hole,) = ezdxf.readfile(tmp_path / "wrench.dxf").modelspace().query("CIRCLE")
    assert tuple(hole.dxf.center)[:2] == pytest.approx((70.0, 0.0), abs=1e-6)
    assert hole.dxf.radius == pytest.approx(6.6)
    for name in ("wrench.svg", "wrench.png", "drawn.png", "where-report/quantities.png", "wrench-report/frames.png"):
        assert (tmp_path / name).stat().st_size > 1000, name

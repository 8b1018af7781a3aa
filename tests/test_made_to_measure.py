"""The page on shapes by parameters: its commands run on the files that it prints, and give its numbers."""

import re
import shlex
from pathlib import Path

import ezdxf
import pytest

from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

PAGE = (Path(__file__).parents[1] / "docs" / "made-to-measure.md").read_text(encoding="utf-8")
FILES = re.findall(r"[Ss]ave this as `([\w.]+)`:\n\n```(?:toml|json)\n(.*?)```", PAGE, re.S)
COMMANDS = [line for text in re.findall(r"```sh\n(.*?)```", PAGE, re.S) for line in text.splitlines()]
ROWS = [row for text in re.findall(r"```text\n(.*?)```", PAGE, re.S) for row in text.splitlines()]
WITHIN = 0.01
"""Share by which displacements may differ: another mesh is as far."""


def numbers(line):
    """The numbers of a line of a table."""
    return [
        float(one.replace("\N{MINUS SIGN}", "-")) for one in re.findall(r"(?<![\w.])[-\N{MINUS SIGN}]?\d[\d.]*", line)
    ]


@pytest.mark.slow
def test_its_commands_give_what_it_says(command, tmp_path):
    for name, text in FILES:
        (tmp_path / name).write_text(text, encoding="utf-8")
    printed: list[str] = []
    for line in COMMANDS:
        words = shlex.split(line)
        assert words[0] == "restshape"
        done = command(*words[1:])
        assert done.returncode == 0, done.stderr
        printed += done.stdout.splitlines()
    values = [row for row in ROWS if re.search(r"m²", row)]
    assert len(values) == 5
    for row in values:
        name = row.split("  ")[0]
        (found,) = (one for one in printed if one.startswith(f"{name} ") and "m²" in one)
        assert numbers(found)[:5] == pytest.approx(numbers(row)[:5], rel=WITHIN), row
    mine = load_scene(tmp_path / "mine.toml")
    assert mine.raw["shape"]["vertices"]["c"] == ["depth", pytest.approx(0.21)]
    wider = outline_from_spec(load_scene(tmp_path / "mine.toml", ["parameters.depth=0.31"]).shape)
    drawing = ezdxf.readfile(tmp_path / "mine.dxf").modelspace()
    assert {round(circle.dxf.radius, 9) for circle in drawing.query("CIRCLE")} == {3.0}
    assert wider.bounds()[1][0] == pytest.approx(0.31)

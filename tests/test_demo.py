"""`make demo` takes less than a minute and writes into demo/ alone."""

import re
import shlex
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MOST = 60.0
"""Seconds of the processor's time."""


def recipe(target: str) -> list[list[str]]:
    """The commands of a target of the Makefile, with its variables put in."""
    text = (ROOT / "Makefile").read_text(encoding="utf-8")
    variables = dict(re.findall(r"^(\w+) := (.*)$", text, re.M))
    lines = re.search(rf"^{target}:.*\n((?:\t.*\n)+)", text, re.M)[1].splitlines()
    return [shlex.split(re.sub(r"\$\((\w+)\)", lambda found: variables[found[1]], line.strip("\t@"))) for line in lines]


@pytest.mark.slow
def test_demo(tmp_path, command):
    made, *commands, opened, said = recipe("demo")
    assert made == ["mkdir", "-p", "demo"] and len(commands) == 2
    assert opened[0] == "echo" and opened[1].endswith(f"restshape live {commands[0][2]} --open")
    assert said[0] == "echo" and said[1].endswith(": . .venv/bin/activate")
    (tmp_path / "demo").mkdir()
    start = time.process_time()
    for program, *words in commands:
        assert program == ".venv/bin/restshape"
        # Scenes are read where they are; all else is below the folder that the command runs in.
        done = command(*(ROOT / word if word.startswith("apps/") else word for word in words))
        assert done.returncode == 0, done.stderr
    assert time.process_time() - start < MOST
    assert [path.name for path in tmp_path.iterdir()] == ["demo"]
    found = {path.name for path in (tmp_path / "demo").rglob("*.*")}
    assert found >= {"plate.vtkhdf", "frames.png", "quantities.png", "timeline.png", "animation.gif"}

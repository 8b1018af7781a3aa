"""Names of files that hold what a terminal obeys are printed without it, and on one line."""

import re
from pathlib import Path

from small_scenes import block, head, write_scene

BODY = block(0.12, 0.1) + (
    "[material.m]\nE = 2e11\nnu = 0.3\nthickness = 0.005\n"
    '[supports.left]\non = "left"\nfix = { x = 0, y = 0 }\n[loads.w]\non = "right"\nforce = [0, -500]\n'
    "[mesh]\nsize = 0.06\n"
)
NAME = "es\x1b[31mc\nape"


def test_names_of_what_is_written(tmp_path, command):
    scene = write_scene(tmp_path, head("solid") + BODY)
    runs = [
        command("check", scene, "--picture", f"{NAME}.png"),
        command("replay", scene, "--out", "out.vtkhdf"),
        command("report", "out.vtkhdf", "--out", NAME, "--frames", "1"),
        command("export", "out.vtkhdf", "--as", "csv", "--out", f"{NAME}.csv"),
    ]
    for run in (runs[0], *runs[2:]):
        assert run.returncode == 0, run.stderr
        wrote = [line for line in run.stdout.splitlines() if line.startswith("wrote ")]
        assert wrote and all("es[31mc ape" in line for line in wrote) and "\x1b" not in run.stdout


ROOT = Path(__file__).parents[2]
UNSAFE = re.compile(r"""print\(\s*f?["'][^"'\n]*\bwrote \{(?!one_line\()|\bwrote ["'] *[,+]""")
"""What prints the name of a written file as it is."""


def test_no_source_prints_the_name_of_a_written_file_as_it_is():
    paths = [path for room in ("lib", "apps", "studies", "verification") for path in (ROOT / room).rglob("*.py")]
    assert len(paths) > 500
    found = [path for path in paths if "tests" not in path.parts and UNSAFE.search(path.read_text(encoding="utf-8"))]
    assert found == []


def test_what_prints_a_name_as_it_is_is_found():
    for line in ('print(f"wrote {path}")', "print(f'wrote {args.out}: 3 frames')", 'print("wrote ", path)'):
        assert UNSAFE.search(line)
    assert not UNSAFE.search('print(f"wrote {one_line(path)}")')

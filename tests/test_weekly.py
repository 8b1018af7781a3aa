"""What waits for `make weekly` stands in docs/tests.md, and `make weekly` runs it."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "tests.md").read_text(encoding="utf-8")
CONFIGURATION = {"conftest.py", "test_weekly.py", "test_mutants.py"}
"""Files that speak of the mark and have no such test."""


def test_the_page_names_every_file_with_a_test_of_a_week():
    files = [path for room in ("tests", "apps") for path in (ROOT / room).rglob("test_*.py")]
    marked = [path for path in files if "mark.weekly" in path.read_text(encoding="utf-8")]
    named = {str(path.relative_to(ROOT)) for path in marked if path.name not in CONFIGURATION}
    assert len(named) > 10
    assert sorted(name for name in named if f"| `{name}` |" not in PAGE) == []


def test_every_file_of_the_page_has_one():
    named = [line.split("`")[1] for line in PAGE.splitlines() if line.startswith("| `")]
    assert named and all((ROOT / name).is_file() for name in named)


def test_the_weekly_command_runs_that_mark():
    assert '-m "weekly and not results"' in (ROOT / "Makefile").read_text(encoding="utf-8")

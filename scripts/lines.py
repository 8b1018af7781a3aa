"""Net lines of code by room, in one or several commits: lines that are neither blank nor comments alone.

python scripts/lines.py                    those of HEAD
python scripts/lines.py 50e85ad HEAD       those of two commits beside each other

Docstrings count. Tests that live with an application count as tests. Before there were the folders studies/ and
verification/, their files lay in lib/ and apps/; they count as what they became.
"""

import argparse
import io
import re
import subprocess
import tarfile
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
AREAS = {
    "tests": r"tests/|.*/tests/|conftest\.py",
    "kernels": r"lib/kernels/",
    "lib": r"lib/",
    "apps, C++": r"apps/.*\.[hc]pp",
    "apps": r"apps/",
    "studies": r"studies/",
    "verification": r"verification/",
    "scripts": r"scripts/",
}
"""Areas by patterns of paths: the first that fits."""
EARLY_AREAS = {
    "studies": r"lib/restshape/(accuracy|bench|explain|stability|validation)/"
    r"|lib/restshape/cli/(accuracy|bench\w*|explain|stability|tables|validate)\.py",
    "verification": r"apps/\w+/(?!__init__|pictures?|pieces|small_pieces|regions|derivative|sound|stage)\w+\.py",
}
"""Of commits without a folder of that name: where its files lay."""
ORDER = ("lib", "kernels", "apps", "apps, C++", "studies", "verification", "scripts", "tests")
ROOM = re.compile(r"lib/restshape/(?!live/)\w+(?:/\w+){0,2}(?=/)|lib/(?:restshape|kernels)/\w+(?=/)|lib/\w+(?=/)")
"""The rooms of lib: folders, those within them by themselves but for the live page, and files beside them."""


def main() -> int:
    """Prints both tables in Markdown; the exit code."""
    parser = argparse.ArgumentParser(description="Net lines of code by room.")
    parser.add_argument("commits", metavar="COMMIT", nargs="*", default=["HEAD"])
    commits = parser.parse_args().commits
    counted = [net_lines(sources(commit)) for commit in commits]
    print_table("area", commits, [by_area(lines) for lines in counted], ORDER)
    rooms = [by_room(lines) for lines in counted]
    print_table("room of lib", commits, rooms, sorted(set().union(*rooms)))
    return 0


def sources(commit: str) -> dict[str, str]:
    """The texts of all C++ and Python files of a commit, by path."""
    archive = subprocess.run(["git", "archive", commit], cwd=ROOT, capture_output=True, check=True).stdout
    with tarfile.open(fileobj=io.BytesIO(archive)) as files:
        chosen = [one for one in files if one.isfile() and one.name.endswith((".py", ".hpp", ".cpp"))]
        return {one.name: files.extractfile(one).read().decode("utf-8") for one in chosen}  # type: ignore[union-attr]


def net_lines(texts: dict[str, str]) -> dict[str, int]:
    """How many lines of each file are neither blank nor comments alone."""
    marks = {path: "#" if path.endswith(".py") else "//" for path in texts}
    return {
        path: sum(bool(line.strip()) and not line.strip().startswith(marks[path]) for line in text.splitlines())
        for path, text in texts.items()
    }


def by_area(lines: dict[str, int]) -> Counter[str]:
    """Net lines of each area."""
    folders = {path.partition("/")[0] for path in lines}
    early = [(area, pattern) for area, pattern in EARLY_AREAS.items() if area not in folders]
    patterns = [("tests", AREAS["tests"]), *early, *AREAS.items()]
    found: Counter[str] = Counter()
    for path, count in lines.items():
        area = next((area for area, pattern in patterns if re.match(pattern, path)), None)
        found.update({area: count} if area else {})
    return found


def by_room(lines: dict[str, int]) -> Counter[str]:
    """Net lines of each room of lib."""
    found: Counter[str] = Counter()
    for path, count in lines.items():
        if room := ROOM.match(path):
            found[f"{room[0]}/"] += count
    return found


def print_table(head: str, commits: list[str], counts: list[Counter[str]], names: tuple[str, ...] | list[str]) -> None:
    """Prints a table in Markdown: a row a name, a column a commit, and a row of sums."""
    print(f"| {' | '.join((head, *commits))} |\n|{' --- |' + ' ---: |' * len(commits)}")
    for name in names:
        print(f"| {' | '.join((name, *(f'{one[name]:,}' if one[name] else '' for one in counts)))} |")
    print(f"| all | {' | '.join(f'{one.total():,}' for one in counts)} |\n")


if __name__ == "__main__":
    raise SystemExit(main())

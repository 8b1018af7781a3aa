"""Pages of docs/ link to what is there, name files that exist, and have tables that fit."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
SOURCES = ("lib", "apps", "studies", "verification", "tests", "scripts")
CELL = 160
"""Characters in two lines of a table's cell."""


def slug(heading: str) -> str:
    """The anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")


def prose(page: Path) -> str:
    """The text of a page without its code blocks."""
    return re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)


def anchors(page: Path) -> set[str]:
    return {slug(heading) for heading in re.findall(r"^#+ (.*)$", prose(page), re.M)}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_to_files_and_headings(page):
    for link in re.findall(r"""(?:\]\(|src=")([^)"\s]+)""", prose(page)):
        if "://" in link:
            continue
        name, _, anchor = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_cells_of_tables_fit_two_lines(page):
    for line in prose(page).splitlines():
        if line.startswith("|"):
            cells = [re.sub(r"<img[^>]*>|\]\([^)]*\)", "", cell).strip() for cell in re.split(r"(?<!\\)\|", line)]
            assert max(map(len, cells)) <= CELL, line


def test_source_files_that_pages_name_exist():
    there = ["/" + path.as_posix() for folder in SOURCES for path in (ROOT / folder).rglob("*.*")]
    for page in PAGES:
        for name in re.findall(r"`([\w./]+\.(?:py|hpp))`", prose(page)):
            assert "NAME" in name or any(path.endswith("/" + name) for path in there), (page.name, name)

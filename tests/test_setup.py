"""Set-up: pins, entry points, packages, and what the repository's text may not say."""

import configparser
import json
import re
import subprocess
import tomllib
from importlib.metadata import entry_points
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def setup_cfg() -> configparser.ConfigParser:
    """The content of setup.cfg."""
    config = configparser.ConfigParser()
    config.read(ROOT / "setup.cfg")
    return config


def tracked_files() -> list[Path]:
    """Files that git tracks or would add."""
    command = ["git", "-C", str(ROOT), "ls-files", "--cached", "--others", "--exclude-standard"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        pytest.skip("not a git checkout")
    return [ROOT / name for name in done.stdout.splitlines() if (ROOT / name).is_file()]


def requirements() -> list[str]:
    """Every requirement of setup.cfg and pyproject.toml but the bare build tool `wheel`."""
    config = setup_cfg()
    words = [config["options"]["install_requires"], *config["options.extras_require"].values()]
    build = tomllib.loads((ROOT / "pyproject.toml").read_text())["build-system"]["requires"]
    return [line for text in words for line in text.split("\n") if line] + [line for line in build if line != "wheel"]


@pytest.mark.parametrize("requirement", requirements())
def test_pin_is_a_range_with_both_bounds(requirement: str) -> None:
    assert re.fullmatch(r"[\w-]+>=[\d.]+,<[\d.]+", requirement)


def test_packages_are_the_folders() -> None:
    listed = setup_cfg()["options"]["packages"].split()
    roots = {"restshape": ROOT / "lib" / "restshape"}
    roots |= {f"restshape_{name}": ROOT / name for name in ("apps", "studies", "verification")}
    found = [
        ".".join([name, *init.parent.relative_to(folder).parts])
        for name, folder in roots.items()
        for init in folder.rglob("__init__.py")
    ]
    assert sorted(listed) == sorted(found)


def test_entry_points_resolve() -> None:
    declared = setup_cfg()["options.entry_points"]
    for group, names in declared.items():
        for line in filter(None, names.split("\n")):
            name, target = (part.strip() for part in line.split("="))
            (entry,) = [e for e in entry_points(group=group, name=name) if e.value == target]
            assert entry.load() is not None


def test_licence_is_the_whole_text_of_gpl_3() -> None:
    text = (ROOT / "LICENSE").read_text()
    assert "GNU GENERAL PUBLIC LICENSE" in text and "Version 3, 29 June 2007" in text
    assert "END OF TERMS AND CONDITIONS" in text and len(text.splitlines()) > 600


def test_no_text_names_a_registry_a_path_of_a_machine_or_a_paper_that_is_not_here() -> None:
    # Put together here, so that this file does not name them either.
    hosts = ["pypi org", "pythonhosted org", "deb debian", "archive ubuntu"]
    folders = ["work main", "work shared", "tmp contract", "root ", "home "]
    papers = ["THE" + "ORY md", "DESIGN md", "STYLE md", "REFER" + "ENCES", "shared" + "/", "issue" + " #"]
    texts = [host.replace(" ", ".") for host in hosts] + ["/" + folder.replace(" ", "/") for folder in folders]
    texts += [paper.replace(" md", ".md") for paper in papers]
    forbidden = re.compile("|".join(map(re.escape, texts)))
    wrong = []
    for path in tracked_files():
        try:
            lines = path.read_text(encoding="utf-8").splitlines()
        except UnicodeDecodeError:
            continue
        wrong += [f"{path.relative_to(ROOT)}:{i}" for i, line in enumerate(lines, 1) if forbidden.search(line)]
    assert wrong == []


@pytest.mark.cli
def test_setup_names_the_missing_petsc(tmp_path: Path) -> None:
    script, absent = ROOT / "scripts" / "setup.sh", tmp_path / "absent"
    done = subprocess.run(
        ["bash", str(script)], env={"PATH": "/usr/bin:/bin", "PETSC_DIR": str(absent)}, capture_output=True, text=True
    )
    assert done.returncode == 1
    assert str(absent) in done.stderr and "try:" in done.stderr


def test_packages_of_the_page_are_pinned_by_what_they_hold_and_not_by_where_they_come_from() -> None:
    wanted = json.loads((ROOT / "package.json").read_text())["devDependencies"]
    text = (ROOT / "package-lock.json").read_text()
    locked = {name.removeprefix("node_modules/"): one for name, one in json.loads(text)["packages"].items() if name}
    assert "resolved" not in text and "://" not in text
    assert {name: locked[name]["version"] for name in wanted} == wanted
    assert all(one["integrity"].startswith("sha512-") for one in locked.values())


def test_the_built_page_is_package_data_and_never_committed() -> None:
    assert "page/dist/*" in setup_cfg()["options.package_data"]["restshape.live"].split()
    assert not [path for path in tracked_files() if "live/page/dist" in path.as_posix()]

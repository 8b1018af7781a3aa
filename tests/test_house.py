"""The library names no application."""

import re
from pathlib import Path

LIBRARY = Path(__file__).parents[1] / "lib" / "restshape"
WORDS = re.compile(r"restshape_apps|plank|furnitur|fastener|\bnails?\b", re.IGNORECASE)


def test_the_library_names_no_application_and_no_plank():
    for path in LIBRARY.rglob("*.py"):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            assert not WORDS.search(line), f"{path}:{number}: {line}"

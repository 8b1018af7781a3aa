"""Every shipped script is replayed whole, and its frames end as they did when its demonstration was looked at."""

import json

import pytest
from shipped_scripts import COARSE, ROOT, TABLE, counted, expected, shipped_scripts, status


@pytest.mark.slow
@pytest.mark.parametrize("script", shipped_scripts(), ids=lambda path: f"{path.parts[-3]}-{path.stem}")
def test_a_shipped_script_ends_as_committed(script, tmp_path, command):
    counts = counted(script, tmp_path, lambda *words: command(*words).returncode, COARSE.get(script.stem))
    assert counts == expected(script), "if this is right: python tests/shipped_scripts.py --write"


def test_no_demonstration_loses_frames():
    """Converged frames alone, but where a script shows a load that no equilibrium bears."""
    tables = sorted((ROOT / "apps").glob(f"*/{TABLE}"))
    lost = {
        f"{path.parts[-3]}/{script}": {how: n for how, n in counts.items() if not how.startswith("solved")}
        for path in tables
        for script, counts in json.loads(path.read_text(encoding="utf-8")).items()
    }
    assert {script: counts for script, counts in lost.items() if counts} == {"solid/uniaxial": {"refused": 1}}


def test_tables_name_scripts_that_there_are():
    for path in sorted((ROOT / "apps").glob(f"*/{TABLE}")):
        table = json.loads(path.read_text(encoding="utf-8"))
        assert sorted(table) == sorted(script.stem for script in (path.parents[1] / "edits").glob("*.jsonl"))


def test_a_status_is_the_worst_that_a_frame_says():
    assert status({"refused": "too thin", "converged": "1"}) == "refused"
    assert status({"refused": "", "converged": "0", "constraint_status": ""}) == "not converged"
    assert status({"refused": "", "constraint_status": "fails"}) == "solved, fails"
    assert status({"refused": ""}) == "solved"

"""Every shipped script is replayed whole, and its frames end as they did when its demonstration was looked at."""

import json

import pytest
from shipped_scripts import (
    ROOT,
    TABLE,
    WEEKLY,
    counted,
    daily_size,
    expected,
    large_jumps,
    shipped_scripts,
    status,
    summary_of,
)


def alike(counts: dict[str, int], pinned: dict[str, int]) -> bool:
    """Whether as many frames end in each way; at limits 2 % may end otherwise, where rounding has made another mesh."""
    most = {how: 0.02 * sum(pinned.values()) if how.startswith("solved,") else 0 for how in (*counts, *pinned)}
    together = sum(counts.values()) == sum(pinned.values())
    return together and all(abs(counts.get(how, 0) - pinned.get(how, 0)) <= n for how, n in most.items())


@pytest.mark.slow
@pytest.mark.parametrize(
    "script",
    [one for one in shipped_scripts() if one.stem not in WEEKLY],
    ids=lambda path: f"{path.parts[-3]}-{path.stem}",
)
def test_a_shipped_script_ends_as_committed(script, tmp_path, command):
    counts = counted(script, tmp_path, lambda *words: command(*words).returncode, daily_size(script))
    assert alike(counts, expected(script)), f"{counts}; if this is right: python tests/shipped_scripts.py --write"
    if daily_size(script) is None:
        assert not large_jumps(summary_of(script, tmp_path))


def test_large_jumps_are_seen(tmp_path):
    jumps = {"sag": {"share": 0.0051}, "force": {"share": None}, "work": {"share": 0.0049}, "peak": {"share": 0.06}}
    (tmp_path / "a.json").write_text(json.dumps({"jumps": jumps, "singular": {"peak": 0.54}}))
    assert large_jumps(tmp_path / "a.json") == {"sag": 0.0051}


def test_what_differs_from_what_is_pinned_is_seen():
    pinned = {"solved, holds": 98, "solved, fails": 2}
    assert alike({"solved, holds": 97, "solved, fails": 2, "solved, uncertain": 1}, pinned)
    assert not alike({"solved, holds": 93, "solved, fails": 7}, pinned)
    assert not alike({"solved, holds": 97, "solved, fails": 2, "refused": 1}, pinned)
    assert not alike({"solved, holds": 97, "solved, fails": 2}, pinned)


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

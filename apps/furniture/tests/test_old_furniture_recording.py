"""A recording of furniture that version 0.1 has written opens."""

import json

import numpy as np
import pytest
from furniture_scenes import BENCH, write_bench
from old_recordings import make_old

from restshape.cli.main import main
from restshape.replay.recording.recording import Recording
from restshape.report.recorded_quantities import limits_of

QUANTITIES = """
[effects.bending]
[quantities]
most = { utilisation = "largest", max = 0.9 }
sag = { deflection = true, max = "3 mm" }
steady = { stability_margin = true, min = 0.1 }
"""
KINDS = {"utilisation": "use", "deflection": "sag", "stability_margin": "margin"}
LIMITS = {"most": {"max": 0.9}, "sag": {"max": 3e-3}, "steady": {"min": 0.1}}


def reported(path):
    """The report for programs: tables of quantities, limits and frames."""
    data = path.with_suffix(".json")
    assert main(["report", str(path), "--animation", "none", "--json", str(data)]) == 0
    return json.loads(data.read_text())


@pytest.mark.slow
def test_an_old_recording_is_read_by_the_names_of_today(tmp_path, capsys):
    path = tmp_path / "bench.vtkhdf"
    assert main(["replay", str(write_bench(tmp_path, BENCH + QUANTITIES)), "--out", str(path)]) == 0
    with Recording(path) as one:
        table, fields = one.table, list(one.fields)
        assert limits_of(one) == LIMITS
    today = reported(path)
    make_old(path, **KINDS)
    with Recording(path) as old:
        expected = {"utilisation": "use", "stability_margin": "margin", "unbalanced_load": "missing"}
        assert expected.items() <= old.old_names.items() and list(old.fields) == fields
        assert limits_of(old) == LIMITS
        for name, values in table.items():
            np.testing.assert_array_equal(old.table[name], values)
    capsys.readouterr()
    assert reported(path) == today
    assert "note: columns of an earlier version" in capsys.readouterr().out

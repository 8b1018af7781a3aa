"""What a search for modes spends where some of them are not wanted; the hard cases are in `test_hard_cases`."""

from itertools import islice

import pytest
from modal import EDITS, replay


@pytest.mark.slow
def test_spare_modes_that_have_not_converged_draw_no_factor_up():
    """Where a search ends with far values among its spare ones, the next factor would lie above hundreds of modes."""
    solid = ["effects.modal.modes=5", "mesh.order=2", "mesh.layers=1", 'mesh.size="10 mm"']
    made = replay("bar_200.toml", EDITS / "bar_200.jsonl", solid)
    rows = list(islice(made.frames(), 30))
    assert not any(row["refused"] for row in rows)
    assert max(row["iterations"] for row in rows[1:]) < 60 and max(row["missed_modes"] for row in rows) < 3

"""The rows of table 5.1 on edits: each has a time, of meshes as large as it says."""

import pytest
from restshape_verification.couture import thesis_edits


@pytest.mark.slow
def test_rows_on_edits(monkeypatch):
    monkeypatch.setattr(thesis_edits, "MESHES", {("80 mm", 1): "{} nodes", ("30 mm", 2): "{} nodes, fine {}"})
    monkeypatch.setattr(thesis_edits, "DERIVED", "80 mm")
    monkeypatch.setattr(thesis_edits, "TURNS", 3)
    rows = thesis_edits.edit_rows()
    assert [row["quantity"].split(",")[0].split(":")[0] for row in rows] == [
        *["remeshing"] * 2,
        *["GMLS interpolation"] * 2,
        "sensitivity analysis",
    ]
    assert all(row["timing"] and row["unit"] == "ms" and row["ours"] > 0.0 and row["table"] == "5.1" for row in rows)
    nodes = [int(words.split()[0]) for words in (rows[0]["row"], rows[1]["row"])]
    assert 60 < nodes[0] < 200 and int(rows[1]["row"].split()[-1]) > 3 * nodes[1]

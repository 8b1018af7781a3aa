"""Newton's iterations from three starts, on a block of rubber whose hole is dragged."""

from designs import LOADS, RUBBER
from restshape_studies.bench.starts import PARTS, STARTS, table_rows
from small_scenes import CLAMPED, HEAD, HOLE, across, block, drag, meshed, write_scene, write_script


def test_the_prediction_is_the_best_start(tmp_path):
    text = HEAD + block(1.5, 1.0) + HOLE + RUBBER.format(nu=0.3) + "[effects.large_deformation]\n" + CLAMPED
    scene = write_scene(tmp_path, text + LOADS["traction"] + meshed(0.15))
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.65, 0.55), 6)))
    rows = table_rows(scene, script)
    assert len(rows) == len(PARTS) * len(STARTS)
    for cold, last, predicted in zip(*[iter(row["ours"] for row in rows)] * 3):
        assert predicted <= last <= cold and predicted < cold
    # Near by, one step does: the prediction is off by the square of the way, and Newton's step squares that again.
    assert rows[2]["ours"] <= 1

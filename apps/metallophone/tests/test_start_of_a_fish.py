"""What the first frames of a body that vibrates wait for."""

import subprocess
import sys
from pathlib import Path

import pytest

SCENE = Path(__file__).parents[1] / "scenes" / "fish.toml"
PROGRAM = """
import sys, restshape, restshape.live.live_session
from restshape.live.live_simulation import LiveSimulation
live = LiveSimulation(restshape.load({scene!r}))
for event in [{{"do": "press", "on": "fork"}}, {{"do": "drag", "to": [0.131, 0.001]}}]:
    live.begin(event)
    while live.go_on():
        assert not live.sim.frame.refused
live.close()
print({{"scipy"}} & set(sys.modules))
"""


@pytest.mark.cli
def test_a_body_whose_modes_are_dragged_loads_no_scipy():
    """SciPy's optimisers take 0.14 s to load, its sparse matrices 0.07 s: before the first answer is on screen."""
    program = PROGRAM.format(scene=str(SCENE))
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"

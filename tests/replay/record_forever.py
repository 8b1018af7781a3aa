"""Records frames until it is killed; prints what it hands over: its recorder's process, then one line a frame.

usage: record_forever.py PATH [SECONDS BETWEEN FRAMES]
"""

import sys
import time

import numpy as np

from restshape.replay.recording.recorder import Recorder


def main(path: str, pause: float) -> None:
    """Never returns by itself."""
    rng = np.random.default_rng(1)
    recorder = Recorder.start(path, {"seed": 1}, {"index": "i4", "handed": "f8", "note": "str"})
    print(recorder.process_id, flush=True)
    cells = np.array([[i, i + 1, i + 2] for i in range(998)], dtype=np.int32)
    index = 0
    while True:
        if index % 5 == 0:
            cells = np.roll(cells, 1, axis=0)
            recorder.topology(cells)
        points, values = rng.random((1000, 2)), rng.random(len(cells))
        row = {"index": index, "handed": time.monotonic(), "note": f"frame {index}"}
        recorder.frame(index / 60, points, {"displacement": points * 2}, {"von_mises": values}, row)
        print(index, row["handed"], flush=True)
        index += 1
        time.sleep(pause)


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 0.001)

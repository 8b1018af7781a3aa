"""What live sessions and hands of Python cost beside a replay of the same script, in the process that simulates."""

from __future__ import annotations

import socket
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from statistics import mean
from typing import Any

import restshape
from restshape.live.answering import Worker
from restshape.live.growing_script import GrowingScript
from restshape.live.link import Link
from restshape.live.live_recording import LiveRecording
from restshape.live.live_simulation import USUAL, LiveSimulation
from restshape.replay.request import Request

REPEAT = 9
BUFFER = 1 << 23
"""Bytes that a socket holds, more than a frame has."""
Times = list[float]


def measure(request: Request, repeat: int = REPEAT) -> dict[str, Any]:
    """Processor time of a drag's frames three ways, which take turns.

    Args:
        request: scene, and script: a press, then drags; repeat: turns, of which each frame's least counts.

    Returns:
        Means of frames [ms]: "replay", and what "live" and "hand" take more, and of live the frames alone; "frames".
    """
    scene, script = request.scene, request.script
    assert script is not None
    ways: dict[str, Callable[[], Times]] = {
        "replay": lambda: _replayed(scene, script),
        "hand": lambda: _by_hand(scene, script),
    }
    turns: dict[str, list[Times]] = {name: [] for name in (*ways, "live", "frames")}
    for _ in range(repeat):
        for name, way in ways.items():
            turns[name].append(way())
        # Watching the frames takes time of its own.
        turns["live"].append(_live(script, LiveSimulation(scene, USUAL))[0])
        turns["frames"].append(_live(script, _Timed(scene, USUAL))[1])
    least = {name: [1e3 * min(times) for times in zip(*all_)] for name, all_ in turns.items()}
    more = {name: mean(a - b for a, b in zip(least[name], least["replay"])) for name in ("hand", "live", "frames")}
    found = {"replay_ms": mean(least["replay"]), "frames": len(least["replay"])}
    return found | {f"{name}_more_ms": one for name, one in more.items()}


def _timed(steps: Iterator[object]) -> Times:
    """Seconds of the processor of each step but the first."""
    next(steps)
    times, before = [], time.thread_time()
    for _ in steps:
        times.append(time.thread_time() - before)
        before = time.thread_time()
    return times


def _own_time(step: Callable[[], object]) -> float:
    """Seconds of the processor of a step."""
    before = time.thread_time()
    step()
    return time.thread_time() - before


def _written(script: restshape.Script) -> list[dict[str, Any]]:
    # A hand gives no times.
    return [event.model_dump(mode="json", by_alias=True, exclude_unset=True, exclude={"t"}) for event in script.events]


def _replayed(scene: restshape.Scene, script: restshape.Script) -> Times:
    with closing(restshape.replay(scene, script)) as run:
        next(run)
        return _timed(run)


def _by_hand(scene: restshape.Scene, script: restshape.Script) -> Times:
    press, *drags = _written(script)
    with restshape.open(scene) as sim:

        def steps() -> Iterator[object]:
            with sim.press(press["on"], at=press["at"]) as hand:
                yield hand.frame
                for drag in drags:
                    yield hand.to(*drag["to"])

        return _timed(steps())


class _Timed(LiveSimulation):
    """Notes how long the frames themselves take: their answers, without what pages see of them."""

    took = 0.0

    def go_on(self) -> bool:
        before = time.thread_time()
        found = super().go_on()
        self.took += time.thread_time() - before
        return found


def _live(script: restshape.Script, live: LiveSimulation) -> tuple[Times, Times]:
    """Of each frame of a live session all, and its answer alone where that is watched."""
    here, there = socket.socketpair()
    for end in (here, there):
        end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER)
    page = Link(here)
    worker = Worker(Link(there), live, GrowingScript(None), LiveRecording(None))
    worker.start()

    def step(number: int, event: dict[str, Any]) -> tuple[float, float]:
        # What the server and the page do before and after is not of this process.
        page.send({"type": "event", "id": 1 + number, "event": event, "latest": event["do"] == "drag"})
        before = getattr(live, "took", 0.0)
        took = _own_time(worker.next)
        page.waiting()
        return took, getattr(live, "took", 0.0) - before

    try:
        whole, alone = zip(*[step(*one) for one in enumerate(_written(script))][1:])
        return [*whole], [*alone]
    finally:
        live.close()
        here.close()
        there.close()

"""A process is silent for too long by its own time: what it computes and waits for, not what others take from it."""

import os
import subprocess
import time

import pytest
from restshape_studies.stability import watched
from restshape_studies.stability.watched import Silence, processor_time, queue_time

BUSY = ["sh", "-c", "while :; do :; done"]


@pytest.fixture
def start():
    """Starts processes, all on one processor, and ends them."""
    processes = []

    def begin(words):
        one = min(os.sched_getaffinity(0))
        processes.append(subprocess.Popen(words, preexec_fn=lambda: os.sched_setaffinity(0, {one})))
        return processes[-1].pid

    yield begin
    for process in processes:
        process.kill()
        process.wait()


def until(condition, seconds=30.0):
    """Whether a condition comes to hold."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


@pytest.mark.slow
def test_a_process_that_waits_or_computes_is_silent_for_too_long(start):
    begin = time.monotonic()
    waiting = Silence(start(["sleep", "60"]), 0.3)
    assert not waiting.over()
    assert until(waiting.over) and time.monotonic() - begin > 0.3
    busy = start(BUSY)
    computing = Silence(busy, 0.3)
    assert until(computing.over) and processor_time(busy) > 0.25


@pytest.mark.slow
@pytest.mark.skipif(queue_time(os.getpid()) is None, reason="the system does not report queues")
def test_a_process_that_others_keep_from_the_processor_is_not(start, monkeypatch):
    """Three share one processor: each computes for about a third of the time, and waits for it the rest."""
    first, *_ = (start(BUSY) for _ in range(3))
    used, queued, begin = processor_time(first), queue_time(first), time.monotonic()
    silence = Silence(first, 60.0)
    assert until(lambda: queue_time(first) - queued > 0.6)
    took = time.monotonic() - begin
    assert processor_time(first) - used < 0.8 * took
    # Of the time that it has not computed, hardly any was waiting for something else.
    assert took - (processor_time(first) - used) - (queue_time(first) - queued) < 0.3 * took
    monkeypatch.setattr(silence, "limit", 0.5 * took)
    assert not silence.over() or processor_time(first) - used > 0.5 * took
    monkeypatch.setattr(watched, "queue_time", lambda process: 0.0)
    assert silence.over()


def test_without_word_of_queues_a_process_may_wait_longer(start, monkeypatch):
    monkeypatch.setattr(watched, "queue_time", lambda process: None)
    silence = Silence(start(["sleep", "60"]), 0.05)
    time.sleep(0.2)
    assert not silence.over() and until(silence.over)

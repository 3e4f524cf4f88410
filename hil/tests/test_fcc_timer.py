"""The kernel's timers from Python."""

from __future__ import annotations

import itertools
import signal
import threading
import time

import fcc
import pytest

KINDS = ["timerfd", "posix", "nanosleep"]


@pytest.mark.parametrize("kind", KINDS)
def test_no_wake_up_is_early_and_each_deadline_is_counted(kind: str) -> None:
    timer = fcc.Timer(0.005, kind)
    began_ns = time.monotonic_ns()
    served = list(itertools.islice(timer, 20))
    assert time.monotonic_ns() - began_ns >= 100_000_000
    number = 0
    for expiry in served:
        assert expiry.lateness_ns >= 0
        number += 1 + expiry.missed
        assert expiry.number == number
        assert expiry.scheduled_ns - served[0].scheduled_ns == 5_000_000 * (
            number - served[0].number
        )
    summary = timer.summary()
    assert summary.ticks == 20
    assert summary.missed == sum(expiry.missed for expiry in served)
    assert summary.period_mean_ms == pytest.approx(5.0 * (number - served[0].number) / 19, rel=0.5)
    assert (timer.kind, timer.period_s) == (kind, 0.005)


@pytest.mark.parametrize("kind", KINDS)
def test_missed_deadlines_are_reported(kind: str) -> None:
    timer = fcc.Timer(0.01, kind)
    timer.start()
    first = timer.wait()
    time.sleep(0.045)
    late = timer.wait()
    assert late.missed >= 3
    assert late.number == first.number + late.missed + 1


def test_other_threads_run_while_it_waits() -> None:
    timer = fcc.Timer(0.3)
    timer.start()
    waited = threading.Event()

    def wait() -> None:
        timer.wait()
        waited.set()

    thread = threading.Thread(target=wait)
    thread.start()
    counted = 0
    while not waited.is_set():
        counted += 1
        time.sleep(0.001)
    thread.join()
    assert counted > 20


def test_one_thread_waits_at_a_time() -> None:
    timer = fcc.Timer(1.0)
    timer.start()
    refused: list[str] = []

    def wait() -> None:
        try:
            timer.wait()
        except fcc.TimerError as error:
            refused.append(str(error))

    # A thread that is held up for a second finds the other one gone.
    for _ in range(10):
        threads = [threading.Thread(target=wait) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        if refused:
            break
    assert len(refused) == 1
    assert "another thread waits" in refused[0]


def test_a_timer_that_was_not_started_raises_an_error() -> None:
    with pytest.raises(fcc.TimerError, match="was not started"):
        fcc.Timer(0.01).wait()


def test_a_long_wait_can_be_interrupted() -> None:
    """As Ctrl-C does; the deadline is minutes away."""
    timer = fcc.Timer(600.0)
    timer.start()
    signal.setitimer(signal.ITIMER_REAL, 0.2)
    previous = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            timer.wait()
    finally:
        signal.signal(signal.SIGALRM, previous)

"""Stops: what begins is stopped, whenever the stop comes."""

import random
import threading
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import pumpmodel as pm


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[pm.Bench]:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        yield bench


def stopped_at(bench: pm.Bench, wait_s: float, doses: Any) -> tuple[str | None, list[pm.Dose | str]]:
    """Run `doses` in a thread, and stop it `wait_s` after it has begun. Return what was stopped and made."""
    begun, made = threading.Event(), list[pm.Dose | str]()

    def work() -> None:
        begun.set()
        try:
            made.extend(doses())
        except pm.StoppedError as error:
            made.append(str(error))

    thread = threading.Thread(target=work)
    thread.start()
    begun.wait()
    time.sleep(wait_s)
    while (stopped := bench.stop()) is None and thread.is_alive():
        pass
    thread.join(30)
    assert not thread.is_alive()
    return stopped, made


def test_no_stop_of_a_dose_that_is_just_starting_is_missed(bench: pm.Bench) -> None:
    dice = random.Random(1)
    before_motion = 0
    for _ in range(150):
        # It takes seconds, if nothing stops it.
        stopped, made = stopped_at(
            bench, dice.uniform(0, 4e-3), lambda: [bench.dose("9000mL", rate="20mL/s")]
        )
        assert stopped == "dose"
        [dose] = made
        if isinstance(dose, str):
            assert dose.startswith("dose was stopped before its motion")
            assert bench.status().unfinished is None
            before_motion += 1
        else:
            assert not dose.completed
            # A dose that was stopped before its first step leaves nothing.
            assert (bench.status().unfinished is None) == (dose.steps_made == 0)
            if dose.steps_made:
                bench.discard()
    assert before_motion > 0
    assert bench.dose("1mL").completed, "a stop does not reach a call that begins later"


def test_no_stop_between_the_doses_of_a_batch_is_missed(bench: pm.Bench) -> None:
    dice = random.Random(2)
    for _ in range(50):
        every_s = dice.choice([None, 0.03])
        doses = bench.batch("0.2mL", 1_000_000, every_s=every_s, missed="now")
        stopped, made = stopped_at(bench, dice.uniform(0, 0.05), doses.__iter__)
        assert stopped == "batch"
        assert all(isinstance(dose, pm.Dose) and dose.completed for dose in made[:-1]), "none follows"
        if bench.status().unfinished is not None:
            with warnings.catch_warnings():
                # The carry of the batch is forgotten.
                warnings.simplefilter("ignore", UserWarning)
                bench.discard()


def test_a_stop_from_the_body_of_a_batch_ends_it_and_its_wait(bench: pm.Bench) -> None:
    made = 0
    for _ in bench.batch("1mL", 10, every_s=3600):
        made += 1
        assert bench.stop() == "batch"
    assert made == 1
    assert bench.stop() is None


def test_a_stop_where_nothing_is_under_way_stops_nothing(bench: pm.Bench) -> None:
    assert bench.stop() is None
    assert bench.dose("1mL").completed
    assert bench.stop() is None


def test_a_stop_reaches_the_calls_that_wait_for_their_turn(bench: pm.Bench) -> None:
    moving, made = threading.Event(), list[str]()

    def wait_and_prime() -> None:
        with pytest.raises(pm.StoppedError, match="prime was stopped before its motion") as raised:
            bench.prime("1mL")
        made.append(str(raised.value))

    def first() -> None:
        dose = bench.dose("9000mL", rate="20mL/s", progress=lambda *_: moving.set())
        assert not dose.completed

    threads = [threading.Thread(target=first), threading.Thread(target=wait_and_prime)]
    threads[0].start()
    moving.wait()
    threads[1].start()
    time.sleep(0.2)
    assert bench.stop() == "dose, prime"
    for thread in threads:
        thread.join(30)
    assert len(made) == 1


@pytest.mark.parametrize(
    ("progress", "message"),
    [
        (3, "must be a function of the steps made and the steps planned, not int"),
        (lambda made: None, r"takes \(made\) \(too many positional arguments\)"),
        (lambda *, made, planned: None, "is called with 2 arguments"),
    ],
)
def test_a_progress_that_cannot_be_called_is_refused_before_motion(
    bench: pm.Bench, progress: Any, message: str
) -> None:
    for call in (bench.dose, bench.prime, bench.purge):
        with pytest.raises(TypeError, match=message):
            call("1mL", progress=progress)
    with pytest.raises(TypeError, match=message):
        bench.calibration_run(speed_rpm=60, pitches=1, progress=progress)
    with pytest.raises(TypeError, match=message):
        bench.run(duration="1s", progress=progress)
    assert bench.status().recorded is False

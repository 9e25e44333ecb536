"""Benches with a board: a few answers of grbl's at the end of a pseudo-terminal, and no motor."""

import os
import pty
import threading
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest

import pumpmodel as pm

SETTINGS = {1: "255", 10: "1", 13: "0", 20: "0", 22: "0"} | {
    number + axis: value
    for number, value in {100: "250.000", 110: "6000.000", 120: "400.000", 130: "200.000"}.items()
    for axis in range(3)
}


class Board:
    """A board at rest whose counter can be moved."""

    def __init__(self) -> None:
        self.place_mm = 0.0
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.port = os.ttyname(self.slave)
        self._thread = threading.Thread(target=self._talk, daemon=True)
        self._thread.start()

    def _talk(self) -> None:
        line = b""
        while True:
            byte = os.read(self.master, 1)
            if byte == b"q":
                return
            if byte == b"?":
                self._say(
                    f"<{self._state()}|MPos:{self.place_mm:.3f},0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>"
                )
            elif byte == b"\x85":
                self._cancel()
            elif byte == b"\n":
                for answer in self._answers(line.decode()):
                    self._say(answer)
                line = b""
            elif byte < b"\x80":
                line += byte

    def _state(self) -> str:
        return "Idle"

    def _cancel(self) -> None:
        """Cancel a jog. This board makes none."""

    def _answers(self, line: str) -> list[str]:
        known = {
            "$$": [f"${number}={value}" for number, value in sorted(SETTINGS.items())],
            "$I": ["[VER:1.1h.20190830:]", "[OPT:V,15,128]"],
            "$G": ["[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"],
        }
        return [*known.get(line, []), "ok"]

    def _say(self, line: str) -> None:
        os.write(self.master, f"{line}\r\n".encode())

    def close(self) -> None:
        os.write(self.slave, b"q")
        self._thread.join()
        os.close(self.slave)
        os.close(self.master)


@pytest.fixture
def board() -> Iterator[Board]:
    board = Board()
    yield board
    board.close()


def open_bench(board: Board, folder: Path) -> pm.Bench:
    return pm.Bench.open("three-roller", driver="grbl", port=board.port, state_dir=folder, confirm_pump=True)


def test_a_built_in_pump_moves_no_motor_until_somebody_has_confirmed_it(board: Board, tmp_path: Path) -> None:
    with (
        pm.Bench.open("three-roller", driver="grbl", port=board.port, state_dir=tmp_path) as bench,
        pytest.raises(pm.PumpError, match=r"12800 steps per revolution.*confirm_pump=True"),
    ):
        bench.dose("1mL")
    with pytest.raises(ValueError, match="confirm_pump is given, but the motor is simulated"):
        pm.Bench.open("three-roller", state_dir=tmp_path, confirm_pump=True)


def test_what_befell_the_rotor_is_a_warning_where_its_dose_is_refused(board: Board, tmp_path: Path) -> None:
    with open_bench(board, tmp_path) as bench:
        assert bench.home_set(0.5).angle_known

    def single(bench: pm.Bench) -> Iterator[pm.Dose]:
        yield bench.dose("1mL", rate="1L/s")

    def batch(bench: pm.Bench) -> Iterator[pm.Dose]:
        return bench.batch("1mL", 2, rate="1L/s")

    for place_mm, doses in ((5.0, single), (9.0, batch)):
        board.place_mm = place_mm
        with (
            open_bench(board, tmp_path) as bench,
            pytest.warns(UserWarning, match="something else has moved it") as warned,
            pytest.raises(pm.PlanError, match="mL/s"),
        ):
            next(doses(bench))
        assert [warning.filename for warning in warned] == [__file__]
        with open_bench(board, tmp_path) as bench:
            assert bench.home_set(0.5).angle_known


def test_a_warning_that_is_an_exception_does_not_take_the_place_of_the_failure(
    board: Board, tmp_path: Path
) -> None:
    with open_bench(board, tmp_path) as bench:
        bench.home_set(0.5)
    board.place_mm = 5.0
    # Warnings are exceptions in these tests.
    with open_bench(board, tmp_path) as bench, pytest.raises(pm.PlanError) as refused:
        bench.dose("1mL", rate="1L/s")
    assert isinstance(refused.value.__cause__, UserWarning)

"""Balances that end doses: at a pseudo-terminal, and read by a command or a function."""

import math
import os
import pty
import re
import select
import signal
import threading
import time
import tty
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from test_boards import Board, open_bench

import pumpmodel as pm

#: Volume of 1 g on a balance in air, mL: water at 25 degC and air at 85.7 kPa (OIML R 111-1, C.4).
Z_ML_G = 1.003_84
#: True volume over the model's of the pump whose fluid is weighed.
KAPPA = 1.04


class SerialBalance:
    """A balance at a pseudo-terminal that shows a mass with two decimals."""

    def __init__(self, mass_g: Callable[[], float], *, sbi: bool = False) -> None:
        self.mass_g, self.sbi = mass_g, sbi
        self.garbage = self.silent = False
        self.master, slave = pty.openpty()
        tty.setraw(slave)
        # The open end keeps the line alive between two users.
        self._slave = slave
        self.port = os.ttyname(slave)
        self._over = False
        self._thread = threading.Thread(target=self._talk, daemon=True)
        self._thread.start()

    def _talk(self) -> None:
        asked = b""
        while not self._over:
            if not select.select([self.master], [], [], 0.02)[0]:
                continue
            asked += os.read(self.master, 64)
            while b"\n" in asked:
                question, asked = asked.split(b"\n", 1)
                if not self.silent:
                    os.write(self.master, self._answer(question))

    def _answer(self, question: bytes) -> bytes:
        if self.garbage:
            return b"S S  12,3,4 oz\r\n"
        mass_g = self.mass_g()
        if self.sbi:
            known = {b"\x1bP\r": f"+ {mass_g:9.2f} g  \r\n"}
        else:
            known = {b"SI\r": f"S S {mass_g:10.2f} g\r\n"}
        return known.get(question, "ES\r\n").encode()

    def close(self) -> None:
        self._over = True
        self._thread.join()
        os.close(self._slave)
        os.close(self.master)


def on_record(folder: Path) -> Callable[[], float]:
    """Return what stands on the balance: a vessel of 50 g, and what the pump has delivered by its record."""
    bench = pm.Bench.open("three-roller", state_dir=folder)
    return lambda: 50 + bench.status().wear.volume_ml * KAPPA / Z_ML_G


@pytest.fixture
def serial(tmp_path: Path) -> Iterator[SerialBalance]:
    balance = SerialBalance(on_record(tmp_path))
    yield balance
    balance.close()


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[pm.Bench]:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        yield bench


def check_weighed(dose: pm.Dose, bench: pm.Bench) -> None:
    weighed = dose.by_weight
    assert weighed is not None
    assert dose.completed
    assert dose.volume_basis == "weighed"
    assert weighed.target_g == pytest.approx(10)
    assert weighed.mass_g == pytest.approx(10, abs=0.035)
    assert weighed.digit_g == pytest.approx(0.01)
    assert dose.delivered_ml == pytest.approx(weighed.mass_g * Z_ML_G, abs=1e-3)
    assert weighed.turned_ml == pytest.approx(10 * Z_ML_G / KAPPA, abs=0.05)
    assert (dose.carry_ml, dose.carry_in_ml) == (0, 0)
    assert {share.source for share in dose.uncertainty_budget} >= {"balance", "density"}
    status = bench.status()
    assert status.carry_ml == 0
    assert status.unfinished is None
    last = status.last_by_weight
    assert last is not None
    assert (last.target_g, last.mass_g, last.turned_ml) == (
        weighed.target_g,
        weighed.mass_g,
        weighed.turned_ml,
    )


@pytest.mark.parametrize("sbi", [False, True])
def test_a_balance_at_a_port_ends_a_dose(bench: pm.Bench, tmp_path: Path, sbi: bool) -> None:
    serial = SerialBalance(on_record(tmp_path), sbi=sbi)
    with pm.Balance.open(serial.port, protocol="sbi" if sbi else "mt-sics") as balance:
        assert serial.port in repr(balance)
        dose = bench.dose("10g", until_scale=balance)
        check_weighed(dose, bench)
        assert pm.Dose.from_dict(dose.to_dict()) == dose
        # The balance reads for calibrations too, with its digits.
        assert balance.read() == f"{serial.mass_g():.2f} g"
    with pytest.raises(pm.PumpError, match="closed"):
        balance.read()
    serial.close()
    # A dose by volume has no weighing.
    assert bench.dose("1mL").by_weight is None
    assert bench.status().last_by_weight is None


def test_a_function_and_a_command_serve_as_balances(bench: pm.Bench, tmp_path: Path) -> None:
    mass_g = on_record(tmp_path)
    calls: list[int] = []
    balance = pm.Balance.function(lambda: f"{mass_g():.2f} g")
    check_weighed(bench.dose("10g", until_scale=balance, progress=lambda made, _: calls.append(made)), bench)
    assert calls
    assert calls == sorted(calls)
    journal = Path(bench.folder) / "journal.jsonl"
    script = (
        f"v=$(grep -o '\"volume_ml\":[0-9.e-]*' '{journal}' | tail -1 | cut -d: -f2); "
        f'awk "BEGIN {{ printf \\"%.2f g\\\\n\\", 50 + $v * {KAPPA} / {Z_ML_G} }}"'
    )
    check_weighed(bench.dose("10g", until_scale=pm.Balance.command(script), scale="0.02g"), bench)


def test_a_stated_uncertainty_of_the_balance_is_that_of_the_dose(bench: pm.Bench, tmp_path: Path) -> None:
    mass_g = on_record(tmp_path)
    balance = pm.Balance.function(lambda: f"{mass_g():.2f} g")
    dose = bench.dose("10g", until_scale=balance, scale="0.1g")
    (share,) = [share for share in dose.uncertainty_budget if share.source == "balance"]
    # Two readings of 0.1 g each.
    assert share.standard_ml == pytest.approx(2**0.5 * 0.1 * Z_ML_G, rel=1e-3)


def test_a_balance_that_cannot_be_read_moves_nothing(bench: pm.Bench, serial: SerialBalance) -> None:
    with pm.Balance.open(serial.port, wait="1s") as balance:
        serial.garbage = True
        with pytest.raises(pm.BalanceError, match="which is no mass") as refused:
            bench.dose("10g", until_scale=balance)
        assert (refused.value.turned_ml, refused.value.weighed_g) == (None, None)
        serial.silent = True
        with pytest.raises(pm.BalanceError, match="said nothing within 1 s"):
            bench.dose("10g", until_scale=balance)
        with pytest.raises(pm.BalanceError, match="said nothing within 1 s"):
            balance.read()

    def broken() -> str:
        raise RuntimeError("no cable")

    with pytest.raises(pm.BalanceError, match="RuntimeError: no cable"):
        bench.dose("10g", until_scale=pm.Balance.function(broken))
    with pytest.raises(pm.BalanceError, match="/dev/no-balance"):
        pm.Balance.open("/dev/no-balance")
    assert bench.status().wear.volume_ml == 0
    assert bench.status().unfinished is None


def test_a_dose_that_was_stopped_is_finished_by_its_balance(bench: pm.Bench, tmp_path: Path) -> None:
    mass_g = on_record(tmp_path)
    tare_g = mass_g()
    failures: list[float] = []

    def fails_once() -> str:
        # The first stretch is weighed by a balance that shows garbage.
        if mass_g() > tare_g + 1 and not failures:
            failures.append(mass_g())
            return "12,3,4 g"
        return f"{mass_g():.2f} g"

    balance = pm.Balance.function(fails_once)
    with pytest.raises(pm.BalanceError, match="which is no mass"):
        bench.dose("10g", until_scale=balance)
    assert bench.status().unfinished is not None
    with pytest.raises(pm.UnfinishedError, match="were expected"):
        bench.resume(until_scale=pm.Balance.function(lambda: "250.00 g"))
    dose = bench.resume(until_scale=balance)
    assert dose.by_weight is not None
    assert dose.by_weight.before_ml > 1
    assert dose.by_weight.mass_g == pytest.approx(10, abs=0.06)
    assert mass_g() - tare_g == pytest.approx(10, abs=0.06)
    assert bench.status().unfinished is None


def test_a_balance_that_never_rises_leaves_the_dose_unfinished(bench: pm.Bench) -> None:
    with pytest.raises(pm.BalanceError, match="no motor moved") as fault:
        bench.dose("25g", until_scale=pm.Balance.function(lambda: "50.00 g"))
    turned_ml = fault.value.turned_ml
    assert turned_ml is not None
    assert fault.value.weighed_g == 0
    unfinished = bench.status().unfinished
    assert unfinished is not None
    assert unfinished.by_weight
    assert unfinished.target_g == pytest.approx(25)
    assert unfinished.delivered_most_ml == pytest.approx(turned_ml)
    with pytest.raises(pm.UnfinishedError):
        bench.dose("1mL")
    rest = bench.resume()
    assert rest.by_weight is None
    assert any("made by volume" in warning and "bench.discard()" in warning for warning in rest.warnings)


def test_words_that_no_dose_by_weight_takes_are_refused(bench: pm.Bench) -> None:
    balance = pm.Balance.function(lambda: "50.00 g")
    with pytest.raises(ValueError, match="max_volume is given without until_scale"):
        bench.dose("5mL", max_volume="6mL")
    with pytest.raises(TypeError, match="until_scale must be a Balance, not bool"):
        bench.dose("5mL", until_scale=True)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="scale must be text"):
        bench.dose("5mL", until_scale=balance, scale=0.01)  # type: ignore[arg-type]
    for keywords in ({"smooth": True}, {"retract": "0.1mL"}, {"within": "9s"}, {"max_volume": "4mL"}):
        with pytest.raises(pm.PlanError, match="a dose by weight"):
            bench.dose("5mL", until_scale=balance, **keywords)
    with pytest.raises(pm.PlanError, match="forward"):
        bench.dose("-5mL", until_scale=balance)
    with pytest.raises(ValueError, match="protocol is 'rs232'; allowed: 'mt-sics', 'sbi'"):
        pm.Balance.open("/dev/null", protocol="rs232")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="9600,8N1"):
        pm.Balance.open("/dev/null", line="fast")
    with pytest.raises(ValueError, match="function"):
        pm.Balance.function("50 g")  # type: ignore[arg-type]
    planned = bench.dose("5g", until_scale=balance, dry_run=True)
    assert planned.delivered_ml is None
    assert any("a balance would end this dose" in warning for warning in planned.warnings)
    assert not bench.status().recorded


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_ends_a_wait_for_a_balance(bench: pm.Bench, serial: SerialBalance) -> None:
    serial.silent = True
    with pm.Balance.open(serial.port) as balance:
        for call in (balance.read, lambda: bench.dose("5g", until_scale=balance)):
            threading.Timer(0.4, os.kill, (os.getpid(), signal.SIGINT)).start()
            began = time.monotonic()
            with pytest.raises(KeyboardInterrupt):
                call()
            assert time.monotonic() - began < 5
    assert bench.status().wear.volume_ml == 0


class MovingBoard(Board):
    """A board whose motor jogs at constant speed, without ramps."""

    def __init__(self) -> None:
        # Places to go to, mm, with their speeds, mm/s.
        self.jogs: deque[tuple[float, float]] = deque()
        self.at = time.monotonic()
        super().__init__()

    def advance(self) -> None:
        now = time.monotonic()
        left_s, self.at = now - self.at, now
        while self.jogs and left_s > 0:
            target_mm, mm_s = self.jogs[0]
            way_mm = target_mm - self.place_mm
            if abs(way_mm) > mm_s * left_s:
                self.place_mm += math.copysign(mm_s * left_s, way_mm)
                return
            self.place_mm = target_mm
            self.jogs.popleft()
            left_s -= abs(way_mm) / mm_s

    def _state(self) -> str:
        self.advance()
        return "Jog" if self.jogs else "Idle"

    def _cancel(self) -> None:
        self.advance()
        # Motors stand on whole steps.
        self.place_mm = round(self.place_mm * 250) / 250
        self.jogs.clear()

    def _answers(self, line: str) -> list[str]:
        jog = re.fullmatch(r"\$J=G53G90G21X(-?[\d.]+)F([\d.]+)", line)
        if jog is None:
            return super()._answers(line)
        self.advance()
        self.jogs.append((float(jog[1]), float(jog[2]) / 60))
        return ["ok"]


@pytest.fixture
def board() -> Iterator[MovingBoard]:
    board = MovingBoard()
    yield board
    board.close()


def model_ml(board: MovingBoard) -> float:
    """Return the model's volume of the way from 0.5 rad on, of which 12,800 steps are a revolution."""
    turned_rad = board.place_mm * 250 / 12_800 * 2 * math.pi
    pump = pm.Pump.three_roller()
    return pump.outlet_volume_ml(0.5 + turned_rad) - pump.outlet_volume_ml(0.5)


def test_a_balance_is_read_while_a_board_turns(board: MovingBoard, tmp_path: Path) -> None:
    def shown() -> str:
        return f"{50 + 1.03 * model_ml(board) / Z_ML_G:.3f} g"

    with open_bench(board, tmp_path) as bench:
        bench.home_set(0.5)
        dose = bench.dose("5g", rate="2mL/s", until_scale=pm.Balance.function(shown))
        weighed = dose.by_weight
        assert weighed is not None
        assert weighed.mass_g == pytest.approx(5, abs=0.05)
        assert float(shown()[:-2]) - 50 == pytest.approx(weighed.mass_g, abs=0.0015)
        assert dose.steps_made == round(board.place_mm * 250)
        # Readings follow a motor in real time, so the flow after a stop was reckoned with.
        assert weighed.reckoned_learned is False
        # The pump delivers 3 % more than its model.
        assert weighed.turned_ml == pytest.approx(model_ml(board), abs=2e-3)
        assert weighed.turned_ml == pytest.approx(5 * Z_ML_G / 1.03, rel=0.02)


def test_a_balance_that_fails_in_motion_stops_the_board(board: MovingBoard, tmp_path: Path) -> None:
    def shown() -> str:
        if board.place_mm > 4:
            raise OSError("the cable is off")
        return f"{50 + model_ml(board) / Z_ML_G:.3f} g"

    with open_bench(board, tmp_path) as bench:
        bench.home_set(0.5)
        with pytest.raises(pm.BalanceError, match="the cable is off") as fault:
            bench.dose("20g", rate="2mL/s", until_scale=pm.Balance.function(shown))
        time.sleep(0.3)
        assert not board.jogs
        assert 4 < board.place_mm < 12
        assert fault.value.turned_ml == pytest.approx(model_ml(board), abs=2e-3)
        unfinished = bench.status().unfinished
        assert unfinished is not None
        assert unfinished.by_weight
        assert unfinished.steps_made_most == round(board.place_mm * 250)

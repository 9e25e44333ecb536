"""Claims about the log of a bench that a clock has led astray."""

import json
import warnings
import zlib
from pathlib import Path

import pytest

import pumpmodel as pm

DAYS = ["2024-11-20T23:00:00+00:00", "2024-11-23T02:15:00+00:00", "2024-11-21T23:15:00+00:00"]


def set_times(state: Path, times: list[str]) -> None:
    """Write other times into the log, one a dose."""
    path = state / "three-roller" / "sim" / "log.jsonl"
    lines = []
    for line, time in zip(path.read_text(encoding="utf-8").splitlines(), times, strict=True):
        entry = json.loads(line)["entry"] | {"time": time}
        text = json.dumps(entry, separators=(",", ":"), ensure_ascii=False)
        lines.append(f'{{"crc32":"{zlib.crc32(text.encode()):08x}","entry":{text}}}\n')
    path.write_text("".join(lines), encoding="utf-8")


def test_doses_that_a_clock_set_back_keeps_out_of_the_list_are_warned_of(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        for _ in DAYS:
            bench.dose("1mL")
    set_times(tmp_path, DAYS)
    bench = pm.Bench.open("three-roller", state_dir=tmp_path)
    with pytest.warns(UserWarning, match="1 dose is left out: number 3, whose time is before since"):
        listed = bench.log(since="2024-11-22")
    assert [dose.number for dose in listed] == [2]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(bench.log()) == len(DAYS)


def test_a_time_that_has_not_come_yet_makes_no_later_call_warn(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        for _ in DAYS:
            bench.dose("1mL")
    set_times(tmp_path, [DAYS[0], "2999-01-01T00:00:00+00:00", DAYS[2]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        listed = pm.Bench.open("three-roller", state_dir=tmp_path).log(since="2024-11-22")
    assert [dose.number for dose in listed] == [2]

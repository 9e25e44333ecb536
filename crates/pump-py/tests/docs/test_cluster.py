import runpy
from pathlib import Path

import pytest

import pumpmodel as pm

EXAMPLE = Path(__file__).parents[2] / "examples" / "cluster_sweep.py"


def test_a_dask_cluster_of_two_processes_gives_the_same_bits(capsys: pytest.CaptureFixture[str]) -> None:
    example = runpy.run_path(str(EXAMPLE))
    spread = example["main"](None)
    assert spread.shape == (100, 1000)
    assert spread == pm.sweep(example["pumps"](), speed_rpm=example["SPEED_RPM"])
    output = capsys.readouterr()
    assert output.err.endswith("\r100% of 100,000 steady states\n")
    assert output.out.startswith("50 r/min: ")

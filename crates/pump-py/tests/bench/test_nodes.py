"""Benches with a node: the logic of the firmware at the end of a pseudo-terminal, with motors in software."""

import ast
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

import pumpmodel as pm

NODE = Path(__file__).parents[4] / "target" / "debug" / "examples" / "simulated_node"

pytestmark = [
    pytest.mark.skipif(not NODE.exists(), reason="`cargo build --example simulated_node` makes the node"),
    # What a dose warns of is not the matter here.
    pytest.mark.filterwarnings("ignore::UserWarning"),
]


class Node:
    """A simulated node in a process of its own."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [NODE, "--piped"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert self._process.stdout is not None
        self.port = self._process.stdout.readline().strip()

    def end(self) -> list[int]:
        """Switch the board off. Returns the steps of its motors."""
        out, _ = self._process.communicate(timeout=30)
        return list(ast.literal_eval(out.removesuffix(" steps\n"))) if out else []


@pytest.fixture
def node() -> Iterator[Node]:
    node = Node()
    yield node
    node.end()


def open_bench(node: Node, folder: Path) -> pm.Bench:
    return pm.Bench.open("three-roller", driver="node", port=node.port, state_dir=folder, confirm_pump=True)


def test_a_smooth_dose_at_a_node_makes_the_steps_of_its_report(tmp_path: Path) -> None:
    node = Node()
    with open_bench(node, tmp_path) as bench:
        assert bench.driver == "node"
        assert bench.home_set(0.5).angle_known
        first = bench.dose("0.5mL", rate="2mL/s", smooth=True)
    assert first.completed
    assert first.steps_made == first.steps
    # The board keeps its count, so the angle is as it was.
    with open_bench(node, tmp_path) as bench:
        second = bench.dose("0.5mL", rate="2mL/s", smooth=True)
    assert second.phase.known
    assert second.phase.half_width_deg == pytest.approx(first.phase.half_width_deg)
    assert node.end() == [first.steps + second.steps, 0, 0, 0]


def test_a_second_bench_on_the_axis_is_refused(node: Node, tmp_path: Path) -> None:
    with open_bench(node, tmp_path / "one") as holding:
        holding.home_set(0.5)
        with open_bench(node, tmp_path / "two") as refused, pytest.raises(pm.PumpError, match="the axis X"):
            refused.home_set(0.5)

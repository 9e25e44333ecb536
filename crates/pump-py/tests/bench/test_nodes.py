"""Benches with a node: the logic of the firmware at the end of a pseudo-terminal, with motors in software."""

import ast
import signal
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import pumpmodel as pm

NODE = Path(__file__).parents[4] / "target" / "debug" / "examples" / "simulated_node"

# Warnings of a dose are not the matter here.
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")


class Node:
    """A simulated node in a process of its own."""

    def __init__(self, number: int = 1) -> None:
        assert NODE.exists(), f"{NODE} is missing: `cargo build --example simulated_node` makes it"
        self._process = subprocess.Popen(
            [NODE, "--piped", "--number", str(number)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self._process.stdout is not None
        self.port = self._process.stdout.readline().strip()

    def freeze(self) -> None:
        """Let the board fall silent. Its motors stand until it goes on."""
        self._process.send_signal(signal.SIGSTOP)

    def go_on(self) -> None:
        """Let a silent board go on where it stood."""
        self._process.send_signal(signal.SIGCONT)

    def vanish(self) -> None:
        """Pull the board out, with its port."""
        self._process.kill()
        self._process.communicate(timeout=30)

    def end(self) -> list[int]:
        """Switch the board off. Returns the steps of its motors."""
        out, _ = self._process.communicate(timeout=30)
        return list(ast.literal_eval(out.removesuffix(" steps\n"))) if out else []


@pytest.fixture
def node() -> Iterator[Node]:
    node = Node()
    yield node
    node.end()


def open_bench(node: Node, folder: Path, *, accept_settings: bool = False) -> pm.Bench:
    return pm.Bench.open(
        "three-roller",
        driver="node",
        port=node.port,
        state_dir=folder,
        confirm_pump=True,
        accept_settings=accept_settings,
    )


def after(steps: int, act: Callable[[], object]) -> Callable[[int, int], None]:
    """Return a progress that acts once so many steps were made."""
    left = [act]

    def progress(made: int, planned: int) -> None:
        if made >= steps and left:
            left.pop()()

    return progress


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


def test_a_stop_in_mid_dose_counts_what_the_node_made(tmp_path: Path) -> None:
    node = Node()
    with open_bench(node, tmp_path) as bench:
        bench.home_set(0.5)
        stopped = bench.dose("3mL", rate="2mL/s", smooth=True, progress=after(400, bench.stop))
        assert not stopped.completed
        assert stopped.steps_made is not None
        assert 400 <= stopped.steps_made < stopped.steps
        part = bench.status().unfinished
        assert part is not None
        assert part.delivered_least_ml <= part.delivered_most_ml < 3
        rest = bench.resume()
        assert bench.status().unfinished is None
    assert rest.completed
    assert rest.steps_made == stopped.steps - stopped.steps_made
    assert node.end() == [stopped.steps, 0, 0, 0]


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_stops_the_motor_of_a_node(tmp_path: Path) -> None:
    node = Node()
    with open_bench(node, tmp_path) as bench:
        bench.home_set(0.5)
        planned = bench.plan("3mL", rate="2mL/s")
        ctrl_c = after(400, lambda: signal.raise_signal(signal.SIGINT))
        with pytest.raises(KeyboardInterrupt):
            bench.dose("3mL", rate="2mL/s", progress=ctrl_c)
        assert bench.status().unfinished is not None
        bench.discard()
        made = bench.status().device_count
    assert made is not None
    assert 400 <= made < planned.steps
    assert node.end() == [made, 0, 0, 0]


def test_a_node_that_falls_silent_in_mid_dose_loses_and_repeats_no_step(tmp_path: Path) -> None:
    node = Node()
    with open_bench(node, tmp_path) as bench:
        bench.home_set(0.5)
        planned = bench.plan("3mL", rate="2mL/s")
        with pytest.raises(pm.DriveError) as cut:
            bench.dose("3mL", rate="2mL/s", progress=after(400, node.freeze))
        assert cut.value.delivered_least_ml is not None
        assert cut.value.delivered_most_ml is not None
        assert 0 < cut.value.delivered_least_ml <= cut.value.delivered_most_ml
        part = bench.status().unfinished
        assert part is not None
        node.go_on()
        rest = bench.resume(rate="2mL/s")
    assert rest.completed
    assert node.end() == [planned.steps, 0, 0, 0]


def test_a_node_that_is_pulled_out_in_mid_dose_leaves_bounds(tmp_path: Path) -> None:
    node = Node()
    with open_bench(node, tmp_path) as bench:
        bench.home_set(0.5)
        with pytest.raises(pm.DriveError) as cut:
            bench.dose("3mL", rate="2mL/s", progress=after(400, node.vanish))
        assert cut.value.delivered_least_ml is not None
        assert cut.value.delivered_most_ml is not None
        assert 0 < cut.value.delivered_least_ml < cut.value.delivered_most_ml
        part = bench.status().unfinished
        assert part is not None
        assert part.delivered_least_ml == pytest.approx(cut.value.delivered_least_ml)
    # The board comes back without its count, at another port.
    again = Node()
    with open_bench(again, tmp_path) as bench:
        with pytest.raises(pm.UnfinishedError):
            bench.dose("1mL")
        bench.discard()
        dose = bench.dose("1mL")
        assert dose.phase.half_width_deg > 1
    assert again.end() == [dose.steps, 0, 0, 0]


def test_another_board_on_the_port_is_refused_and_can_be_accepted(tmp_path: Path) -> None:
    first = Node()
    with open_bench(first, tmp_path) as bench:
        bench.home_set(0.5)
        made = bench.dose("0.5mL").steps
    assert first.end() == [made, 0, 0, 0]
    other = Node(number=2)
    with open_bench(other, tmp_path) as bench, pytest.raises(pm.PumpError, match="number 0000000000000002"):
        bench.dose("0.5mL")
    with open_bench(other, tmp_path, accept_settings=True) as bench:
        accepted = bench.dose("0.5mL").steps
    assert other.end() == [accepted, 0, 0, 0]

import runpy
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import pyplot as plt

import pumpmodel as pm

GALLERY = Path(__file__).parents[2] / "gallery"
PICTURES = Path(__file__).parents[4] / "docs" / "gallery"

mpl.use("Agg")


def run(script: str, folder: Path) -> tuple[Any, dict[str, Any]]:
    """Return the result of a script's main function, and its names. Its pictures must equal the docs'."""
    names = runpy.run_path(str(GALLERY / script))
    result = names["main"](folder)
    plt.close("all")
    drawn = sorted(folder.iterdir())
    assert drawn
    for picture in drawn:
        assert plt.imread(picture).shape == plt.imread(PICTURES / picture.name).shape, picture.name
    return result, names


def test_the_papers_pulse_at_60_rpm(tmp_path: Path) -> None:
    pulses, _ = run("paper_figures.py", tmp_path)
    assert pulses == [pytest.approx((25.089, 0.14036), abs=(6e-4))] * 2


def test_the_error_without_the_angle_is_the_known_one_and_with_it_half_a_step(tmp_path: Path) -> None:
    largest, names = run("dose_error.py", tmp_path)
    assert {volume: round(percent, 1) for volume, (percent, _) in largest.items()} == {
        1: 81.7,
        5: 26.0,
        25: 4.4,
    }
    # Half a step of 12,800 at the largest flow, a = 4.398 mL/rad.
    assert all(microlitres <= 1.08 for _, microlitres in largest.values())
    start_rad = np.linspace(0, np.pi, 5000, endpoint=False)
    two = [names["naive_error_percent"](pm.Pump.two_roller(), volume, start_rad) for volume in (1, 10, 100)]
    assert [np.abs(errors).max() for errors in two] == pytest.approx([84.3, 12.9, 1.13], abs=0.05)
    assert [errors.std() for errors in two] == pytest.approx([32.6, 5.1, 0.90], abs=0.1)


def test_a_fit_finds_the_line_within_its_errors(tmp_path: Path) -> None:
    result, names = run("fit_line.py", tmp_path)
    pump = pm.Pump.three_roller()

    def errors(found: pm.Identified) -> list[tuple[float, float]]:
        """Difference from the truth in standard errors, and the standard error as a part."""
        true = [(getattr(pump.outlet, name), found.parameters[name]) for name in names["NAMES"]]
        return [(abs(found.value - value) / found.standard, found.standard / value) for value, found in true]

    assert all(off < 3 and part < 0.005 for off, part in errors(result))
    assert result.warnings == ()
    guess = names["scaled"](pump, 1.3)
    fits = [names["fit"](guess, names["measure"](pump, seed)) for seed in range(20)]
    # 60 numbers of which 95 % are expected; fewer than 51 would happen once in a thousand times.
    assert sum(off < 2 for found in fits for off, _ in errors(found)) >= 51


def test_the_rollers_that_are_chosen_keep_to_the_target(tmp_path: Path) -> None:
    choice, names = run("choose_rollers.py", tmp_path)
    head = choice.head
    assert (head.rollers, round(np.degrees(head.contact_angle_rad))) == (4, 20)
    # Seen over a long run of the chosen head, contact angle and all, and of the next smaller one.
    swings = []
    for pump in (head, names["head"](3, 45)):
        run_ = pump.simulate(speed_rpm=pump.speed_for_flow_rpm(flow_ml_s=45), duration_s=5)
        swings.append(np.ptp(run_.outlet_kpa[run_.time_s > 4]))
    assert swings[0] == pytest.approx(choice.swing_kpa[2], abs=0.01)
    assert swings[0] <= 25 < swings[1]
    with pytest.raises(ValueError, match="at some angles no roller seals"):
        names["head"](2, 0)
    assert list(choice.sealing[0][:5]) == [0, 0, 0, 0, 1]


def test_results_are_drawn_as_a_notebook_shows_them() -> None:
    names = runpy.run_path(str(GALLERY / "results.py"))
    assert len(plt.get_fignums()) == 6
    assert all("<svg" in names[shown]._repr_html_() for shown in ("pump", "plan", "steady", "calibration"))

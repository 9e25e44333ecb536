import re
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from drawn import results

import pumpmodel as pm

DRAWN = list(results())


@pytest.mark.parametrize("name", DRAWN)
def test_a_notebook_shows_a_table_and_a_small_picture(name: str) -> None:
    html = results()[name]._repr_html_()
    assert len(html) < 30_000
    # Well-formed, and nothing but a table with its picture.
    tags = {element.tag.rpartition("}")[2] for element in ElementTree.fromstring(html).iter()}
    assert tags <= {
        *("div", "strong", "table", "tr", "th", "td", "p"),
        *("svg", "path", "polyline", "circle", "rect", "text"),
    }
    assert "svg" in tags
    assert not re.search(r"\d\de[+-]\d\d|nan|inf\b", html)


def test_names_in_a_notebook_are_text_whatever_they_are() -> None:
    evil = '<script>alert(1)</script>"&'
    pump = pm.Pump.from_dict({**pm.Pump.three_roller().to_dict()})
    data = pump.to_dict()
    data["pump"]["name"] = evil
    html = pm.Pump.from_dict(data)._repr_html_()
    assert "<script" not in html
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in html
    plan = pm.Doser(pump).plan("5mL", start_angle_rad=0.1)
    dose = pm.Dose.from_dict({**plan.to_dict(), "pump": evil, "warnings": [evil, "x" * 100_000] * 50})
    told = dose._repr_html_()
    assert "<script" not in told
    assert len(told) < 30_000
    ElementTree.fromstring(told)


def test_words_of_a_picture_have_the_colour_of_the_page() -> None:
    svg = ElementTree.fromstring(results()["run"]._repr_html_()).find("{http://www.w3.org/2000/svg}svg")
    assert svg is not None
    assert "fill:currentColor" in svg.get("style", "")
    colours = {element.get("fill") or element.get("stroke") for element in svg.iter()}
    assert colours <= {None, "none", "currentColor", "#0072B2", "#D55E00"}


def test_a_result_without_samples_is_shown() -> None:
    pump = pm.Pump.three_roller()
    assert "0 speeds" in pump.steady_state(speed_rpm=[])._repr_html_()
    assert "0 pumps" in pm.sweep([], speed_rpm=50)._repr_html_()
    columns = {name: np.empty(0) for name in pump.simulate(speed_rpm=100, duration_s=0.1).to_dict()}
    assert "0 samples" in pm.Run.from_dict(columns)._repr_html_()


def test_results_are_shown_without_matplotlib() -> None:
    code = (
        "import sys; sys.modules['matplotlib'] = None; import pumpmodel as pm; "
        "print(pm.Pump.three_roller().simulate(speed_rpm=100, duration_s=0.1)._repr_html_())"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert "<svg" in told

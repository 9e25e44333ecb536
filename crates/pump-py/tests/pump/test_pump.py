import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pumpmodel as pm


def test_the_built_in_pumps_have_the_papers_volumes_per_revolution() -> None:
    assert pm.Pump.three_roller().volume_per_revolution_ml == pytest.approx(21.3185, abs=1e-4)
    assert pm.Pump.two_roller().volume_per_revolution_ml == pytest.approx(23.4240, abs=1e-4)
    # V_nom - NU V_r with the table's V_r of 2.06 mL.
    published = pm.Pump.three_roller(variant="published")
    assert published.volume_per_revolution_ml == pytest.approx(27.63489 - 3 * 2.06, abs=1e-4)


def test_a_pump_says_what_it_is() -> None:
    pump = pm.Pump.three_roller()
    assert (pump.id, pump.name, pump.rollers) == ("three-roller", "McIntyre et al., 3 rollers", 3)
    assert pump.pitch_rad == pytest.approx(2 * math.pi / 3)
    assert (pump.steps_per_rev, pump.max_speed_rpm, pump.max_acceleration_rad_s2) == (12_800, 170, 500)
    assert pump.default_rate_ml_s == 5
    assert pump.inlet == pump.outlet
    assert pump.outlet.compliance_ml_kpa == 0.0361
    assert pm.Pump.two_roller(variant="as-built").id == "two-roller-as-built"


def test_an_unknown_variant_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="variant is 'newest'; allowed: 'measured', 'published', 'as-built'"):
        pm.Pump.three_roller(variant="newest")  # type: ignore[arg-type]


def test_average_flow_is_the_papers_and_its_inverse_gives_the_speed_in_rpm() -> None:
    pump = pm.Pump.three_roller()
    assert pump.average_flow_ml_s(speed_rpm=100) == pytest.approx(35.5308, abs=5e-5)
    assert pump.average_flow_ml_s(speed_rad_s=100 * math.tau / 60) == pytest.approx(35.5308, abs=5e-5)
    assert pump.average_flow_ml_s(speed_rpm=-100) == -pump.average_flow_ml_s(speed_rpm=100)
    for flow in (0.001, 5, 35.5):
        assert pump.average_flow_ml_s(speed_rpm=pump.speed_for_flow_rpm(flow_ml_s=flow)) == pytest.approx(
            flow, rel=1e-14
        )


def test_a_number_gives_a_float_and_an_array_an_array_of_its_shape() -> None:
    pump = pm.Pump.three_roller()
    for of in (pump.outlet_volume_ml, pump.outlet_flow_ml_rad, pump.inlet_volume_ml, pump.inlet_flow_ml_rad):
        assert type(of(1)) is float
        assert type(of(np.float64(1))) is float
        assert isinstance(of(np.array(1.0)), float)
        angles = np.linspace(-7, 7, 30)
        expected = [of(float(angle)) for angle in angles]
        for form in (angles, list(angles), tuple(angles), angles.astype(">f8")):
            values = of(form)
            assert values.dtype == np.float64
            np.testing.assert_array_equal(values, expected)
        np.testing.assert_array_equal(of(angles.reshape(2, 3, 5)), np.reshape(expected, (2, 3, 5)))
        np.testing.assert_array_equal(of(angles.reshape(5, 6).T), np.reshape(expected, (5, 6)).T)
        assert of([]).shape == (0,)
        assert of(np.arange(3, dtype=np.int32)).tolist() == [of(0), of(1), of(2)]
    flows = pump.average_flow_ml_s(speed_rpm=[[50, 100], [150, -150]])
    assert flows.shape == (2, 2)
    np.testing.assert_allclose(pump.speed_for_flow_rpm(flow_ml_s=flows), [[50, 100], [150, -150]], rtol=1e-14)


def test_volume_is_the_integral_of_the_flow_over_angle() -> None:
    pump = pm.Pump.three_roller()
    angle = np.linspace(0, pump.pitch_rad, 200_001)
    step = np.diff(angle)
    for volume, flow in (
        (pump.outlet_volume_ml, pump.outlet_flow_ml_rad),
        (pump.inlet_volume_ml, pump.inlet_flow_ml_rad),
    ):
        middle = angle[:-1] + 0.5 * step
        np.testing.assert_allclose(np.cumsum(flow(middle) * step), volume(angle)[1:], atol=1e-5)
        assert volume(0) == 0
        assert volume(math.tau) == pytest.approx(pump.volume_per_revolution_ml)


@pytest.mark.parametrize("speed", [{}, {"speed_rpm": 1, "speed_rad_s": 1}])
def test_not_exactly_one_speed_is_refused(speed: dict[str, float]) -> None:
    pump = pm.Pump.three_roller()
    for call in (pump.average_flow_ml_s, pump.steady_state):
        with pytest.raises(ValueError, match="speed_rad_s"):
            call(**speed)
    with pytest.raises(ValueError, match="speed_rad_s"):
        pump.simulate(duration_s=1, **speed)  # type: ignore[call-overload]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e300, [1, math.nan]])
def test_what_is_not_finite_or_beyond_the_range_is_refused_by_name(bad: float) -> None:
    pump = pm.Pump.three_roller()
    with pytest.raises(ValueError, match=r"angle_rad is .*; allowed: a finite number, up to 1e9 either way"):
        pump.outlet_volume_ml(bad)
    with pytest.raises(ValueError, match="speed_rpm is"):
        pump.average_flow_ml_s(speed_rpm=bad)
    with pytest.raises(ValueError, match="speed_rad_s is"):
        pump.steady_state(speed_rad_s=bad)
    with pytest.raises(ValueError, match="flow_ml_s is"):
        pump.speed_for_flow_rpm(flow_ml_s=bad)


@pytest.mark.parametrize("bad", ["100", b"100", None, True, 1j, ["1"], object()])
def test_what_is_no_number_is_a_type_error(bad: float) -> None:
    with pytest.raises(TypeError, match="angle_rad must be a number or an array of numbers in rad, not "):
        pm.Pump.three_roller().outlet_volume_ml(bad)


def test_replacing_rollers_and_lines_makes_another_pump() -> None:
    three = pm.Pump.three_roller()
    line = pm.Line(
        resistance_kpa_s_ml=0.2, compliance_ml_kpa=0.05, inertance_kpa_s2_ml=0.004, reservoir_kpa=90
    )
    four = three.replace(rollers=4, outlet=line)
    assert (three.rollers, four.rollers) == (3, 4)
    assert four.outlet == line
    assert four.inlet == three.inlet
    assert four.volume_per_revolution_ml == pytest.approx(27.63489 - 4 * 2.105466, abs=1e-4)
    assert three.replace() == three
    assert three.replace(inlet=line).inlet == line


@pytest.mark.parametrize(
    ("rollers", "message"),
    [
        (-1, "rollers is -1; allowed: 1 to 1000"),
        (0, "rollers is 0; allowed: 1 to 1000"),
        (2**40, "allowed: 1 to 1000"),
        (1, "no roller seals"),
        (14, "14 rollers take 2.1055 mL each"),
    ],
)
def test_a_number_of_rollers_that_cannot_work_is_refused(rollers: int, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pm.Pump.three_roller().replace(rollers=rollers)


def test_rollers_that_overlap_in_space_are_warned_of() -> None:
    # The axes of eight rollers on a circle of 36 mm stand 36 sin(22.5 deg) = 13.777 mm apart.
    with pytest.warns(UserWarning, match="the rollers overlap by 0.22 mm"):
        pump = pm.Pump.from_drawing(
            "wide",
            rollers=8,
            bore_radius_mm=0.8,
            tube_outer_radius_mm=2.4,
            backplate_radius_mm=27.8,
            contact_angle_deg=-20,
            roller_radius_mm=7,
            roller_offset_mm=18,
            hose_length_mm=300,
        )
    assert pump.rollers_overlap_mm == pytest.approx(14 - 13.777, abs=5e-4)
    assert pm.Pump.three_roller().rollers_overlap_mm is None


def test_every_way_to_a_pump_warns_of_rollers_that_overlap(tmp_path: Path) -> None:
    # Eight rollers of 20 mm on a circle of 40 mm: their axes stand 80 sin(22.5 deg) = 30.61 mm apart.
    def warns() -> Any:
        return pytest.warns(UserWarning, match="the rollers overlap by 9.39 mm")

    with warns():
        eight = pm.Pump.three_roller().replace(rollers=8)
    file = tmp_path / "eight.toml"
    file.write_text(eight.to_toml(), encoding="utf-8")
    with warns():
        assert pm.Pump.from_toml(file) == eight
    with warns():
        assert pm.Pump.named(str(file)) == eight
    with warns():
        assert pm.Pump.from_dict(eight.to_dict()) == eight


def test_a_pump_file_is_read_from_text_path_or_pathlike(tmp_path: Path) -> None:
    path = tmp_path / "pump.toml"
    pump = pm.Pump.three_roller().replace(rollers=4)
    path.write_text(pump.to_toml(), encoding="utf-8")
    assert pm.Pump.from_toml(path) == pump
    assert pm.Pump.from_toml(str(path)) == pump


def test_a_missing_pump_file_is_a_file_not_found_error(tmp_path: Path) -> None:
    path = tmp_path / "none.toml"
    with pytest.raises(FileNotFoundError) as caught:
        pm.Pump.from_toml(path)
    assert caught.value.filename == str(path)
    with pytest.raises(IsADirectoryError):
        pm.Pump.from_toml(tmp_path)


def test_a_bad_pump_file_is_a_pump_file_error_and_a_value_error(tmp_path: Path) -> None:
    path = tmp_path / "pump.toml"
    text = pm.Pump.three_roller().to_toml()
    for bad, message in (
        ("nonsense", "pump.toml"),
        (text.replace("pump/1", "pump/9"), "schema is `pump/9`"),
        (text.replace("count = 3", "count = 14"), "14 rollers"),
        (text.replace("steps_per_rev = 12800", "steps_per_rev = 0"), "steps_per_rev is 0; allowed: 4 to"),
        (text + "\n[surprise]\n", "surprise"),
    ):
        path.write_text(bad, encoding="utf-8")
        for kind in (pm.PumpFileError, pm.PumpError, ValueError):
            with pytest.raises(kind, match=message):
                pm.Pump.from_toml(path)
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(pm.PumpFileError):
        pm.Pump.from_toml(path)


@pytest.mark.parametrize(
    ("name", "bad"),
    [
        ("resistance_kpa_s_ml", -1),
        ("compliance_ml_kpa", 0),
        ("inertance_kpa_s2_ml", math.nan),
        ("reservoir_kpa", math.inf),
    ],
)
def test_a_line_that_is_not_physical_is_refused(name: str, bad: float) -> None:
    good = {
        "resistance_kpa_s_ml": 0.1,
        "compliance_ml_kpa": 0.04,
        "inertance_kpa_s2_ml": 0.004,
        "reservoir_kpa": 90.0,
    }
    with pytest.raises(ValueError, match="; allowed: "):
        pm.Line(**{**good, name: bad})
    with pytest.raises(TypeError):
        pm.Line(0.1, 0.04, 0.004, 90)  # type: ignore[call-arg]

"""Claims about one line from several recordings."""

import json
import pickle
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

import pumpmodel as pm

_Array = NDArray[np.float64]
PUMP = pm.Pump.three_roller()
REAL = PUMP.replace(
    outlet=PUMP.outlet.replace(resistance_kpa_s_ml=0.14, compliance_ml_kpa=0.03, inertance_kpa_s2_ml=0.006)
)
SPEEDS_RPM = (25.0, -60.0, 110.0)
NOISE_KPA = 0.4


def records(**changed: Any) -> list[pm.PressureRecord]:
    dice = np.random.default_rng(21)
    made = []
    for place, speed_rpm in enumerate(SPEEDS_RPM):
        # Uneven times, and another number of samples for each speed.
        time_s = np.sort(dice.uniform(0, 0.9, 300 + 60 * place))
        run = REAL.simulate(speed_rpm=speed_rpm, time_s=time_s, start_angle_rad=0.1 * place)
        made.append(
            pm.PressureRecord(
                run.time_s,
                run.outlet_kpa + dice.normal(0, NOISE_KPA, len(time_s)),
                speed_rpm=speed_rpm,
                begin="step",
                **changed,
            )
        )
    return made


def information(line: pm.Line, record: pm.PressureRecord, fit: pm.RecordingFit) -> _Array:
    """Return the information of a record on R, C, L and its own angle, in deg, for noise of 1 kPa."""
    run = PUMP.replace(outlet=line).simulate(
        speed_rpm=float(record.speed_rpm or 0),
        time_s=np.asarray(record.time_s),
        start_angle_rad=np.radians(fit.parameters["start_angle_deg"].value),
        sensitivity=True,
    )
    by: _Array = np.array(run.sensitivity.outlet_kpa_by[:4])
    by[3] *= np.radians(1)
    return by @ by.T


def test_the_joint_covariance_is_the_inverse_of_the_summed_information() -> None:
    given = records()
    found = pm.identify_line_jointly(PUMP, given)
    for name, truth in (("resistance", 0.14), ("compliance", 0.03), ("inertance", 0.006)):
        estimate = next(value for key, value in found.parameters.items() if key.startswith(name))
        assert abs(estimate.value - truth) < 2.5 * estimate.standard
    total = np.zeros((6, 6))
    for place, (record, fit) in enumerate(zip(given, found.recordings, strict=True)):
        at = [0, 1, 2, 3 + place]
        total[np.ix_(at, at)] += information(found.line, record, fit)
    samples = sum(len(fit.time_s) for fit in found.recordings)
    independent = sum(fit.independent_points for fit in found.recordings)
    variance = found.rmse_kpa**2 * samples / (independent - 6)
    ratio = found.covariance / (variance * np.linalg.inv(total))
    # Student's t widens all by one factor, and nothing else.
    assert np.ptp(ratio) < 1e-6
    assert 1 < ratio[0, 0] < 1.04
    assert found.covariance_names == (
        "resistance_kpa_s_ml",
        "compliance_ml_kpa",
        "inertance_kpa_s2_ml",
        "recordings[0].start_angle_deg",
        "recordings[1].start_angle_deg",
        "recordings[2].start_angle_deg",
    )
    standards = [estimate.standard for estimate in found.parameters.values() if not estimate.held]
    standards += [fit.parameters["start_angle_deg"].standard for fit in found.recordings]
    np.testing.assert_allclose(np.sqrt(np.diag(found.covariance)), standards, rtol=1e-12)


def test_several_records_tell_more_than_each_of_them() -> None:
    given = records()
    joint = pm.identify_line_jointly(PUMP, given)
    for record in given:
        single = pm.identify_line(
            PUMP,
            time_s=record.time_s,
            pressure_kpa=record.pressure_kpa,
            speed_rpm=record.speed_rpm,
            begin="step",
        )
        for name in ("resistance_kpa_s_ml", "compliance_ml_kpa", "inertance_kpa_s2_ml"):
            assert joint.parameters[name].standard < single.parameters[name].standard


def test_one_record_alone_is_the_single_fit() -> None:
    record = records()[2]
    joint = pm.identify_line_jointly(PUMP, [record], fit=["R", "C", "L", "reservoir"])
    single = pm.identify_line(
        PUMP,
        time_s=record.time_s,
        pressure_kpa=record.pressure_kpa,
        speed_rpm=record.speed_rpm,
        begin="step",
        fit=["R", "C", "L", "reservoir"],
    )
    for name, estimate in joint.parameters.items():
        assert estimate.value == pytest.approx(single.parameters[name].value, rel=1e-6)
        assert estimate.standard == pytest.approx(single.parameters[name].standard, rel=1e-5)
    assert joint.log_likelihood == pytest.approx(single.log_likelihood, abs=1e-6)
    np.testing.assert_allclose(joint.recordings[0].residual_kpa, single.residual_kpa, atol=1e-5)
    angle = joint.recordings[0].parameters["start_angle_deg"]
    assert angle.value == pytest.approx(single.parameters["start_angle_deg"].value, rel=1e-5)


def test_the_likelihood_is_largest_at_the_noise_that_there_is() -> None:
    equal = pm.identify_line_jointly(PUMP, records())
    told = pm.identify_line_jointly(PUMP, records(standard_kpa=0.2))
    # One noise for all is equal weights, whatever its size.
    for name, estimate in told.parameters.items():
        assert estimate.value == pytest.approx(equal.parameters[name].value, rel=1e-9)
        assert estimate.standard == pytest.approx(equal.parameters[name].standard, rel=1e-9)
    assert told.log_likelihood == pytest.approx(equal.log_likelihood, abs=1e-6)
    residual = np.concatenate([fit.residual_kpa for fit in equal.recordings])
    variance = np.mean(residual**2)
    expected = -0.5 * np.sum(residual**2 / variance + np.log(2 * np.pi * variance))
    assert equal.log_likelihood == pytest.approx(expected, rel=1e-12)


def test_a_joint_fit_is_a_value_and_is_drawn() -> None:
    found = pm.identify_line_jointly(PUMP, iter(records()))
    for same in (pm.identify_line_jointly(PUMP, records()), pickle.loads(pickle.dumps(found))):
        assert same == found
        assert hash(same) == hash(found)
        assert not same.covariance.flags.writeable
        assert not same.recordings[1].fitted_kpa.flags.writeable
    assert found != pm.identify_line_jointly(PUMP, records()[:2])
    assert repr(found).startswith("JointlyIdentified(outlet, 3 recordings: resistance_kpa_s_ml=0.1")
    told = json.loads(json.dumps(found.to_dict()))
    assert told["recordings"][2]["rows"] == 420
    assert pm.Line(**told["line"]) == found.line
    html = found._repr_html_()
    assert html.count("<svg") == 3
    assert "3 recordings" in html
    pytest.importorskip("matplotlib")
    axes = found.plot()
    assert [len(axis.lines) for axis in axes] == [2, 2, 2]
    np.testing.assert_array_equal(axes[1].lines[1].get_ydata(), found.recordings[1].fitted_kpa)


def test_a_fault_of_a_record_tells_its_place() -> None:
    good, text = records(), cast(Any, "60")
    time_s, kpa = np.arange(5.0), np.full(5, 90.0)
    for bad, error, told in (
        (pm.PressureRecord(time_s, kpa), ValueError, r"recordings\[3\]: no speed is given"),
        (pm.PressureRecord(time_s, kpa[:3], 60), ValueError, r"recordings\[3\]: pressure_kpa has shape"),
        (pm.PressureRecord(time_s, kpa, text), TypeError, r"recordings\[3\]: speed_rpm must be .*not"),
        (pm.PressureRecord(-time_s, kpa, 60), ValueError, r"recordings\[3\]: time_s\[1\] is -1"),
        (pm.PressureRecord(time_s, kpa, 60, standard_kpa=0), ValueError, r"\[3\]: standard_kpa is 0.*kPa"),
        (pm.PressureRecord(time_s, kpa, 60, standard_kpa=1), ValueError, "given for 1 of 4 recordings"),
        (60, TypeError, r"recordings\[3\] must be a PressureRecord, not int"),
    ):
        with pytest.raises(error, match=told):
            pm.identify_line_jointly(PUMP, [*good, bad])  # type: ignore[list-item]
    faults: list[tuple[dict[str, Any], str]] = [
        ({"fit": "RC"}, "fit is a text, 'RC'; allowed: a sequence of names"),
        ({"fit": ["K"]}, "a name in fit is 'K'; allowed: 'R', 'C', 'L', 'reservoir', 'start'"),
        ({"fit": []}, "fit is empty"),
        ({"port": "middle"}, "port is 'middle'"),
    ]
    for keywords, told in faults:
        with pytest.raises((TypeError, ValueError), match=told):
            pm.identify_line_jointly(PUMP, good, **keywords)
    with pytest.raises(ValueError, match="recordings is empty; allowed: one PressureRecord at least"):
        pm.identify_line_jointly(PUMP, [])
    wrong = [pm.PressureRecord(record.time_s, record.pressure_kpa, 47, begin="step") for record in good[1:]]
    try:
        warned = " ".join(pm.identify_line_jointly(PUMP, [good[0], *wrong]).warnings)
    except ValueError as error:
        warned = str(error)
    assert "recording 2 of 3: " in warned or "explains" in warned

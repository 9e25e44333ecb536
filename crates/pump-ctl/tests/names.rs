//! The names of choices, and the messages that refuse other names and values.

use pump_ctl::plan::{Allowed, Cruise, Doser, Finish, LimitedBy, Limits, Motor, Phase, Request, SetBy};
use pump_model::Pump;

#[test]
fn every_choice_is_read_back_from_its_name() {
    for finish in Finish::ALL {
        assert_eq!(finish.to_string().parse(), Ok(finish));
    }
    for limit in LimitedBy::ALL {
        assert_eq!(limit.to_string().parse(), Ok(limit));
    }
    let origins = [SetBy::Given, SetBy::TubeCollapse, SetBy::Vapour].map(SetBy::name);
    assert_eq!(origins, ["given", "tube_collapse", "vapour_pressure"]);
}

#[test]
fn every_limit_has_a_name_of_its_own() {
    for limit in LimitedBy::ALL {
        assert_eq!(LimitedBy::ALL.iter().filter(|other| other.name() == limit.name()).count(), 1, "{limit}");
    }
    assert_eq!(LimitedBy::OutletSuction.name(), "outlet_suction");
}

#[test]
fn a_name_that_is_refused_is_repeated_with_the_names_that_are_allowed() {
    let refused = "Torque".parse::<LimitedBy>().unwrap_err();
    assert_eq!(
        refused.to_string(),
        "limited_by is 'Torque'; allowed: 'none', 'speed', 'acceleration', 'inlet_suction', 'inlet_pressure', \
         'outlet_suction', 'outlet_pressure', 'torque'"
    );
    assert_eq!("".parse::<Finish>().unwrap_err().to_string(), "finish is ''; allowed: 'any', 'low-flow'");
}

#[test]
fn a_long_name_is_cut_between_letters() {
    let refused = "ä".repeat(30).parse::<Finish>().unwrap_err();
    assert_eq!(refused.to_string(), format!("finish is '{}...'; allowed: 'any', 'low-flow'", "ä".repeat(20)));
    let refused = format!("a{}", "ä".repeat(30)).parse::<Finish>().unwrap_err();
    assert_eq!(
        refused.to_string(),
        format!("finish is 'a{}...'; allowed: 'any', 'low-flow'", "ä".repeat(19))
    );
    assert_eq!(refused.allowed(), ["any", "low-flow"]);
}

#[test]
fn a_range_checks_the_values_that_its_message_allows() {
    let between = Allowed::Between { least: 1e-9, most: 1e4 };
    assert_eq!(between.to_string(), "1e-9 to 10000");
    assert!(between.admits(1e-9) && between.admits(1e4) && !between.admits(0.0));
    let either_way = Allowed::EitherWay { most: 1e6 };
    assert_eq!(either_way.to_string(), "up to 1e6 either way");
    assert!(either_way.admits(-1e6) && !either_way.admits(1.1e6));
    let not_zero = Allowed::EitherWayNotZero { most: 1e5 };
    assert!(not_zero.admits(-1.0) && !not_zero.admits(0.0));
    assert!(!Allowed::Positive.admits(0.0) && Allowed::NotNegative.admits(0.0));
    let ranges = [between, either_way, not_zero, Allowed::Positive, Allowed::NotNegative];
    for range in ranges {
        assert!(!range.admits(f64::NAN) && !range.admits(f64::INFINITY), "{range}");
    }
}

#[test]
fn a_value_out_of_range_is_refused_with_its_name_and_range() {
    let motor = Motor::new(12_800.0, 17.8, 500.0);
    let refused = |volume_ml, cruise, limits: Limits| {
        let request = Request::new(volume_ml, cruise);
        Doser::new(&Pump::three_roller(), limits)
            .and_then(|doser| doser.plan(Phase::known(0.0), &request))
            .unwrap_err()
            .to_string()
    };
    let limits = Limits::new(motor);
    assert_eq!(
        refused(0.0, Cruise::Fastest, limits),
        "volume in mL is 0; allowed: up to 100000 either way, not zero"
    );
    assert_eq!(
        refused(1.0, Cruise::Within { time_s: -1.0 }, limits),
        "time in s is -1; allowed: a positive number"
    );
    let coarse = Limits::new(motor.with_steps_per_rev(2.0));
    assert_eq!(refused(1.0, Cruise::Fastest, coarse), "steps per revolution is 2; allowed: 4 to 1e9");
}

//! Claims about racks that are refused before anything moves.

use pump_bench::pump_file::{Axis, DriveTable, DriverName};
use pump_bench::rack::{Rack, RackEnd, RackError, RackFile};
use pump_bench::report::{Ending, Explain, with_sources};
use pump_bench::{Bench, PumpFile, built_in};

use crate::rig::{Desk, HEAD, PUMPS};

const RATIO: &str = "[[step]]\nratio = { acid = 1, base = 1 }\nvolume = \"4mL\"\nrate = \"4mL/s\"\n";

fn refused(desk: &Desk, steps: &str) -> RackError {
    let error = desk.rack(steps).and_then(|rack| rack.run(|_| {})).unwrap_err();
    assert!(desk.is_untouched(), "{error}");
    error
}

#[test]
fn all_steps_count_together_for_the_limit_of_a_day_before_anything_moves() {
    let desk = Desk::new();
    let limited = |name: &str, mut file: PumpFile| {
        file.safety.max_ml_per_day = (name == "base").then_some(10.0);
        file
    };
    // 6 mL are on record, and the rack asks for twice 2 mL: neither step alone is beyond 10 mL.
    let before = desk.rack_of("[[step]]\npump = \"base\"\nvolume = \"6.5mL\"\n", limited).unwrap();
    before.run(|_| {}).unwrap();
    let rack = desk.rack_of(&[RATIO, RATIO].concat(), limited).unwrap();
    for refused in [rack.rehearse().unwrap_err(), rack.run(|_| {}).unwrap_err()] {
        assert_eq!(refused.ending(), Ending::Stands, "{refused}");
        let text = with_sources(&refused);
        assert!(text.starts_with("pump `base` of the rack: ") && text.contains("10 mL"), "{text}");
    }
    // No pump has moved, and the one beyond its limit stands until a person clears it.
    assert!(desk.state("acid").is_none_or(|state| state.wear.volume_ml == 0.0));
    assert!((desk.state("base").unwrap().wear.volume_ml - 6.5).abs() < 0.002);
    assert_eq!(rack.run(|_| {}).unwrap_err().ending(), Ending::Stands);
    let bench = &rack.members()[1].bench;
    bench.session().unwrap().clear_safety("the bottle was changed").unwrap();
    assert!(rack.run(|_| {}).unwrap().completed);
}

#[test]
fn a_pump_that_another_command_holds_is_waited_for_by_nobody_and_named() {
    let desk = Desk::new();
    let bench = desk.bench("base");
    let session = bench.session().unwrap();
    let error = refused(&desk, RATIO);
    assert_eq!(error.ending(), Ending::Busy);
    assert!(with_sources(&error).contains("pump `base` of the rack: pump `two-roller` is in use by process"));
    drop(session);
    assert!(desk.rack(RATIO).unwrap().run(|_| {}).unwrap().completed);
}

#[test]
fn the_first_pump_of_the_rack_that_refuses_is_named_however_long_its_answer_takes() {
    let desk = Desk::new();
    let file = RackFile::parse(&format!("{HEAD}{}", RATIO.replace("4mL/s", "4L/s")), "mix.toml".as_ref());
    let named = |name| desk.bench(name).waiting(std::time::Duration::from_secs(60), |_| {});
    let rack = Rack::new(file.unwrap(), PUMPS.map(|(name, _)| named(name)).into()).unwrap();
    let rack = rack.paced(pump_bench::pump_file::Pace::Fast);
    let bench = desk.bench("acid");
    let holder = bench.session().unwrap();
    let error = std::thread::scope(|scope| {
        let ran = scope.spawn(|| rack.run(|_| {}).unwrap_err());
        // The pump `base` refuses its part long before.
        std::thread::sleep(std::time::Duration::from_millis(700));
        drop(holder);
        ran.join().unwrap()
    });
    assert_eq!(error.pump(), Some("acid"), "{}", with_sources(&error));
    assert!(desk.is_untouched());
}

/// Leaves a dose of this pump unfinished.
fn leave_unfinished(desk: &Desk, name: &str) {
    let bench = desk.bench(name);
    let mut session = bench.session().unwrap();
    let prepared = session.prepare(pump_bench::DoseRequest::dose(5.0)).unwrap();
    let stop = |made| {
        if made > 500 { std::ops::ControlFlow::Break(()) } else { std::ops::ControlFlow::Continue(()) }
    };
    session.run(&prepared, stop).unwrap();
}

#[test]
fn an_unfinished_dose_of_one_pump_refuses_the_rack() {
    let desk = Desk::new();
    leave_unfinished(&desk, "acid");
    let error = desk.rack(RATIO).unwrap().run(|_| {}).unwrap_err();
    assert_eq!(error.ending(), Ending::Unfinished);
    assert!(desk.state("base").is_none_or(|state| state.wear.volume_ml == 0.0));
}

#[test]
fn every_pump_that_waits_for_a_person_is_named_though_the_first_one_ends_the_session_of_the_others() {
    let desk = Desk::new();
    for name in ["acid", "base", "salt"] {
        leave_unfinished(&desk, name);
    }
    let names = |error: &RackError| -> Vec<String> {
        error.each().filter_map(|error| Some(error.pump()?.to_owned())).collect()
    };
    let steps = format!("{RATIO}[[step]]\npump = \"salt\"\nvolume = \"1mL\"\n");
    let planned = desk.rack(&steps).unwrap().rehearse().unwrap_err();
    assert_eq!(
        (names(&planned), planned.ending()),
        (["acid", "base", "salt"].map(str::to_owned).into(), Ending::Unfinished)
    );
    // The session of `salt` is still to be opened when `acid` refuses, and it is never opened.
    let file = RackFile::parse(&format!("{HEAD}{steps}"), "mix.toml".as_ref()).unwrap();
    let named = |name| desk.bench(name).waiting(std::time::Duration::from_secs(60), |_| {});
    let rack = Rack::new(file, PUMPS.map(|(name, _)| named(name)).into()).unwrap();
    let bench = desk.bench("salt");
    let holder = bench.session().unwrap();
    let refused = rack.run(|_| {}).unwrap_err();
    drop(holder);
    assert_eq!(names(&refused), names(&planned), "{}", with_sources(&refused));
    desk.bench("acid").session().unwrap().accept().unwrap();
    assert_eq!(names(&desk.rack(&steps).unwrap().rehearse().unwrap_err()), ["base", "salt"]);
}

#[test]
fn steps_that_overlap_or_go_back_or_cannot_be_planned_are_named() {
    let desk = Desk::new();
    let at =
        |at: &str, pump: &str| format!("[[step]]\nat = \"{at}\"\npump = \"{pump}\"\nvolume = \"20mL\"\n");
    let overlap = with_sources(&refused(&desk, &[at("0s", "acid"), at("1s", "acid")].concat()));
    assert!(
        overlap.starts_with("step 2 of the rack begins at 1.000 s, and pump `acid` is done with step 1"),
        "{overlap}"
    );
    let back = with_sources(&refused(&desk, &[at("9s", "acid"), at("1s", "base")].concat()));
    assert!(back.starts_with("step 2 of the rack begins at 1.000 s, before step 1 at 9.000 s"), "{back}");
    let fast = "[[step]]\npump = \"acid\"\nvolume = \"1mL\"\n[[step]]\npump = \"base\"\nvolume = \"1mL\"\nrate = \
                \"1L/s\"\n";
    let fast = with_sources(&refused(&desk, fast));
    assert!(fast.starts_with("pump `base` of the rack, step 2: "), "{fast}");
    // Different pumps may run at once.
    assert!(
        desk.rack(&[at("0s", "acid"), at("1s", "base")].concat()).unwrap().run(|_| {}).unwrap().completed
    );
}

#[test]
fn two_pumps_share_no_record_and_no_axis() {
    let desk = Desk::new();
    let rack = |one: PumpFile, other: PumpFile| {
        let head = "schema = \"rack/1\"\n[pumps]\nacid = \"a\"\nbase = \"b\"\n";
        let file = RackFile::parse(&format!("{head}{RATIO}"), "mix.toml".as_ref()).unwrap();
        let benches = [one, other].map(|file| Bench::new(file, None, desk.path()).unwrap());
        Rack::new(file, benches.into()).unwrap_err().to_string()
    };
    let pump = |id: &str, drive: Option<DriveTable>| {
        let mut file = built_in("three-roller").unwrap();
        file.pump.id = id.to_owned();
        file.drive = drive;
        file
    };
    let board = |driver, axis| Some(DriveTable::of(driver).with_port("/dev/ttyUSB7").with_axis(axis));
    for (one, other, told) in [
        (pump("a", None), pump("a", None), "are one pump, `a`; name each pump once"),
        (
            pump("a", board(DriverName::Grbl, Axis::X)),
            pump("b", board(DriverName::Grbl, Axis::X)),
            "name one axis, X at /dev/ttyUSB7",
        ),
        (
            pump("a", board(DriverName::Node, Axis::X)),
            pump("b", board(DriverName::Grbl, Axis::Y)),
            "are turned by node and grbl at one port",
        ),
    ] {
        let text = rack(one, other);
        assert!(text.starts_with("the pumps `acid` and `base` of the rack "), "{text}");
        assert!(text.contains(told), "{text}\nwanted: {told}");
    }
}

#[test]
fn what_a_grbl_board_cannot_do_as_one_line_is_refused_and_names_the_node() {
    let desk = Desk::new();
    let rack = |steps: &str| {
        desk.rack_of(steps, |name, mut file| {
            let axis = if name == "acid" { Axis::X } else { Axis::Y };
            let board = DriveTable::of(DriverName::Grbl).with_port("/dev/ttyUSB7").with_axis(axis);
            file.drive = if name == "salt" { None } else { Some(board) };
            file.motor.confirmed = None;
            file
        })
    };
    let ratio = "[[step]]\nratio = { acid = 2, base = 1 }\nvolume = \"6mL\"\nrate = \"6mL/s\"\n";
    let dose = |at: &str, pump: &str, rate: &str| {
        format!("[[step]]\nat = \"{at}\"\npump = \"{pump}\"\nvolume = \"3mL\"\nrate = \"{rate}\"\n")
    };
    let gradient =
        "[[step]]\ngradient = { acid = [1, 0], base = [0, 1] }\nrate = \"3mL/s\"\nfor = \"10s\"\n".to_owned();
    for (steps, told) in [
        (format!("{ratio}smooth = true\n"), "and step 1 is smooth"),
        (format!("{ratio}{gradient}"), "and step 2 is a flow over time"),
        (format!("{ratio}ramp = \"1s\"\n"), "and step 1 is a flow over time"),
        (
            [dose("0s", "acid", "3mL/s"), dose("0.5s", "base", "3mL/s")].concat(),
            "and step 2 begins at 0.500 s, while step 1 is under way until its line has settled at ",
        ),
        (
            [dose("0s", "acid", "3mL/s"), dose("0s", "base", "1.5mL/s")].concat(),
            "and steps 1 and 2 begin together and take ",
        ),
    ] {
        let error = rack(&steps).and_then(|rack| rack.rehearse().map(drop)).unwrap_err();
        let text = with_sources(&error);
        let begins = "the pumps `acid` and `base` of the rack are axes of one grbl board, at /dev/ttyUSB7, which \
                      moves its axes only as one line of constant ratio, ";
        assert!(text.starts_with(begins), "{text}");
        assert!(text.contains(told), "{text}\nwanted: {told}");
        assert!(text.contains("or the axes of a node (driver = \"node\"; docs/node.md)"), "{text}");
    }
    let together = [dose("0s", "acid", "3mL/s"), dose("0s", "base", "3mL/s"), dose("60s", "base", "1mL/s")];
    for steps in [ratio.to_owned(), together.concat()] {
        let rehearsed = rack(&steps).unwrap().rehearse().unwrap();
        assert_eq!(rehearsed.end, RackEnd::Planned);
    }
}

#[test]
fn an_unknown_pump_of_a_rack_is_named_with_those_that_are_known() {
    let text = HEAD.replace("two-roller", "five-roller") + RATIO;
    let file = RackFile::parse(&text, "mix.toml".as_ref()).unwrap();
    let error = file.pump_files(&pump_bench::config::Config::default()).unwrap_err();
    let text = with_sources(&error);
    assert!(text.starts_with("pump `base` of the rack") && text.contains("five-roller"), "{text}");
}

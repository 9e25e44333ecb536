//! Boards that are met: the right one, another one, and something else.

use pump_bench::built_in;
use pump_bench::drives::{Disturbance, Drive, DriveError, Node, NodeError, Opening, StopRequest};
use pump_bench::pump_file::Axis;
use pump_bench::report::{Explain, Remedy};
use pump_ctl::plan::{Cruise, Doser, Phase, Request};
use pump_link::sender::TooFast;

use crate::rig::{Rig, dose, node_error, run};
use crate::world::SharedWorld;

#[test]
fn a_board_keeps_its_session_and_its_count_from_process_to_process() {
    let rig = Rig::new();
    let mut drive = rig.open();
    assert_eq!(drive.disturbed(), Some(Disturbance::Reset), "it was just switched on");
    let plan = dose(1.0, 4.0, true);
    run(&mut drive, &plan);
    drop(drive);
    let mut drive = rig.open();
    assert_eq!((drive.disturbed(), drive.count()), (None, Some(plan.steps())));
    run(&mut drive, &plan);
    assert_eq!(rig.world.count(), 2 * plan.steps());
}

#[test]
fn another_board_on_the_port_is_refused_until_it_is_accepted() {
    let mut rig = Rig::new();
    drop(rig.open());
    rig.world = SharedWorld::of_board(0x5ec0d);
    let opening = Opening { pump: Some("acid".to_owned()), ..rig.opening() };
    let refused = rig.open_by(&Rig::table(), &opening).unwrap_err();
    assert!(matches!(node_error(&refused), NodeError::OtherBoard { .. }), "{refused}");
    let said = node_error(&refused).to_string();
    assert!(said.contains("000000000005ec0d") && said.contains("00000000000b0a2d"), "{said}");
    assert!(said.contains("the record of pump `acid` is of number"), "{said}");
    let accepting = Opening { accept_settings: true, ..rig.opening() };
    drop(rig.open_by(&Rig::table(), &accepting).unwrap());
    drop(rig.open());
}

#[test]
fn whatever_else_is_at_the_port_is_named_within_seconds() {
    let of_version = |version: u8| {
        // A frame of another version, as this version of the protocol frames it.
        let mut plain = vec![version; 19];
        plain.push(0);
        let sum = crc32(&plain).to_le_bytes();
        plain.extend(sum);
        let mut frame = vec![0];
        frame.extend(cobs(&plain));
        frame.push(0);
        frame
    };
    type Is = fn(&NodeError) -> bool;
    let cases: [(Vec<u8>, Is, &[Remedy]); 4] = [
        (Vec::new(), |error| matches!(error, NodeError::Silent { .. }), &[]),
        (b"Grbl 1.1h ['$' for help]\r\n".to_vec(), |error| matches!(error, NodeError::Foreign { .. }), &[]),
        (
            of_version(9),
            |error| {
                let said = error.to_string();
                matches!(error, NodeError::Version { theirs: 9, .. })
                    && said.contains("/dev/ttyACM0")
                    && said.ends_with(": this program is the older")
            },
            &[Remedy::UpdateProgram],
        ),
        (
            of_version(1),
            |error| {
                matches!(error, NodeError::Version { theirs: 1, .. })
                    && error.to_string().ends_with(": the firmware is the older")
            },
            &[Remedy::UpdateFirmware],
        ),
    ];
    for (bytes, is, remedies) in cases {
        let rig = Rig::new();
        rig.world.0.lock().unwrap().foreign = Some(bytes);
        let began_us = rig.world.now_us();
        let refused = rig.open_by(&Rig::table(), &rig.opening()).unwrap_err();
        assert!(is(node_error(&refused)), "{refused:?}");
        assert_eq!(refused.remedies(), remedies, "{refused:?}");
        assert!(rig.world.now_us() - began_us < 4_000_000);
        assert!(!rig.record().exists() && rig.world.rises().is_empty());
    }
}

#[test]
fn a_board_at_another_baud_is_refused_within_seconds_with_the_rate_that_was_tried() {
    let board_baud = 460_800;
    for baud in [9_600, 115_200, 230_400, 921_600] {
        let rig = Rig::new();
        rig.world.0.lock().unwrap().rates = Some([baud, board_baud]);
        let began_us = rig.world.now_us();
        let refused = rig.open_by(&Rig::table().with_baud(baud), &rig.opening()).unwrap_err();
        let error = node_error(&refused);
        assert!(matches!(error, NodeError::Silent { .. } | NodeError::Foreign { .. }), "{refused:?}");
        let said = error.to_string();
        assert!(said.contains(&format!("at {baud} baud")) && said.contains("[drive] baud"), "{said}");
        assert!(rig.world.now_us() - began_us < 4_000_000);
        assert!(!rig.record().exists() && rig.world.rises().is_empty());
        // The right rate has the board answer again.
        rig.world.0.lock().unwrap().rates = Some([board_baud, board_baud]);
        let mut drive = rig.open_by(&Rig::table().with_baud(board_baud), &rig.opening()).unwrap();
        let plan = dose(0.3, 4.0, false);
        assert_eq!(run(&mut drive, &plan), plan.steps().unsigned_abs());
    }
}

#[test]
fn an_axis_that_is_not_there_is_refused() {
    let rig = Rig::new();
    let refused = rig.open_by(&Rig::table().with_axis(Axis::B), &rig.opening()).unwrap_err();
    assert!(matches!(node_error(&refused), NodeError::NoAxis { axis: 'B', axes: 4 }), "{refused:?}");
}

#[test]
fn a_user_who_asks_to_stop_is_heard_while_a_board_is_sought() {
    let rig = Rig::new();
    rig.world.0.lock().unwrap().foreign = Some(Vec::new());
    let opening = Opening { stop: StopRequest::new(|| true), ..rig.opening() };
    let refused = rig.open_by(&Rig::table(), &opening).unwrap_err();
    assert!(matches!(refused, DriveError::Interrupted), "{refused:?}");
}

/// Rate of a line of this baud that is for segments: four fifths, ten bits a byte.
fn carried_bytes_s(baud: u32) -> u64 {
    u64::from(baud / 10) * 4 / 5
}

#[test]
fn a_dose_that_the_line_cannot_carry_is_refused_with_the_rate_that_would_carry_it() {
    for (volume_ml, ml_s, baud) in
        [(40.0, 8.0, 2400), (100.0, 8.0, 1200), (25.0, 4.0, 2400), (25.0, 4.0, 300)]
    {
        let plan = dose(volume_ml, ml_s, true);
        let rig = Rig::new();
        let mut drive = rig.open_by(&Rig::table().with_baud(baud), &rig.opening()).unwrap();
        let refused = drive.check(&plan).unwrap_err();
        let NodeError::Demand(TooFast::Link { needed_bytes_s, allowed_bytes_s }) = *node_error(&refused)
        else {
            panic!("{refused:?}")
        };
        assert_eq!(allowed_bytes_s, carried_bytes_s(baud));
        assert!(needed_bytes_s > allowed_bytes_s, "{refused}");
        assert!(rig.world.rises().is_empty());
        drive.connect().unwrap();
        drive.check(&dose(1.0, 0.2, false)).unwrap();
        drop(drive);
        // A line that carries just as much takes the plan, and one that carries a byte a second less does not.
        let enough = (1..).find(|tens| carried_bytes_s(tens * 10) >= needed_bytes_s).unwrap() * 10;
        for (baud, is_enough) in [(enough, true), (enough - 20, false)] {
            let mut drive = rig.open_by(&Rig::table().with_baud(baud), &rig.opening()).unwrap();
            assert_eq!(drive.check(&plan).is_ok(), is_enough, "{baud} baud, {needed_bytes_s} bytes/s");
        }
    }
}

#[test]
fn a_dose_of_more_steps_a_second_than_the_board_makes_is_refused_with_both_rates() {
    let mut file = built_in("three-roller").unwrap();
    file.motor.steps_per_rev *= 32;
    let (pump, request) = (file.model().unwrap(), Request::new(1.0, Cruise::Flow { ml_s: 8.0 }));
    let plan = Doser::new(&pump, file.limits()).unwrap().plan(Phase::known(0.3), &request).unwrap();
    let rig = Rig::new();
    let mut drive =
        Node::over(Box::new(rig.world.clone()), &Rig::table(), &file.motor, &rig.opening()).unwrap();
    let refused = drive.check(&plan).unwrap_err();
    let NodeError::Fast { steps_s, most_s: 97_560 } = *node_error(&refused) else { panic!("{refused:?}") };
    let peak_steps_s = plan.profile().peak_rad_s() / plan.step_rad();
    assert!(steps_s > 97_560.0 && (steps_s / peak_steps_s - 1.0).abs() < 1e-9, "{steps_s} {peak_steps_s}");
    assert!(rig.world.rises().is_empty());
}

/// CRC-32/ISO-HDLC, bit by bit (the table of check values in Greg Cook's catalogue of CRCs).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| (crc >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1));
    !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

/// COBS of Cheshire and Baker, for fewer than 254 bytes.
fn cobs(bytes: &[u8]) -> Vec<u8> {
    let runs = bytes.split(|byte| *byte == 0);
    runs.flat_map(|run| [run.len() as u8 + 1].into_iter().chain(run.iter().copied())).collect()
}

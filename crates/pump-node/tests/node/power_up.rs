//! Nothing moves by itself, and no pin is an output before the host says so.

use pump_link::frame::{Encoded, RequestHeader, VERSION};
use pump_link::message::{Answer, AxisConfig, AxisState, Refusal, Request};
use pump_node::Levels;

use super::direct::{Direct, Edge, SESSION, config_with, order};

#[test]
fn a_node_touches_no_pin_before_an_axis_is_configured() {
    let mut direct = Direct::new();
    direct.run_to(2_000_000);
    let Answer::Identity(identity) = direct.ask_as(0, &Request::Identify) else { panic!() };
    assert_eq!((identity.board, identity.firmware, identity.axes, identity.queue), (7, [1, 2, 3], 4, 32));
    assert_eq!((identity.tick_hz, identity.max_step_hz), (1_000_000, 100_000));
    let moves = [1; 4];
    for request in [
        Request::Prepare { axis: 0, move_number: 1, order: order(0, 10) },
        Request::Segments { axis: 0, move_number: 1, first: 0, packed: &[20, 1, 1] },
        Request::Begin { at: 2_100_000, moves },
        Request::Stop { moves },
        Request::Configure { axis: 0, revision: 1, config: AxisConfig::new(1) },
    ] {
        assert_eq!(direct.refused(&request), Refusal::Session);
    }
    assert_eq!(direct.ask_as(0, &Request::Adopt { dead_man_ms: 500 }), Answer::Refused(Refusal::Session));
    assert_eq!(direct.refused(&Request::Adopt { dead_man_ms: 99 }), Refusal::DeadMan);
    assert_eq!(direct.refused(&Request::Adopt { dead_man_ms: 10_001 }), Refusal::DeadMan);
    assert_eq!(direct.node.session(), 0);
    assert_eq!(direct.ask(&Request::Adopt { dead_man_ms: 500 }), Answer::Adopted);
    let prepare = Request::Prepare { axis: 0, move_number: 1, order: order(0, 10) };
    assert_eq!(direct.refused(&prepare), Refusal::NotConfigured);
    assert_eq!(direct.refused(&Request::Begin { at: 2_100_000, moves }), Refusal::NotConfigured);
    direct.run_to(3_000_000);
    assert!(direct.with(|hardware| hardware.edges.is_empty()));
}

#[test]
fn an_unknown_version_is_answered_by_its_number_and_does_nothing() {
    let mut direct = Direct::configured(1);
    direct.go(0, 1, 3);
    let begun = direct.now();
    let header = RequestHeader { number: 9, session: SESSION };
    let frame = Encoded::request(header, &Request::Stop { moves: [1, 0, 0, 0] }).unwrap();
    // The frame anew with another version, by hand: COBS of payload and CRC.
    let mut decoded = frame.bytes()[1..frame.bytes().len() - 1].to_vec();
    let len = cobs_decode(&mut decoded);
    let mut payload = decoded[..len - 4].to_vec();
    payload[0] = 9;
    payload.extend(crc32(&payload).to_le_bytes());
    let answers = direct.bytes(&[&[0], &cobs_encode(&payload)[..], &[0]].concat());
    assert_eq!(answers, [Answer::Refused(Refusal::Version { known: VERSION })]);
    // With another checksum nothing is answered.
    payload[0] = VERSION;
    assert!(direct.bytes(&[&[0], &cobs_encode(&payload)[..], &[0]].concat()).is_empty());
    assert_eq!(direct.status(0).state, AxisState::Moving);
    // Neither feeds the dead-man timer.
    direct.run_to(begun + 480_000);
    assert_eq!(direct.status(0).position, 30);
}

#[test]
fn levels_are_set_before_pins_are_outputs_and_before_enable() {
    let mut direct = Direct::configured(0);
    let mut config = AxisConfig::new(0);
    (config.step_active_low, config.reversed, config.enable_active_low) = (true, true, false);
    direct.configure(2, config);
    // Step rests high, a low direction pin is forward, and the motor is let go.
    let rest = Levels { step: true, direction: false, enable: false };
    assert_eq!(direct.with(|hardware| hardware.edges.clone()), [(0, 2, Edge::Outputs(rest))]);
    config.energised = true;
    direct.configure(2, config);
    let edges = direct.with(|hardware| hardware.edges.split_off(1));
    assert_eq!(edges, [(0, 2, Edge::Outputs(rest)), (0, 2, Edge::Enable(true))]);
    // A motor that holds is not let go by another configuration.
    config.step_high_ns = 5_000;
    direct.configure(2, config);
    let held = Levels { enable: true, ..rest };
    let edges = direct.with(|hardware| hardware.edges.split_off(1));
    assert_eq!(edges, [(0, 2, Edge::Outputs(held)), (0, 2, Edge::Enable(true))]);
    let status = direct.status(2);
    assert!(status.energised && status.state == AxisState::Ready && status.revision == 3);
}

#[test]
fn a_configuration_that_came_before_is_ignored_and_an_older_one_refused() {
    let mut direct = Direct::configured(1);
    let config = AxisConfig::new(1);
    assert!(matches!(
        direct.ask(&Request::Configure { axis: 0, revision: 1, config }),
        Answer::Configured { .. }
    ));
    direct.configure(0, config);
    let old = Request::Configure { axis: 0, revision: 1, config };
    assert_eq!(direct.refused(&old), Refusal::Old { newest: 2 });
    let bad = config_with(|config| config.step_high_ns = 100_001);
    assert_eq!(direct.refused(&Request::Configure { axis: 0, revision: 3, config: bad }), Refusal::Config);
    let none = AxisConfig::new(0);
    assert_eq!(direct.refused(&Request::Configure { axis: 0, revision: 3, config: none }), Refusal::Config);
    assert_eq!(
        direct.refused(&Request::Configure { axis: 4, revision: 3, config }),
        Refusal::Axis { axes: 4 }
    );
    // Entries of a brake that speed up too late, or that slow down, make no brake.
    let entries = Request::Brake { axis: 0, revision: 3, first: 0, entries: &[2, 0x80, 0x80, 0x80, 0x10] };
    assert_eq!(direct.refused(&entries), Refusal::NotConfigured);
    assert_eq!(
        direct.ask(&Request::Configure { axis: 0, revision: 3, config }),
        Answer::Configured { brake_entries: 0 }
    );
    let reverse =
        Request::Brake { axis: 0, revision: 3, first: 0, entries: &[1, 0x80, 0x80, 0x80, 0x80, 0x80, 0x40] };
    assert_eq!(direct.refused(&reverse), Refusal::Brake { entries: 0 });
    assert_eq!(direct.status(0).revision, 2);
}

/// CRC-32/ISO-HDLC, bit by bit: the polynomial of IEEE 802.3, reflected.
fn crc32(bytes: &[u8]) -> u32 {
    let mut sum = u32::MAX;
    for byte in bytes {
        sum ^= u32::from(*byte);
        for _ in 0..8 {
            sum = if sum & 1 == 1 { (sum >> 1) ^ 0xedb8_8320 } else { sum >> 1 };
        }
    }
    !sum
}

/// COBS of fewer than 255 bytes.
fn cobs_encode(plain: &[u8]) -> Vec<u8> {
    let mut coded = Vec::new();
    for part in plain.split(|byte| *byte == 0) {
        coded.push(part.len() as u8 + 1);
        coded.extend(part);
    }
    coded
}

fn cobs_decode(coded: &mut Vec<u8>) -> usize {
    let (mut plain, mut at) = (Vec::new(), 0);
    while at < coded.len() {
        let end = at + usize::from(coded[at]);
        plain.extend(&coded[at + 1..end]);
        if end < coded.len() {
            plain.push(0);
        }
        at = end;
    }
    *coded = plain;
    coded.len()
}

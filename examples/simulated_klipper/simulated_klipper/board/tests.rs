//! Claims about the board, played by a host that sends blocks and lets ticks pass.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::super::codec::{Argument, framed};
use super::super::options::{Character, IndexSensor, SOCKETS};
use super::Board;

/// Step pin, direction pin and enable pin of the socket X, and a pin with an index sensor.
const X: [u32; 3] = [29, 28, 30];
const INDEX: u32 = 32;

/// Ticks of a second.
const HZ: u64 = 1_000_000;

/// Host of a board.
struct Host {
    board: Board,
    sequence: u8,
}

fn character() -> Character {
    let index = Some(IndexSensor { pin: INDEX, socket: 0, steps: 100 });
    Character { hz: HZ as u32, slots: 4, index, ..Character::default() }
}

impl Host {
    fn new() -> Self {
        Self::of(character())
    }

    fn of(character: Character) -> Self {
        let mut host = Self { board: Board::new(character, 0), sequence: 0 };
        assert_eq!(host.heard(), ["starting"]);
        host
    }

    /// Returns what the board has said since, an acknowledgement as its sequence number.
    fn heard(&mut self) -> Vec<String> {
        let bytes = std::mem::take(&mut self.board.outgoing);
        let mut rest = bytes.as_slice();
        let mut said = Vec::new();
        while let Some(length) = rest.first() {
            let (block, others) = rest.split_at(usize::from(*length));
            rest = others;
            let content = &block[2..block.len() - 3];
            assert_eq!(framed(block[1] & 0xf, content), block);
            if content.is_empty() {
                said.push(format!("#{}", block[1] & 0xf));
            } else {
                let (name, arguments) = self.board.dictionary.read(content);
                let arguments = arguments.iter().map(|argument| match argument {
                    Argument::Number(number) => format!(" {}", number.cast_signed()),
                    Argument::Bytes(bytes) => format!(" {bytes:02x?}"),
                });
                said.push(name.to_owned() + &arguments.collect::<String>());
            }
        }
        said
    }

    /// Sends a block of commands, such as `get_clock`, and returns the answers without the acknowledgement.
    fn send(&mut self, commands: &[&str]) -> Vec<String> {
        let content: Vec<u8> = commands.iter().flat_map(|command| self.written(command)).collect();
        framed(self.sequence, &content).into_iter().for_each(|byte| self.board.hear(byte));
        self.sequence = (self.sequence + 1) & 0xf;
        let mut said = self.heard();
        assert_eq!(said.pop(), Some(format!("#{}", self.sequence)));
        said
    }

    fn written(&self, command: &str) -> Vec<u8> {
        let mut words = command.split(' ');
        let name = words.next().unwrap();
        let arguments = words.map(|word| match word.strip_prefix("0x") {
            Some(hex) => Argument::Bytes(
                (0..hex.len()).step_by(2).map(|k| u8::from_str_radix(&hex[k..k + 2], 16).unwrap()).collect(),
            ),
            None => Argument::Number(word.parse::<i64>().unwrap() as u32),
        });
        self.board.dictionary.written(name, &arguments.collect::<Vec<_>>())
    }

    /// Configures a stepper with number 0, its enable line with 1, a trigger group with 2, and an index with 3.
    fn configured(mut self) -> Self {
        let [step, dir, enable] = X;
        let said = self.send(&[
            "allocate_oids 5",
            &format!("config_stepper 0 {step} {dir} 0 2"),
            &format!("config_digital_out 1 {enable} 1 1 0"),
            "config_trsync 2",
            &format!("config_endstop 3 {INDEX} 0"),
        ]);
        assert!(said.is_empty(), "{said:?}");
        let said = self.send(&["config_tmcuart 4 43 0 42 25", "finalize_config 123456"]);
        assert_eq!(said, ["config 1 123456 0 4"]);
        self.send(&["update_digital_out 1 0"]);
        self
    }

    /// Lets ticks pass. Returns what the board has said meanwhile.
    fn pass(&mut self, to: u64) -> Vec<String> {
        self.board.advance(to);
        self.board.read = to;
        self.heard()
    }

    fn made(&mut self) -> Vec<(u64, bool)> {
        std::mem::take(&mut self.board.made).iter().map(|step| (step.at, step.is_forward)).collect()
    }
}

#[test]
fn the_dictionary_comes_in_pieces() {
    let mut host = Host::new();
    let mut pieces = Vec::new();
    loop {
        let said = host.send(&[&format!("identify {} 40", pieces.len())]);
        let (offset, bytes) = said[0].strip_prefix("identify_response ").unwrap().split_once(' ').unwrap();
        assert_eq!(offset.parse::<usize>().unwrap(), pieces.len());
        let bytes = bytes.trim_matches(['[', ']']);
        if bytes.is_empty() {
            break;
        }
        pieces.extend(bytes.split(", ").map(|byte| u8::from_str_radix(byte, 16).unwrap()));
    }
    assert_eq!(pieces, host.board.dictionary.text);
}

#[test]
fn moves_are_made_at_their_ticks_in_their_direction() {
    let mut host = Host::new().configured();
    host.send(&["reset_step_clock 0 1000", "set_next_step_dir 0 1", "queue_step 0 100 3 10"]);
    host.send(&["set_next_step_dir 0 0", "queue_step 0 500 2 0"]);
    assert_eq!(host.board.used, 1);
    host.pass(1210);
    assert_eq!(host.send(&["stepper_get_position 0"]), ["stepper_position 0 2"]);
    host.pass(5000);
    let steps = [(1100, true), (1210, true), (1330, true), (1830, false), (2330, false)];
    assert_eq!(host.made(), steps);
    assert_eq!((host.board.steps[0], host.board.stray, host.board.used), (1, 0, 0));
    assert_eq!(host.send(&["stepper_get_position 0"]), ["stepper_position 0 1"]);
    // After the last step the next interval counts from it.
    host.send(&["queue_step 0 3000 1 0"]);
    host.pass(6000);
    assert_eq!(host.made(), [(5330, false)]);
}

#[test]
fn a_motor_without_current_makes_stray_steps() {
    let mut host = Host::new().configured();
    host.send(&["update_digital_out 1 1", "reset_step_clock 0 1000", "queue_step 0 100 3 0"]);
    host.pass(5000);
    assert_eq!(host.board.stray, 3);
}

/// Returns what a shutdown says of this reason.
fn reason(host: &Host) -> &'static str {
    host.board.shutdown.map_or("", super::super::dictionary::Reason::words)
}

#[test]
fn what_is_late_or_out_of_place_shuts_the_board_down() {
    let cases: [(&str, &[&str]); 9] = [
        ("Timer too close", &["reset_step_clock 0 1000", "queue_step 0 10 1 0"]),
        ("Invalid count parameter", &["queue_step 0 10 0 0"]),
        ("Invalid oid type", &["queue_step 1 10 1 0"]),
        ("Can't assign oid", &["config_trsync 0"]),
        ("Already finalized", &["finalize_config 1"]),
        ("oids already allocated", &["allocate_oids 9"]),
        ("Timer too close", &["trsync_start 2 1000 100 1"]),
        ("Command request", &["emergency_stop"]),
        ("config_reset only available when shutdown", &["config_reset"]),
    ];
    for (words, commands) in cases {
        let mut host = Host::new().configured();
        host.pass(5000);
        let said = host.send(commands);
        assert_eq!(reason(&host), words);
        assert!(said[0].starts_with("shutdown 5000 "), "{said:?}");
        assert!(host.send(&["reset_step_clock 0 9000"])[0].starts_with("is_shutdown "));
        assert_eq!(host.send(&["get_config"]), ["config 1 123456 1 4"]);
        host.send(&["config_reset"]);
        assert_eq!(host.send(&["get_config"]), ["config 0 0 0 0"]);
    }
}

#[test]
fn a_queue_that_overflows_shuts_the_board_down_and_motors_stop() {
    let mut host = Host::new().configured();
    host.send(&["reset_step_clock 0 1000"]);
    // One runs, and four wait.
    for _ in 0..5 {
        host.send(&["queue_step 0 100 2 0"]);
    }
    assert_eq!((reason(&host), host.board.most_used), ("", 4));
    host.pass(1150);
    host.send(&["queue_step 0 100 2 0"]);
    assert_eq!(reason(&host), "Move queue overflow");
    host.pass(9000);
    assert_eq!(host.made().len(), 1);
    assert_eq!(host.board.outputs.get(&X[2]), Some(&true));
    host.send(&["clear_shutdown"]);
    assert_eq!(host.send(&["stepper_get_position 0"]), ["stepper_position 0 -1"]);
}

#[test]
fn commands_before_the_configuration_are_refused() {
    for command in
        ["queue_step 0 10 1 0", "stepper_get_position 0", "config_trsync 0", "tmcuart_send 0 0x00 1"]
    {
        let mut host = Host::new();
        host.send(&[command]);
        assert_ne!(reason(&host), "", "{command}");
    }
}

#[test]
fn a_group_that_expires_stops_its_stepper_and_later_moves_are_dropped() {
    let mut host = Host::new().configured();
    host.send(&["trsync_start 2 10000 10000 4", "stepper_stop_on_trigger 0 2", "trsync_set_timeout 2 25050"]);
    host.send(&["reset_step_clock 0 20000", "set_next_step_dir 0 1", "queue_step 0 1000 50 0"]);
    assert_eq!(host.pass(24_000), ["trsync_state 2 1 0 10000", "trsync_state 2 1 0 20000"]);
    assert_eq!(host.pass(26_000), ["trsync_state 2 0 4 25050"]);
    host.send(&["queue_step 0 100 5 0"]);
    host.pass(29_999);
    assert_eq!((host.made().len(), host.board.steps[0]), (5, 5));
    assert_eq!(host.send(&["trsync_trigger 2 1"]), ["trsync_state 2 0 4 0"]);
    assert!(host.pass(90_000).is_empty());
    assert_eq!(reason(&host), "");
}

#[test]
fn an_index_sensor_stops_the_motor_at_its_mark() {
    let mut host = Host::new().configured();
    assert_eq!(host.send(&["endstop_query_state 3"]), ["endstop_state 3 0 0 0"]);
    host.send(&[
        "trsync_start 2 1000 0 4",
        "stepper_stop_on_trigger 0 2",
        "endstop_home 3 1000 5 4 100 1 2 1",
    ]);
    host.send(&["reset_step_clock 0 1000", "set_next_step_dir 0 1", "queue_step 0 1000 90 0"]);
    let said = host.pass(200_000);
    assert_eq!(said, ["trsync_state 2 0 1 51015"]);
    assert_eq!(host.board.steps[0], 50);
    assert_eq!(host.send(&["endstop_query_state 3"]), ["endstop_state 3 1 51100 1"]);
}

#[test]
fn an_output_that_is_left_away_from_its_default_shuts_the_board_down() {
    let mut host = Host::new();
    host.send(&["allocate_oids 1", "config_digital_out 0 5 1 1 3000", "finalize_config 7"]);
    host.send(&["queue_digital_out 0 1000 0", "queue_digital_out 0 3000 0"]);
    host.pass(5999);
    assert_eq!((reason(&host), host.board.outputs.get(&5)), ("", Some(&false)));
    let said = host.pass(6001);
    assert_eq!(reason(&host), "Missed scheduling of next digital out event");
    assert!(said[0].starts_with("shutdown 6000 "), "{said:?}");
    assert_eq!(host.board.outputs.get(&5), Some(&true));
}

#[test]
fn drivers_answer_on_their_line() {
    let mut host = Host::new().configured();
    // IOIN of the driver at address 0 (f5 00 06 and its checksum), each byte between its start and stop bit.
    let silent = host.send(&["tmcuart_send 4 0xea03c82094 10"]);
    assert!(silent.is_empty());
    // IOIN tells version 0x21: 05 ff 06 21 00 00 00 and its checksum. Both were packed by another program.
    let said = host.pass(20_000);
    assert_eq!(said, ["tmcuart_response 4 [0a, fa, cf, a0, 90, 00, 02, 08, a0, a0]"]);
}

#[test]
fn a_block_that_is_damaged_or_repeated_is_asked_for_again_and_obeyed_once() {
    let mut host = Host::new().configured();
    host.send(&["reset_step_clock 0 1000"]);
    let content = host.written("queue_step 0 100 1 0");
    let good = framed(host.sequence, &content);
    let mut bad = good.clone();
    bad[4] ^= 1;
    let wanted = format!("#{}", host.sequence);
    for (block, answers) in [(&bad, 1), (&good, 1), (&good, 1)] {
        block.iter().for_each(|byte| host.board.hear(*byte));
        let said = host.heard();
        assert_eq!(said.len(), answers, "{said:?}");
        assert_eq!(said[0] == wanted, block == &bad, "{said:?}");
    }
    host.pass(5000);
    assert_eq!(host.made(), [(1100, false)]);
}

#[test]
fn a_clock_tells_its_lower_32_bits_and_its_uptime_all() {
    let mut host = Host::new();
    let now = (3 << 32) + (1 << 31) + 9;
    host.board.now = now;
    host.board.stats_at = u64::MAX;
    host.board.read = now;
    assert_eq!(
        host.send(&["get_clock", "get_uptime"]),
        [format!("clock {}", i32::MIN + 9), format!("uptime 3 {}", i32::MIN + 9)]
    );
}

#[test]
fn a_board_that_is_late_has_made_the_steps_that_its_host_knows_to_be_made() {
    let mut host = Host::new().configured();
    host.send(&["trsync_start 2 0 0 7", "stepper_stop_on_trigger 0 2", "reset_step_clock 0 1000"]);
    host.send(&["trsync_set_timeout 2 9000", "queue_step 0 1000 5 0"]);
    // It looks at its line after all steps are due, and hears what was said meanwhile.
    host.board.read = 8000;
    assert_eq!(host.send(&["trsync_trigger 2 1"]), ["trsync_state 2 0 1 0"]);
    assert_eq!(host.send(&["stepper_get_position 0"]), ["stepper_position 0 -5"]);
}

#[test]
fn the_load_is_told_every_5_s() {
    let mut host = Host::new();
    assert_eq!(host.pass(5 * HZ - 1).len(), 0);
    assert_eq!(host.pass(10 * HZ), ["stats 5000 1000000 4096"; 2]);
}

#[test]
fn sockets_have_pins_of_their_own() {
    assert_eq!([SOCKETS[0].step, SOCKETS[0].enable], [X[0], X[2]]);
}

//! The dictionary that the board tells of itself: JSON, compressed by zlib (docs/Protocol.md, "Data Dictionary").

use serde_json::{Map, Value, json};

use super::codec::{Argument, Shape};
use super::options::Character;

/// Commands after `identify`, in the order of their numbers.
const COMMANDS: [&str; 29] = [
    "get_config",
    "allocate_oids count=%c",
    "finalize_config crc=%u",
    "get_clock",
    "get_uptime",
    "emergency_stop",
    "clear_shutdown",
    "config_reset",
    "reset",
    "set_digital_out pin=%u value=%c",
    "config_digital_out oid=%c pin=%u value=%c default_value=%c max_duration=%u",
    "queue_digital_out oid=%c clock=%u on_ticks=%u",
    "update_digital_out oid=%c value=%c",
    "config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c step_pulse_ticks=%u",
    "queue_step oid=%c interval=%u count=%hu add=%hi",
    "set_next_step_dir oid=%c dir=%c",
    "reset_step_clock oid=%c clock=%u",
    "stepper_get_position oid=%c",
    "stepper_stop_on_trigger oid=%c trsync_oid=%c",
    "config_trsync oid=%c",
    "trsync_start oid=%c report_clock=%u report_ticks=%u expire_reason=%c",
    "trsync_set_timeout oid=%c clock=%u",
    "trsync_trigger oid=%c reason=%c",
    "config_endstop oid=%c pin=%c pull_up=%c",
    "endstop_home oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u pin_value=%c trsync_oid=%c \
     trigger_reason=%c",
    "endstop_query_state oid=%c",
    "config_tmcuart oid=%c rx_pin=%u pull_up=%c tx_pin=%u bit_time=%u",
    "tmcuart_send oid=%c write=%*s read=%c",
    "debug_nop",
];

/// Responses after `identify_response`, whose numbers go on after those of the commands.
const RESPONSES: [&str; 11] = [
    "config is_config=%c crc=%u is_shutdown=%c move_count=%hu",
    "clock clock=%u",
    "uptime high=%u clock=%u",
    "stats count=%u sum=%u sumsq=%u",
    "shutdown clock=%u static_string_id=%hu",
    "is_shutdown static_string_id=%hu",
    "starting",
    "stepper_position oid=%c pos=%i",
    "trsync_state oid=%c can_trigger=%c trigger_reason=%c clock=%u",
    "endstop_state oid=%c homing=%c next_clock=%u pin_value=%c",
    "tmcuart_response oid=%c read=%*s",
];

/// Numbers of `identify` and its response, which every host knows.
const IDENTIFY: (&str, u32) = ("identify offset=%u count=%c", 1);
const IDENTIFY_RESPONSE: (&str, u32) = ("identify_response offset=%u data=%.*s", 0);

/// Number of the first command after `identify`, and of the first reason.
const FIRST: u32 = 2;

/// Reasons of a shutdown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reason {
    TooClose,
    TooFarInPast,
    Overflow,
    NoCount,
    Active,
    Oid,
    Assigned,
    Allocated,
    Finalized,
    Requested,
    NotShutdown,
    Cleared,
    NoCommand,
    Parser,
    MissedPin,
    LatePin,
    MixedPin,
    LongUart,
}

impl Reason {
    const ALL: [(Self, &'static str); 18] = [
        (Self::TooClose, "Timer too close"),
        (Self::TooFarInPast, "Stepper too far in past"),
        (Self::Overflow, "Move queue overflow"),
        (Self::NoCount, "Invalid count parameter"),
        (Self::Active, "Can't reset time when stepper active"),
        (Self::Oid, "Invalid oid type"),
        (Self::Assigned, "Can't assign oid"),
        (Self::Allocated, "oids already allocated"),
        (Self::Finalized, "Already finalized"),
        (Self::Requested, "Command request"),
        (Self::NotShutdown, "config_reset only available when shutdown"),
        (Self::Cleared, "Shutdown cleared when not shutdown"),
        (Self::NoCommand, "Invalid command"),
        (Self::Parser, "Command parser error"),
        (Self::MissedPin, "Missed scheduling of next digital out event"),
        (Self::LatePin, "Scheduled digital out event will exceed max_duration"),
        (Self::MixedPin, "update_digital_out not valid with active queue"),
        (Self::LongUart, "tmcuart data too large"),
    ];

    /// Returns the reason's number in messages.
    pub(super) fn id(self) -> u32 {
        let place = Self::ALL.iter().position(|(reason, _)| *reason == self).unwrap_or_default();
        place as u32 + FIRST
    }

    /// Returns the reason in words.
    pub(super) fn words(self) -> &'static str {
        Self::ALL.iter().find(|(reason, _)| *reason == self).map_or("", |(_, words)| words)
    }
}

/// Messages of a board with their numbers.
#[derive(Debug)]
pub(super) struct Dictionary {
    commands: Vec<(&'static str, Shape, u32)>,
    responses: Vec<(&'static str, Shape, u32)>,
    /// Compressed text.
    pub(super) text: Vec<u8>,
}

impl Dictionary {
    pub(super) fn new(character: &Character) -> Self {
        let numbered = |formats: &[&'static str], (first, first_id): (&'static str, u32), from: u32| {
            let rest = formats.iter().copied().zip(from..);
            std::iter::once((first, first_id))
                .chain(rest)
                .map(|(format, id)| (format, Shape::of(format), id))
                .collect()
        };
        let mut commands: Vec<_> = numbered(&COMMANDS, IDENTIFY, FIRST);
        commands.retain(|(_, shape, _)| character.lacks.as_deref() != Some(shape.name));
        let responses = numbered(&RESPONSES, IDENTIFY_RESPONSE, FIRST + COMMANDS.len() as u32);
        let mut dictionary = Self { commands, responses, text: Vec::new() };
        let text = dictionary.json(character).to_string();
        dictionary.text = miniz_oxide::deflate::compress_to_vec_zlib(text.as_bytes(), 9);
        dictionary
    }

    /// Returns the command of this number.
    pub(super) fn command(&self, id: u32) -> Option<&Shape> {
        self.commands.iter().find(|(_, _, number)| *number == id).map(|(_, shape, _)| shape)
    }

    /// Returns the bytes of a response.
    pub(super) fn response(&self, name: &str, arguments: &[Argument]) -> Vec<u8> {
        let (_, shape, id) = self
            .responses
            .iter()
            .find(|(_, shape, _)| shape.name == name)
            .expect("a response of the dictionary");
        shape.bytes(*id, arguments)
    }

    /// Returns the name and the arguments of a response, for a test that plays the host.
    #[cfg(test)]
    pub(super) fn read(&self, mut content: &[u8]) -> (&'static str, Vec<Argument>) {
        let (id, rest) = content.split_first().unwrap();
        content = rest;
        let (_, shape, _) = self.responses.iter().find(|(_, _, number)| *number == u32::from(*id)).unwrap();
        let arguments = shape.take(&mut content).unwrap();
        assert!(content.is_empty(), "one response in a block");
        (shape.name, arguments)
    }

    /// Returns the bytes of a command, for a test that plays the host.
    #[cfg(test)]
    pub(super) fn written(&self, name: &str, arguments: &[Argument]) -> Vec<u8> {
        let (_, shape, id) = self.commands.iter().find(|(_, shape, _)| shape.name == name).unwrap();
        shape.bytes(*id, arguments)
    }

    /// Returns the dictionary as a board's build makes it.
    fn json(&self, character: &Character) -> Value {
        let ids = |messages: &[(&'static str, Shape, u32)]| -> Map<String, Value> {
            messages.iter().map(|(format, _, id)| ((*format).to_owned(), json!(id))).collect()
        };
        let ports = ["PA", "PB", "PC", "PD"];
        let pins: Map<String, Value> = match character.chip {
            "rp2040" => Map::from_iter([("gpio0".to_owned(), json!([0, 30]))]),
            _ => (0..).zip(ports).map(|(n, port)| (format!("{port}0"), json!([16 * n, 16]))).collect(),
        };
        let reasons: Map<String, Value> =
            Reason::ALL.iter().map(|(reason, words)| ((*words).to_owned(), json!(reason.id()))).collect();
        json!({
            "app": character.app,
            "version": "v0.12.0-simulated",
            "build_versions": "gcc: () binutils: ()",
            "license": "GNU GPLv3",
            "commands": ids(&self.commands),
            "responses": ids(&self.responses),
            "enumerations": { "pin": pins, "static_string_id": reasons },
            "config": {
                "CLOCK_FREQ": character.hz,
                "MCU": character.chip,
                "SERIAL_BAUD": character.baud.max(1),
                "STATS_SUMSQ_BASE": 256,
                "RECEIVE_WINDOW": 192,
                "RESERVE_PINS_serial": "PA10,PA9",
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Character, Dictionary, Reason, Value};

    #[test]
    fn the_dictionary_unpacks_to_what_a_host_needs() {
        let dictionary = Dictionary::new(&Character::default());
        let text = miniz_oxide::inflate::decompress_to_vec_zlib(&dictionary.text).unwrap();
        let json: Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(json["app"], "Klipper");
        assert_eq!(json["commands"]["identify offset=%u count=%c"], 1);
        assert_eq!(json["responses"]["identify_response offset=%u data=%.*s"], 0);
        assert_eq!(json["config"]["CLOCK_FREQ"], 72_000_000);
        assert_eq!(json["enumerations"]["pin"]["PB0"], serde_json::json!([16, 16]));
        assert_eq!(json["enumerations"]["static_string_id"]["Timer too close"], Reason::TooClose.id());
        let ids =
            |room: &str| json[room].as_object().unwrap().values().map(|id| id.as_u64().unwrap()).collect();
        let (commands, responses): (Vec<u64>, Vec<u64>) = (ids("commands"), ids("responses"));
        let all: std::collections::BTreeSet<_> = commands.iter().chain(&responses).collect();
        assert_eq!(all.len(), commands.len() + responses.len());
    }

    #[test]
    fn a_command_that_the_firmware_lacks_is_not_in_it() {
        let lacks = Character { lacks: Some("queue_step".to_owned()), ..Character::default() };
        let (all, fewer) = (Dictionary::new(&Character::default()), Dictionary::new(&lacks));
        let queue_step = all.commands.iter().find(|(_, shape, _)| shape.name == "queue_step").unwrap().2;
        assert!(all.command(queue_step).is_some() && fewer.command(queue_step).is_none());
    }
}

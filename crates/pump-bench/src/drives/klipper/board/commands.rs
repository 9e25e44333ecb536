//! The commands that the drive needs of a board, and the answers to them.
//!
//! Source: Klipper3d/klipper, `docs/MCU_Commands.md`.

use std::sync::Arc;

use crate::drives::klipper::dictionary::{Dictionary, DictionaryError};
use crate::drives::klipper::protocol::Format;

/// Commands of a board, as its dictionary numbers them.
#[derive(Debug)]
pub(in crate::drives::klipper) struct Commands {
    pub(in crate::drives::klipper) get_config: Arc<Format>,
    pub(in crate::drives::klipper) allocate_oids: Arc<Format>,
    pub(in crate::drives::klipper) finalize_config: Arc<Format>,
    pub(in crate::drives::klipper) get_clock: Arc<Format>,
    pub(in crate::drives::klipper) get_uptime: Arc<Format>,
    pub(in crate::drives::klipper) emergency_stop: Arc<Format>,
    pub(in crate::drives::klipper) config_stepper: Arc<Format>,
    pub(in crate::drives::klipper) queue_step: Arc<Format>,
    pub(in crate::drives::klipper) set_next_step_dir: Arc<Format>,
    pub(in crate::drives::klipper) reset_step_clock: Arc<Format>,
    pub(in crate::drives::klipper) stepper_get_position: Arc<Format>,
    pub(in crate::drives::klipper) stepper_stop_on_trigger: Arc<Format>,
    pub(in crate::drives::klipper) config_trsync: Arc<Format>,
    pub(in crate::drives::klipper) trsync_start: Arc<Format>,
    pub(in crate::drives::klipper) trsync_set_timeout: Arc<Format>,
    pub(in crate::drives::klipper) trsync_trigger: Arc<Format>,
    pub(in crate::drives::klipper) config_digital_out: Arc<Format>,
    pub(in crate::drives::klipper) update_digital_out: Arc<Format>,
    pub(in crate::drives::klipper) config_endstop: Arc<Format>,
    pub(in crate::drives::klipper) endstop_home: Arc<Format>,
    pub(in crate::drives::klipper) endstop_query_state: Arc<Format>,
}

impl Commands {
    /// Finds the commands in a dictionary, and refuses one that lacks any of them or of their answers.
    pub(in crate::drives::klipper) fn of(dictionary: &Dictionary) -> Result<Self, DictionaryError> {
        for answer in [
            "config is_config=%c crc=%u is_shutdown=%c move_count=%hu",
            "clock clock=%u",
            "uptime high=%u clock=%u",
            "stepper_position oid=%c pos=%i",
            "trsync_state oid=%c can_trigger=%c trigger_reason=%c clock=%u",
            "endstop_state oid=%c homing=%c next_clock=%u pin_value=%c",
        ] {
            dictionary.response(answer)?;
        }
        let command = |wanted| dictionary.command(wanted);
        Ok(Self {
            get_config: command("get_config")?,
            allocate_oids: command("allocate_oids count=%c")?,
            finalize_config: command("finalize_config crc=%u")?,
            get_clock: command("get_clock")?,
            get_uptime: command("get_uptime")?,
            emergency_stop: command("emergency_stop")?,
            config_stepper: command(
                "config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c step_pulse_ticks=%u",
            )?,
            queue_step: command("queue_step oid=%c interval=%u count=%hu add=%hi")?,
            set_next_step_dir: command("set_next_step_dir oid=%c dir=%c")?,
            reset_step_clock: command("reset_step_clock oid=%c clock=%u")?,
            stepper_get_position: command("stepper_get_position oid=%c")?,
            stepper_stop_on_trigger: command("stepper_stop_on_trigger oid=%c trsync_oid=%c")?,
            config_trsync: command("config_trsync oid=%c")?,
            trsync_start: command("trsync_start oid=%c report_clock=%u report_ticks=%u expire_reason=%c")?,
            trsync_set_timeout: command("trsync_set_timeout oid=%c clock=%u")?,
            trsync_trigger: command("trsync_trigger oid=%c reason=%c")?,
            config_digital_out: command(
                "config_digital_out oid=%c pin=%u value=%c default_value=%c max_duration=%u",
            )?,
            update_digital_out: command("update_digital_out oid=%c value=%c")?,
            config_endstop: command("config_endstop oid=%c pin=%c pull_up=%c")?,
            endstop_home: command(
                "endstop_home oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u pin_value=%c \
                 trsync_oid=%c trigger_reason=%c",
            )?,
            endstop_query_state: command("endstop_query_state oid=%c")?,
        })
    }
}

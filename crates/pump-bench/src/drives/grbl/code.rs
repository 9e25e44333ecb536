//! grbl's error and alarm codes in words. Source: grbl 1.1, doc/csv/error_codes_en_US.csv and
//! alarm_codes_en_US.csv.

/// Returns the meaning of `error:<code>`.
pub(super) fn error_text(code: u16) -> &'static str {
    match code {
        1 => "a word without its letter",
        2 => "a number that it cannot read",
        3 => "it does not know this command",
        4 => "a value must not be negative",
        5 => "homing is off",
        6 => "the step pulse is too short",
        7 => "its settings could not be read and are the usual ones again",
        8 => "only possible while it stands idle",
        9 => "locked by an alarm or by a jog",
        10 => "soft limits need homing",
        11 => "the line is too long",
        12 => "more steps a second than it can make",
        13 => "the safety door is open",
        14 => "the line is too long to be stored",
        15 => "beyond the travel that its soft limits allow",
        16 => "not a jog",
        17 => "laser mode needs PWM",
        20 => "it does not know this G-code",
        21 => "two G-codes of one group",
        22 => "no feed rate",
        23 => "not a whole number",
        24 => "two G-codes that use the axes",
        25 => "a word twice",
        26 => "no axis in it",
        27 => "not a line number",
        28 => "a value is missing",
        29 => "no such coordinate system",
        30 => "G53 without G0 or G1",
        31 => "an axis that nothing uses",
        32 => "an arc without an axis",
        33 => "a target that cannot be",
        34 => "an arc with an impossible radius",
        35 => "an arc without its centre",
        36 => "a value that nothing uses",
        37 => "a tool offset on another axis",
        38 => "no such tool",
        _ => "see the manual of its firmware",
    }
}

/// Returns the meaning of `ALARM:<code>`, and advice.
pub(super) fn alarm_text(code: u16) -> &'static str {
    match code {
        0 => "the line that says why did not arrive",
        1 => "a limit switch was hit and the motor was stopped at once; a pump needs none: set $21=0",
        2 => "the target is beyond the travel of its soft limits; set $20=0",
        3 => "it was reset in motion",
        4 => "the index sensor answers already; jog the rotor off it",
        5 => "the index sensor was not found",
        6 => "homing was interrupted by a reset",
        7 => "homing was interrupted by the safety door",
        8 => "homing did not get off its switch",
        9 => "homing did not find its switch",
        10 => "an emergency stop",
        13 | 17 => "a hard stop or a motor's fault",
        _ => "see the manual of its firmware",
    }
}

/// Returns true if the alarm stopped the motor at once, or may have, so that the motor may have turned on.
///
/// Soft limits (2) decelerate first, and a search (4, 5) has ended. Alarms of other firmwares are unknown and
/// count.
pub(super) fn stops_at_once(alarm: u16) -> bool {
    !matches!(alarm, 2 | 4 | 5)
}

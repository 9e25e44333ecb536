//! Bytes that one end of a line sends at another rate than the other end reads.

/// Returns the bytes that a serial port at `read_baud` reads where another one sends these at `sent_baud`: a start bit,
/// eight bits from the lowest, and a stop bit. The port looks at the middle of each bit, counted from the edge of the
/// start bit, and drops a byte without its stop bit.
pub(super) fn misread(bytes: &[u8], sent_baud: u32, read_baud: u32) -> Vec<u8> {
    let bits_of =
        |byte: &u8| (0..10).map(|n| (0x200 | u16::from(*byte) << 1) >> n & 1 == 1).collect::<Vec<_>>();
    let levels: Vec<bool> = bytes.iter().flat_map(bits_of).collect();
    let is_high = |time_s: f64| levels.get((time_s * f64::from(sent_baud)) as usize).copied().unwrap_or(true);
    let (ends_s, bit_s) = (levels.len() as f64 / f64::from(sent_baud), 1.0 / f64::from(read_baud));
    // The port looks for a start bit 16 times a bit.
    let (mut at_s, look_s) = (0.0, bit_s / 16.0);
    let mut read = Vec::new();
    while at_s < ends_s {
        if is_high(at_s) {
            at_s += look_s;
            continue;
        }
        let byte =
            (0..8).fold(0, |byte, n| byte | u8::from(is_high(at_s + (1.5 + f64::from(n)) * bit_s)) << n);
        at_s += 9.5 * bit_s;
        if is_high(at_s) {
            read.push(byte);
        } else {
            while !is_high(at_s) {
                at_s += look_s;
            }
        }
    }
    read
}

//! The microsteps that drivers of stepper motors have.

/// Microsteps per full step that most motor drivers have, as Allegro A4988 (to 16), TI DRV8825 (to 32) and Trinamic
/// TMC2209 (to 256).
pub(crate) const POWERS: [u32; 9] = [1, 2, 4, 8, 16, 32, 64, 128, 256];

/// Microsteps that drivers with decimal switches have besides, as Leadshine DM542 (1000 to 25,000 steps of a motor with
/// 200 full steps), and 200 and 250 of finer ones.
pub(crate) const DECIMAL: [u32; 10] = [5, 10, 20, 25, 40, 50, 100, 125, 200, 250];

/// Returns true for microsteps that a usual motor driver has.
pub(super) fn is_usual(microsteps: u32) -> bool {
    POWERS.contains(&microsteps) || DECIMAL.contains(&microsteps)
}

/// Returns the microsteps that usual motor drivers have, in words.
pub(super) fn usual_in_words() -> String {
    let listed = |steps: &[u32]| steps.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    format!("{}, or {}", listed(&POWERS), listed(&DECIMAL))
}

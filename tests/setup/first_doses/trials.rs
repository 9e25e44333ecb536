//! Trials of a motor with a built-in pump, before it has a pump file of its own.

use std::path::Path;

use crate::person::Desk;
use crate::simulated_node::SimulatedNode;

/// Options that set a pump up without a question or a motion.
const OPTIONS: [&str; 16] = [
    "--ml-per-rev",
    "0.5mL",
    "--rollers",
    "4",
    "--microsteps",
    "16",
    "--altitude",
    "500m",
    "--driver",
    "node",
    "--rate",
    "0.6mL/s",
    "--direction",
    "forward",
    "--no-motion",
    "--yes",
];

#[test]
fn a_trial_with_a_built_in_pump_keeps_no_axis_from_a_pump_of_the_users_own() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let port = board.path().to_str().unwrap();
    let trial = ["0.2mL", "--pump", "three-roller", "--confirm-pump", "--driver", "node", "--port", port];
    assert_eq!(desk.types(&trial).code, 0);
    let set_up = |name: &str| desk.types(&[&["setup", name, "--port", port][..], &OPTIONS].concat());
    let acid = set_up("acid");
    let first = "axis X: the first of this board that turns no other pump";
    let place =
        "the axis X turned the pump `three-roller` by the record: `acid` takes its place, since a built-in";
    assert!(acid.code == 0 && acid.err.contains(first) && acid.err.contains(place), "{}", acid.err);
    assert!(acid.err.contains("pins    those of a DRV8825, without its fault output"), "{}", acid.err);
    // A pump of the user's own keeps its axis, and a trial is refused in its turn.
    let base = set_up("base");
    assert!(
        base.err.contains("acid has the axis X") && base.err.contains("axis Y: the first"),
        "{}",
        base.err
    );
    let again = desk.types(&trial);
    let refused = "error: the axis X of the board";
    assert!(again.code == 2 && again.err.contains(refused), "{}", again.err);
    // A pump file that setup did not write takes the place of a trial as well.
    let trial_on = |name: &str, id: &str, axis: &str| {
        let shown = desk.types(&["pumps", "show", "three-roller"]).out;
        let shown = shown.replace("id = \"three-roller\"", &format!("id = \"{id}\""));
        let drive = format!("\n[drive]\ndriver = \"node\"\nport = \"{port}\"\naxis = \"{axis}\"\n");
        std::fs::write(desk.path(name), shown + &drive).unwrap();
        desk.types(&["0.2mL", "--confirm-pump", "--pump", name])
    };
    let on_z = trial_on("trial.toml", "two-roller", "Z");
    assert_eq!(on_z.code, 0, "{}", on_z.err);
    let lime = trial_on("lime.toml", "lime", "Z");
    let said = "the axis turned pump `two-roller` by the record; it turns this pump on record from its first \
         motion on; a built-in pump";
    assert!(lime.code == 0 && (lime.err + &lime.out).contains(said), "{}", lime.out);
}

#[test]
fn a_refusal_of_this_program_does_not_say_that_the_device_refused() {
    let desk = Desk::new();
    for port in ["/dev/null", "/dev/ttyACM99"].map(Path::new) {
        let on = ["0.2mL", "--confirm-pump", "--driver", "node", "--port", port.to_str().unwrap()];
        let ended = desk.types(&on);
        let said = format!("error: {} cannot be opened", port.display());
        assert!(ended.code != 0 && ended.err.contains(&said), "{}", ended.err);
    }
}

//! A second pump on the same board: what is known of the first is suggested.

use crate::person::Desk;
use crate::truth::TruePump;

#[test]
fn a_second_pump_takes_what_is_known_of_the_first() {
    let desk = Desk::new();
    let pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let port = pump.port();
    let first = [
        "setup",
        "acid",
        "--ml-per-rev",
        "0.5mL",
        "--rollers",
        "4",
        "--microsteps",
        "16",
        "--gear",
        "3",
        "--driver",
        "grbl",
        "--port",
        &port,
        "--axis",
        "X",
        "--altitude",
        "1200m",
        "--suction-lift",
        "0.2m",
        "--rate",
        "0.3mL/s",
        "--yes",
        "--no-motion",
    ];
    assert_eq!(desk.types(&first).code, 0);
    // Everything is as suggested, until the motor is asked for.
    let ended = desk.answers(&["setup", "base", "--no-motion"], &mut |_| Some(String::new()));
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("Suggested answers are those of `acid`"), "{}", ended.err);
    for said in
        ["Rollers, counted [4, as of acid]", "acid has the axis X of this board", "turns this pump [Y]"]
    {
        assert!(ended.err.contains(said), "{said}: {}", ended.err);
    }
    let [acid, base] = ["acid", "base"].map(|name| desk.configured(&format!("pumps/{name}.toml")).unwrap());
    assert_eq!(acid.replace("\"acid\"", "\"base\"").replace("axis = \"X\"", "axis = \"Y\""), base);
    let config = desk.configured("config.toml").unwrap();
    assert!(
        config.contains("default_pump = \"acid\"") && config.contains("base = \"pumps/base.toml\""),
        "{config}"
    );
    assert!(ended.asked.len() <= 16, "{:?}", ended.asked);
    // A pump that differs in its axis alone is said to be like the first.
    let like = desk.types(&["setup", "lime", "--like", "acid", "--axis", "Z", "--no-motion", "--yes"]);
    assert_eq!(like.code, 0, "{}", like.err);
    let lime = desk.configured("pumps/lime.toml").unwrap();
    assert_eq!(acid.replace("\"acid\"", "\"lime\"").replace("axis = \"X\"", "axis = \"Z\""), lime);
    let none = desk.types(&["setup", "plum", "--like", "nobody", "--yes"]);
    assert!(none.code == 2 && none.err.contains("no pump `nobody` was set up"), "{}", none.err);
    // An axis that the first pump has is not taken.
    let mut is_first = true;
    let taken = desk.answers(&["setup", "salt", "--no-motion"], &mut |question| match question {
        q if q.starts_with("Axis") => std::mem::take(&mut is_first).then(|| "X".to_owned()),
        _ => Some(String::new()),
    });
    assert!(taken.err.contains("X is that of acid; choose another axis"), "{}", taken.err);
}

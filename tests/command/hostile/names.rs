//! Names from files: they cannot steer the terminal.

use std::fs;

use crate::user::User;

#[test]
fn control_characters_of_a_pump_file_are_shown_and_not_obeyed() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    let start = three.find("\nname = ").unwrap() + 1;
    let end = start + three[start..].find('\n').unwrap();
    let name = "name = \"evil\\u001b[2J\\u001b]0;owned\\u0007\\u009b1m\\r\\u202e\"";
    fs::write(user.path("evil.toml"), format!("{}{name}{}", &three[..start], &three[end..])).unwrap();
    let shown = user.types(&["pumps", "check", "evil.toml"]);
    assert_eq!(shown.code, 0, "{}", shown.err);
    assert!(shown.out.contains("evil\\u{1b}[2J\\u{1b}]0;owned\\u{7}\\u{9b}1m\\r\\u{202e}"), "{}", shown.out);
    fs::write(user.path("bad.toml"), three.replace("schema = \"pump/1\"", "schema = \"\\u001b[2J\""))
        .unwrap();
    let refused = user.is_refused(&["1mL", "--pump", "bad.toml"]);
    assert!(refused.contains("schema is `\\u{1b}[2J`"), "{refused}");
    let unknown = user.is_refused(&["1mL", "--pump", "bad\u{1b}[2J.toml"]);
    assert!(unknown.contains("bad\\u{1b}[2J.toml"), "{unknown}");
    let name = "name = \"evil\\nuse std::process;\"";
    fs::write(user.path("evil.toml"), format!("{}{name}{}", &three[..start], &three[end..])).unwrap();
    let source = user.types(&["pumps", "show", "evil.toml", "--format", "rust"]).out;
    assert!(source.starts_with("// evil\\nuse std::process; (three-roller), for"), "{source}");
    for text in [shown.out, refused, unknown] {
        assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{text:?}");
    }
}

#[test]
fn json_escapes_what_would_steer_a_terminal_and_keeps_the_name() {
    let user = User::new();
    let steers = |text: &str| {
        text.contains(|c: char| c.is_control() && c != '\n') || text.contains(['\u{202e}', '\u{2066}'])
    };
    let name = "bad\u{9b}31m\u{202e}\u{7f}.toml";
    let refused = user.types(&["1mL", "--pump", name, "--format", "json"]);
    assert_eq!(refused.code, 2, "{}", refused.err);
    assert!(!steers(&refused.err), "{:?}", refused.err);
    let error: serde_json::Value = serde_json::from_str(refused.err.lines().last().unwrap()).unwrap();
    assert!(error["message"].as_str().unwrap().contains(name), "{error}");

    let evil = "evil\u{9b}31m\u{202e}\u{7f}.toml";
    let config = "schema = \"config/1\"\n[pumps]\nmine = \"evil\\u009b31m\\u202e\\u007f.toml\"\n";
    fs::write(user.path("config.toml"), config).unwrap();
    let list = user.types(&["pumps", "list", "--config", "config.toml", "--format", "json"]);
    assert_eq!(list.code, 0, "{}", list.err);
    assert!(!steers(&list.out) && !steers(&list.err), "{:?}", list.out);
    let list: serde_json::Value = serde_json::from_str(&list.out).unwrap();
    assert!(list["configured"][0]["file"].as_str().unwrap().ends_with(evil), "{list}");
}

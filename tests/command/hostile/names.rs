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

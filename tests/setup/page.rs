//! docs/setup.md shows what the command prints.

use std::fs::{self, File};
use std::io::{self, Read, Write};

use rustix::pty::{self, OpenptFlags};

use crate::person::{Desk, pieces};

/// The page.
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/setup.md");

/// Begin of the transcript in the page.
const COMMAND: &str = "```text\n$ dose setup acid\n";

/// Answers of the page; everything else is as suggested.
const ANSWERS: [(&str, &str); 9] = [
    ("Head:", "0.5mL"),
    ("Bore", "1.6mm"),
    ("Rollers", "4"),
    ("Microsteps", "16"),
    ("Driver", "sim"),
    ("Altitude", "500m"),
    ("Height of the pump", "0.3m"),
    ("Volume of the dose", "5mL"),
    ("Reading", "4.93g"),
];

/// Opens a terminal. Returns the person's end and the command's.
fn terminal() -> io::Result<(File, File)> {
    let person = pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
    pty::grantpt(&person)?;
    pty::unlockpt(&person)?;
    let name = pty::ptsname(&person, Vec::new())?;
    let command = File::options().read(true).write(true).open(name.to_str().unwrap())?;
    Ok((File::from(person), command))
}

/// Makes the course with these answers. Returns everything that stands on the terminal.
fn transcript() -> String {
    let desk = Desk::new();
    let mut command = desk.command(&["setup", "acid"]);
    let (reader, writer) = io::pipe().unwrap();
    let (mut input, stdin) = terminal().unwrap();
    command.env("COLUMNS", "100").stdin(stdin);
    command.stdout(writer.try_clone().unwrap()).stderr(writer);
    let mut child = command.spawn().unwrap();
    // The command alone keeps the other end open.
    drop(command);
    let mut said = String::new();
    let boxed: Box<dyn Read + Send> = Box::new(reader);
    for piece in pieces(boxed) {
        said.push_str(&piece);
        if !said.ends_with(": ") {
            continue;
        }
        let question = said.lines().next_back().unwrap();
        let answer =
            ANSWERS.iter().find(|(start, _)| question.starts_with(start)).map_or("", |(_, answer)| answer);
        writeln!(input, "{answer}").unwrap();
        // The terminal shows what is typed.
        said.push_str(&format!("{answer}\n"));
    }
    assert!(child.wait().unwrap().success(), "{said}");
    let folder = desk.path("config").display().to_string();
    said.replace(&folder, "~/.config").lines().map(|line| format!("{}\n", line.trim_end())).collect()
}

#[test]
fn the_page_shows_what_the_command_prints() {
    let page = fs::read_to_string(PAGE).unwrap();
    let from = page.find(COMMAND).expect("the page shows the command") + COMMAND.len();
    let to = from + page[from..].find("```").unwrap();
    let now = transcript();
    if std::env::var("TRYCMD").is_ok_and(|word| word == "overwrite") {
        fs::write(PAGE, format!("{}{now}{}", &page[..from], &page[to..])).unwrap();
        return;
    }
    assert_eq!(page[from..to], now, "TRYCMD=overwrite writes the page anew");
}

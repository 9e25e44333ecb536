//! The process that doses and is killed. It prints the number of steps made from time to time.

use std::env;
use std::io::{Read, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use pump_bench::pump_file::DriverName;
use pump_bench::{Bench, DoseRequest, built_in};

/// Doses, or resumes a dose (0 mL), and prints its progress. The arguments are `<folder> <volume> [<port>]`.
pub(crate) fn main(arguments: &[String]) {
    let [folder, volume_ml, port @ ..] = arguments else { panic!("{arguments:?}") };
    let driver = (!port.is_empty()).then_some(DriverName::Grbl);
    let bench = Bench::new(built_in("three-roller").unwrap(), driver, Path::new(folder)).unwrap();
    let bench = bench.at_port(port.first().map(Into::into));
    let mut session = bench.session().unwrap();
    let request = DoseRequest::dose(volume_ml.parse().unwrap());
    let prepared =
        if request.volume_ml == 0.0 { session.prepare_rest(request) } else { session.prepare(request) };
    let prepared = match prepared {
        Ok(prepared) => prepared,
        Err(error) => return println!("refused: {error}"),
    };
    say("begin", prepared.plan.steps.unsigned_abs());
    let delivered = session.run(&prepared, |made| {
        say("made", made);
        ControlFlow::Continue(())
    });
    match delivered {
        Ok(delivered) => say("end", delivered.made),
        Err(error) => {
            say("failed", 0);
            println!("{error}");
        }
    }
}

/// Prints a line in one write, so that a kill leaves a whole line or none.
fn say(word: &str, number: u64) {
    let line = format!("{word} {number}\n");
    std::io::stdout().write_all(line.as_bytes()).and_then(|()| std::io::stdout().flush()).unwrap();
}

/// Starts the process. If `bytes` is given, the disk is full after so many bytes of the journal.
pub(crate) fn start(folder: &Path, volume_ml: f64, bytes: Option<u64>, port: Option<&Path>) -> Child {
    let this = env::current_exe().unwrap();
    let mut command = match bytes {
        None => Command::new(&this),
        Some(bytes) => {
            // The shell ignores the signal, so a write beyond the limit fails as on a full disk.
            let mut shell = Command::new("bash");
            let script = "trap '' XFSZ; prlimit --fsize=$0 --pid $$; exec \"$@\"";
            shell.args(["-c", script, &bytes.to_string()]).arg(&this);
            shell
        }
    };
    command.arg("child").arg(folder).arg(volume_ml.to_string()).args(port);
    command.stdout(Stdio::piped()).spawn().unwrap()
}

/// Returns the output of the process, once it has ended.
pub(crate) fn said(mut child: Child) -> String {
    let mut said = String::new();
    child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    child.wait().unwrap();
    said
}

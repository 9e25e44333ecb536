//! The process that doses and is killed. It prints the number of steps made from time to time.

use std::env;
use std::fs::File;
use std::io::{self, Read, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_bench::pump_file::DriverName;
use pump_bench::record::Storage;
use pump_bench::{Bench, DoseRequest, built_in};

use crate::random::Random;

/// Variable that says for how many milliseconds at most each sync of the journal takes longer.
const SYNC_MS: &str = "FAULTS_SYNC_MS";

/// Longest time between the announcement of a dose and a kill that waits for no step, s.
const SOON_S: f64 = 0.1;

/// Disk whose syncs take longer, each by another time.
#[derive(Debug)]
struct UnevenDisk {
    most_ms: f64,
    random: Random,
}

impl Storage for UnevenDisk {
    fn sync(&mut self, file: &File) -> io::Result<()> {
        sleep(Duration::from_secs_f64(1e-3 * self.most_ms * self.random.part()));
        file.sync_data()
    }
}

/// Doses, or resumes a dose (0 mL), and prints its progress. The arguments are `<folder> <volume> [<port>]`.
pub(crate) fn main(arguments: &[String]) {
    let [folder, volume_ml, port @ ..] = arguments else { panic!("{arguments:?}") };
    let driver = (!port.is_empty()).then_some(DriverName::Grbl);
    let bench = Bench::new(built_in("three-roller").unwrap(), driver, Path::new(folder)).unwrap();
    let bench = bench.at_port(port.first().map(Into::into)).confirming_pump(true);
    let mut session = bench.session().unwrap();
    if let Ok(most_ms) = env::var(SYNC_MS) {
        let random = Random(u64::from(std::process::id()));
        session.store_by(Box::new(UnevenDisk { most_ms: most_ms.parse().unwrap(), random }));
    }
    let request = DoseRequest::dose(volume_ml.parse().unwrap());
    let prepared =
        if request.volume_ml == 0.0 { session.prepare_rest(request) } else { session.prepare(request) };
    let prepared = match prepared {
        Ok(prepared) => prepared,
        Err(error) => return println!("refused: {error}"),
    };
    say("begin", prepared.plan.steps().unsigned_abs());
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
    io::stdout().write_all(line.as_bytes()).and_then(|()| io::stdout().flush()).unwrap();
}

/// Starts the process. If `bytes` is given, the disk is full after so many bytes of the journal. If `sync_ms` is
/// given, each of its syncs takes longer by up to so many milliseconds.
pub(crate) fn start(
    folder: &Path,
    volume_ml: f64,
    bytes: Option<u64>,
    sync_ms: Option<f64>,
    port: Option<&Path>,
) -> Child {
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
    command.envs(sync_ms.map(|ms| (SYNC_MS, ms.to_string())));
    command.stdout(Stdio::piped()).spawn().unwrap()
}

/// Waits until something has come true, or so many seconds at most. Returns true if the process still runs.
pub(crate) fn runs_for(process: &mut Child, longest_s: f64, until: &dyn Fn() -> bool) -> bool {
    let deadline = Instant::now() + Duration::from_secs_f64(longest_s);
    while Instant::now() < deadline && process.try_wait().unwrap().is_none() && !until() {
        sleep(Duration::from_millis(1));
    }
    process.try_wait().unwrap().is_none()
}

/// Waits for the instant of a kill. Some processes die while they look for the board, some soon after they have
/// announced their dose, and most once the board's motor has made so much of it.
pub(crate) fn runs_until_a_kill(
    process: &mut Child,
    random: &mut Random,
    is_announced: &dyn Fn() -> bool,
    has_made: &dyn Fn(f64) -> bool,
) {
    let made = random.part();
    match random.part() {
        part if part < 0.2 => _ = runs_for(process, random.part(), &|| false),
        part if part < 0.4 => {
            runs_for(process, 90.0, is_announced);
            runs_for(process, SOON_S * random.part(), &|| false);
        }
        _ => _ = runs_for(process, 90.0, &|| has_made(made)),
    }
}

/// Returns the output of the process, once it has ended.
pub(crate) fn said(mut child: Child) -> String {
    let mut said = String::new();
    child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    child.wait().unwrap();
    said
}

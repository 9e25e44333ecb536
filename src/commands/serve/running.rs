//! The service from its begin to its end.

use std::ffi::OsString;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use pump_bench::config::{Config, MqttTable, ServiceTable};
use pump_bench::pump_file::Pace;
use pump_bench::report::ErrorKind;
use pump_service::guard::Guard;
use pump_service::history::History;
use pump_service::http::{Access, AccessError, Limits, serve};
use pump_service::mqtt::{Link, Settings};
use pump_service::runner::Runner;
use pump_service::schedule::Timestamp;
use pump_service::service::{Service, Setup};
use pump_service::worker::Program;
use tokio::net::TcpListener;
use tokio::runtime::Builder;

use super::ServeArgs;
use super::notes::Notes;
use super::place::Place;
use super::secret;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{say, tell};

/// Address of a service without another one.
const USUAL_ADDRESS: &str = "127.0.0.1:8737";

/// Longest time that the motors have to stand once the service ends.
const LONGEST_END: Duration = Duration::from_secs(30);

/// Longest time that the runs of the schedule have to tell their ends once the motors stand.
const LONGEST_WORD: Duration = Duration::from_secs(2);

/// Time between two looks for a signal.
const LOOK: Duration = Duration::from_millis(20);

/// Threads of the service. The motions are in processes of their own.
const THREADS: usize = 2;

/// Runs the service until a signal ends it.
pub(super) fn run(args: &ServeArgs) -> Result<(), Failure> {
    let config = args.config.config()?;
    let state_dir = args.record.folder(&config)?;
    let table = config.service().clone();
    let address = address(args, &table)?;
    let local = pump_service::new_token().map_err(refused)?;
    let access = access(args, &table, address, &local)?;
    let schedule = args.schedule.as_ref().or(table.schedule.as_ref()).cloned();
    let interrupt = Interrupt::watch()?;
    let place = Place::take(&state_dir)?;
    let history = History::open(&state_dir.join("history.sqlite")).map_err(refused)?;
    let mqtt = table.mqtt.as_ref().map(|table| settings(table, &history)).transpose()?;
    let program = Program::new(own_path()?, places(&config, &state_dir));
    let fast = args.pace == Some(Pace::Fast);
    let runtime = Builder::new_multi_thread().worker_threads(THREADS).enable_all().build();
    let runtime = runtime.map_err(|error| refused(format!("the service cannot begin: {error}")))?;
    let (tell_notes, notes) = Notes::begin();
    let ended = runtime.block_on(async {
        let setup = Setup { config, state_dir, program, fast, history, notes: tell_notes };
        let service = Service::new(setup).map_err(refused)?;
        let listener = TcpListener::bind(address).await.map_err(|error| {
            refused(format!("cannot listen at {address}: {error}; name another with --listen")).value(address)
        })?;
        let address = listener.local_addr().map_err(refused)?;
        let runner = schedule.map(|path| Runner::new(&path, service.clone(), Timestamp::now)).transpose();
        let runner = runner.map_err(refused)?.map(Arc::new);
        place.tell(address, &local)?;
        tell(&headline(&service, address))?;
        tokio::spawn(service.clone().keep_fresh());
        if let Some(runner) = runner.clone() {
            tokio::spawn(async move { runner.run().await });
        }
        let guard = Guard::new(service.clone());
        let link = mqtt.map(|settings| Link::begin(service.clone(), guard.clone(), settings));
        let guarding = guard.clone();
        tokio::spawn(async move { guarding.run().await });
        let (ended, until) = tokio::sync::oneshot::channel::<()>();
        let until = async move { drop(until.await) };
        let shown = runner.clone();
        let answering =
            tokio::spawn(serve(listener, service.clone(), access, shown, guard, Limits::default(), until));
        while interrupt.signal().is_none() {
            tokio::time::sleep(LOOK).await;
        }
        say("stopping every pump; the records are written once they stand\n");
        let stand = service.end("the end of the service", LONGEST_END).await;
        if let Some(runner) = runner {
            runner.end(LONGEST_WORD).await;
        }
        if let Some(link) = link {
            link.end().await;
        }
        // Watchers see the end of each order before their connections end.
        drop(ended);
        let _ = answering.await;
        if stand { Ok(()) } else { Err(unsettled()) }
    });
    // The tasks end with their runtime, and the notes with the last task.
    drop(runtime);
    notes.end();
    ended
}

fn unsettled() -> Failure {
    let message =
        "a pump did not stand within 30 s; its command goes on to stop it, and its record has the volume";
    Failure::fault(ErrorKind::Stopped, message)
}

fn refused(error: impl ToString) -> Failure {
    Failure::refused(error)
}

/// The address to listen at.
fn address(args: &ServeArgs, table: &ServiceTable) -> Result<SocketAddr, Failure> {
    let text = args.listen.as_deref().or(table.listen.as_deref()).unwrap_or(USUAL_ADDRESS);
    text.parse().map_err(|_| {
        let allowed = "an address and a port, as 127.0.0.1:8737 or [::1]:8737";
        refused(format!("cannot listen at `{text}`; allowed: {allowed}")).value(text).allowed(allowed)
    })
}

/// The rules of who may use the service at this address. `local` is the token of commands on this machine.
fn access(
    args: &ServeArgs,
    table: &ServiceTable,
    address: SocketAddr,
    local: &str,
) -> Result<Access, Failure> {
    let token_file = args.token_file.as_ref().or(table.token_file.as_ref());
    let token = token_file.map(|path| secret::read("token", path)).transpose()?;
    let access = Access::new(address, token, local.to_owned(), table.hosts.clone());
    access.map_err(|error| match error {
        AccessError::NoToken(_) => refused(format!("{error}: --token-file, or token_file in [service]")),
        error => refused(error),
    })
}

/// The broker that a configuration names, with its user's password.
fn settings(table: &MqttTable, history: &History) -> Result<Settings, Failure> {
    let password = table.password_file.as_ref().map(|path| secret::read("password", path)).transpose()?;
    Settings::new(table, password, history).map_err(refused)
}

/// The path of this program, which carries out the orders too.
fn own_path() -> Result<PathBuf, Failure> {
    std::env::current_exe().map_err(|error| refused(format!("this program's own path is unknown: {error}")))
}

/// Variables of every command that the service runs: the same configuration and the same records.
fn places(config: &Config, state_dir: &Path) -> Vec<(&'static str, OsString)> {
    let whole = |path: &Path| std::path::absolute(path).unwrap_or(path.to_owned()).into_os_string();
    let config = config.path().filter(|_| config.exists()).map(|path| ("DOSE_CONFIG", whole(path)));
    [("DOSE_STATE_DIR", whole(state_dir))].into_iter().chain(config).collect()
}

/// Words about a service that has begun.
fn headline(service: &Service, address: SocketAddr) -> String {
    let pumps: Vec<String> = service
        .pumps()
        .map(|pump| match pump.bench().board_port() {
            Some(port) => format!("  {} on {}\n", pump.name(), port.display()),
            None => format!("  {} (simulated)\n", pump.name()),
        })
        .collect();
    format!("serving at http://{address}; Ctrl-C stops every pump and ends\n{}", pumps.concat())
}

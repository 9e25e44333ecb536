//! A laboratory of simulated pumps with a service of its own, which ends with the test.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use ureq::Agent;

/// Longest wait for anything.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// Folder with a configuration, pump files and records.
pub(crate) struct Laboratory {
    folder: TempDir,
}

/// A running service.
pub(crate) struct Service {
    pub(crate) url: String,
    child: Child,
    /// Words that start the same service again.
    words: Vec<String>,
}

/// Answer to a request: its status and its JSON.
pub(crate) type Answer = (u16, Value);

impl Laboratory {
    /// A laboratory with these pumps, each a copy of the built-in one, and with more lines of the configuration.
    pub(crate) fn new(pumps: &[&str], more: &str) -> Self {
        let folder = TempDir::new().unwrap();
        let mut config = "schema = \"config/1\"\nstate_dir = \"records\"\n".to_owned();
        config += &format!("default_pump = \"{}\"\n[pumps]\n", pumps[0]);
        let shown = Command::new(dose()).args(["pumps", "show", "three-roller"]).output().unwrap();
        let shown = String::from_utf8(shown.stdout).unwrap();
        for pump in pumps {
            let file = shown.replacen("id = \"three-roller\"", &format!("id = \"{pump}\""), 1);
            assert_ne!(file, shown, "the built-in pump's id was replaced");
            fs::write(folder.path().join(format!("{pump}.toml")), file).unwrap();
            config += &format!("{pump} = \"{pump}.toml\"\n");
        }
        fs::write(folder.path().join("config.toml"), config + more).unwrap();
        Self { folder }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The command in this laboratory.
    pub(crate) fn dose(&self, words: &[&str]) -> Command {
        let mut command = Command::new(dose());
        command.args(words).env("DOSE_CONFIG", self.path("config.toml")).env("HOME", self.folder.path());
        command.env_remove("DOSE_PUMP").env_remove("DOSE_STATE_DIR").env_remove("DOSE_SERVICE");
        command.current_dir(self.folder.path()).stdin(Stdio::null());
        command
    }

    /// Runs a command to its end.
    pub(crate) fn run(&self, words: &[&str]) -> Output {
        self.dose(words).output().unwrap()
    }

    /// The record of a pump as `dose status` tells it.
    pub(crate) fn status(&self, pump: &str) -> Value {
        let told = self.run(&["status", "--pump", pump, "--format", "json"]);
        serde_json::from_slice(&told.stdout).unwrap()
    }

    /// Gives the configuration a command `on_fail`, which adds a line to the file `told`: pump, exit code and kind.
    pub(crate) fn tell_failures(&self) {
        let (config, line) = (self.path("config.toml"), "$DOSE_FAIL_PUMP $DOSE_FAIL_CODE $DOSE_FAIL_KIND");
        let text = fs::read_to_string(&config).unwrap();
        fs::write(
            &config,
            text.replacen("[pumps]", &format!("on_fail = \"echo {line} >> told\"\n[pumps]"), 1),
        )
        .unwrap();
    }

    /// The lines that `on_fail` has told.
    pub(crate) fn told(&self) -> Vec<String> {
        let told = fs::read_to_string(self.path("told")).unwrap_or_default();
        told.lines().map(str::to_owned).collect()
    }

    /// The doses of a pump on record.
    pub(crate) fn log(&self, pump: &str) -> Vec<Value> {
        let told = self.run(&["log", "--pump", pump, "--format", "json"]);
        let lines = String::from_utf8(told.stdout).unwrap();
        lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    /// Everything that the services of this laboratory have said on standard error.
    pub(crate) fn said(&self) -> String {
        fs::read_to_string(self.path("said")).unwrap()
    }

    /// Starts a service with these words beside its address.
    pub(crate) fn serve(&self, words: &[&str]) -> Service {
        let listen = ["serve", "--listen", "127.0.0.1:0"];
        let words = listen.iter().chain(words).map(|word| (*word).to_owned()).collect();
        self.start(words)
    }

    /// Starts a service again that was ended.
    pub(crate) fn serve_again(&self, service: &Service) -> Service {
        self.start(service.words.clone())
    }

    fn start(&self, words: Vec<String>) -> Service {
        let typed: Vec<&str> = words.iter().map(String::as_str).collect();
        let mut command = self.dose(&typed);
        let said = fs::OpenOptions::new().create(true).append(true).open(self.path("said")).unwrap();
        let child = command.stdout(Stdio::null()).stderr(said).spawn().unwrap();
        let place = self.path("records/serve.json");
        let told = || -> Option<String> {
            let place: Value = serde_json::from_str(&fs::read_to_string(&place).ok()?).ok()?;
            (place["process"] == child.id()).then(|| place["url"].as_str().unwrap().to_owned())
        };
        let url = wait_for("the service to begin", told);
        Service { url, child, words }
    }
}

impl Service {
    pub(crate) fn get(&self, path: &str) -> Answer {
        self.get_with(path, &[])
    }

    pub(crate) fn get_with(&self, path: &str, headers: &[(&str, &str)]) -> Answer {
        let request = agent().get(format!("{}{path}", self.url));
        answer(headers.iter().fold(request, |request, (name, value)| request.header(*name, *value)).call())
    }

    pub(crate) fn post(&self, path: &str, body: &Value) -> Answer {
        self.post_with(path, body, &[])
    }

    pub(crate) fn post_with(&self, path: &str, body: &Value, headers: &[(&str, &str)]) -> Answer {
        let request = agent().post(format!("{}{path}", self.url)).header("content-type", "application/json");
        let request = headers.iter().fold(request, |request, (name, value)| request.header(*name, *value));
        answer(request.send(body.to_string()))
    }

    /// Edits the schedule by a request of this method, with the tag of the schedule that was read.
    pub(crate) fn edit(&self, method: &str, path: &str, body: &Value, tag: &str) -> Answer {
        let url = format!("{}/api/v1/schedule/entries{path}", self.url);
        let request = ureq::http::Request::builder().method(method).uri(url).header("if-match", tag);
        let request = request.header("content-type", "application/json").body(body.to_string()).unwrap();
        answer(agent().run(request))
    }

    /// Orders a dose of a pump. Returns the name of the order.
    pub(crate) fn dose(&self, pump: &str, volume: &str, options: &Value) -> String {
        let body = json!({"volume": volume, "options": options});
        let (status, order) = self.post(&format!("/api/v1/pumps/{pump}/dose"), &body);
        assert_eq!(status, 202, "{order}");
        order["id"].as_str().unwrap().to_owned()
    }

    /// Waits until an order has ended, and returns it.
    pub(crate) fn ended(&self, id: &str) -> Value {
        wait_for("the order to end", || {
            let (status, order) = self.get(&format!("/api/v1/orders/{id}"));
            assert_eq!(status, 200, "{order}");
            (order["state"] != "running").then_some(order)
        })
    }

    /// Waits until a pump moves: its order tells a volume above 0.
    pub(crate) fn moves(&self, pump: &str) {
        wait_for("the pump to move", || {
            let (_, view) = self.get(&format!("/api/v1/pumps/{pump}"));
            view["progress"]["delivered_ml"].as_f64().filter(|ml| *ml > 0.0)
        });
    }

    /// The service's process.
    pub(crate) fn process(&self) -> u32 {
        self.child.id()
    }

    /// Kills the service as a power cut of it alone would.
    pub(crate) fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// Ends the service in order, and returns its exit code.
    pub(crate) fn end(&mut self) -> Option<i32> {
        signal(self.child.id(), "INT");
        wait_for("the service to end", || self.child.try_wait().unwrap()).code()
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        if self.child.try_wait().unwrap().is_none() {
            self.child.kill().unwrap();
            self.child.wait().unwrap();
        }
    }
}

/// Sends a signal to a process that this test started.
pub(crate) fn signal(process: u32, name: &str) {
    assert!(
        Command::new("kill").args([&format!("-{name}"), &process.to_string()]).status().unwrap().success()
    );
}

/// Waits until `is_so` has something to return.
pub(crate) fn wait_for<T>(what: &str, mut is_so: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = is_so() {
            return found;
        }
        assert!(begun.elapsed() < PATIENCE, "waited in vain for {what}");
        sleep(Duration::from_millis(10));
    }
}

fn dose() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_dose"))
}

fn agent() -> Agent {
    let config =
        Agent::config_builder().http_status_as_error(false).allow_non_standard_methods(true).proxy(None);
    config.timeout_global(Some(PATIENCE)).build().into()
}

fn answer(answer: Result<ureq::http::Response<ureq::Body>, ureq::Error>) -> Answer {
    let mut answer = answer.unwrap();
    let text = answer.body_mut().read_to_string().unwrap();
    (answer.status().as_u16(), serde_json::from_str(&text).unwrap_or(Value::String(text)))
}

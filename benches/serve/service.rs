//! A service of simulated pumps, which ends with the measurement.

use std::error::Error;
use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use ureq::Agent;

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// Time between two looks.
const LOOK: Duration = Duration::from_millis(5);

/// A running service with its folder.
pub(crate) struct Service {
    url: String,
    child: Child,
    agent: Agent,
    _folder: TempDir,
}

impl Service {
    /// A service of pumps `p0`, `p1` and so on at this pace, and of one more, `spare`, with an input of that name.
    pub(crate) fn begin(pumps: usize, pace: &str) -> Result<Self, Box<dyn Error>> {
        let dose = env!("CARGO_BIN_EXE_dose");
        let folder = TempDir::new()?;
        let shown = Command::new(dose).args(["pumps", "show", "three-roller"]).output()?;
        let file = String::from_utf8(shown.stdout)?;
        let mut config = "schema = \"config/1\"\nstate_dir = \"records\"\n[pumps]\n".to_owned();
        for name in (0..pumps).map(|pump| format!("p{pump}")).chain(["spare".to_owned()]) {
            let own = file.replacen("id = \"three-roller\"", &format!("id = \"{name}\""), 1);
            fs::write(folder.path().join(format!("{name}.toml")), own)?;
            config += &format!("{name} = \"{name}.toml\"\n");
        }
        config += "[[service.input]]\nname = \"spare\"\npumps = [\"spare\"]\nsilent = \"24h\"\n";
        let path = folder.path().join("config.toml");
        fs::write(&path, config)?;
        let mut command = Command::new(dose);
        command.args(["serve", "--listen", "127.0.0.1:0", "--pace", pace]).env("DOSE_CONFIG", &path);
        command.env_remove("DOSE_STATE_DIR").env_remove("DOSE_PUMP").stdin(Stdio::null());
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
        let agent = Agent::config_builder().proxy(None).timeout_global(Some(PATIENCE)).build().into();
        let mut service = Self { url: String::new(), child, agent, _folder: folder };
        let place = service._folder.path().join("records/serve.json");
        service.url = until("the service", || {
            let place: Value = serde_json::from_str(&fs::read_to_string(&place).ok()?).ok()?;
            place["url"].as_str().map(str::to_owned)
        })?;
        Ok(service)
    }

    /// Host and port.
    pub(crate) fn address(&self) -> &str {
        self.url.trim_start_matches("http://")
    }

    /// The process of the service.
    pub(crate) fn process(&self) -> u32 {
        self.child.id()
    }

    /// Posts a body, and returns the answer. A refusal is an error.
    pub(crate) fn post(&self, path: &str, body: &Value) -> Result<Value, Box<dyn Error>> {
        let request =
            self.agent.post(format!("{}{path}", self.url)).header("content-type", "application/json");
        Ok(serde_json::from_str(&request.send(body.to_string())?.body_mut().read_to_string()?)?)
    }

    /// Has a pump dose, and waits for the end of that.
    pub(crate) fn dose_to_its_end(&self, pump: &str) -> Result<(), Box<dyn Error>> {
        let order = self.post(&format!("/api/v1/pumps/{pump}/dose"), &json!({"volume": "5mL"}))?;
        let path = format!("{}/api/v1/orders/{}", self.url, order["id"].as_str().ok_or("no id")?);
        let state = until("the end of a dose", || {
            let text = self.agent.get(&path).call().ok()?.body_mut().read_to_string().ok()?;
            let order: Value = serde_json::from_str(&text).ok()?;
            order["state"].as_str().filter(|state| *state != "running").map(str::to_owned)
        })?;
        if state == "done" { Ok(()) } else { Err(format!("a dose is {state}").into()) }
    }

    /// Ends the service in order.
    pub(crate) fn end(mut self) -> Result<(), Box<dyn Error>> {
        Command::new("kill").args(["-INT", &self.child.id().to_string()]).status()?;
        let status = until("the end of the service", || self.child.try_wait().ok().flatten())?;
        if status.success() { Ok(()) } else { Err(format!("the service ended with {status}").into()) }
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        // A service that has ended hears nothing.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn until<T>(what: &str, mut found: impl FnMut() -> Option<T>) -> Result<T, Box<dyn Error>> {
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        if let Some(found) = found() {
            return Ok(found);
        }
        sleep(LOOK);
    }
    Err(format!("waited in vain for {what}").into())
}

//! The service behind the proxy of `packaging/dose-proxy.conf`, over TLS.
#![allow(clippy::print_stderr, reason = "a test that is left out says why")]

use std::env;
use std::fs;
use std::io::{BufRead, BufReader};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::laboratory::{Answer, Laboratory, Service, wait_for};

/// Folders of nginx for what it sets aside, which need not be writable where it was installed.
const ASIDE: [&str; 5] = ["client_body", "proxy", "fastcgi", "uwsgi", "scgi"];

/// Longest time from a stop to its event behind the proxy. One that kept events back would wait for more of them.
const SOON: Duration = Duration::from_secs(2);

/// A proxy before a service, with a certificate of its own, which ends with the test.
struct Proxy {
    folder: PathBuf,
    port: u16,
    child: Child,
}

impl Drop for Proxy {
    fn drop(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

/// The program nginx, or a printed reason why the test is left out.
fn nginx() -> Option<PathBuf> {
    let beside = env::var("PATH").unwrap_or_default() + ":/usr/sbin";
    let find =
        |name: &str| env::split_paths(&beside).map(|folder| folder.join(name)).find(|path| path.is_file());
    if let Some(missing) = ["nginx", "openssl", "curl"].into_iter().find(|name| find(name).is_none()) {
        assert!(env::var_os("PROXY_NEEDED").is_none(), "PROXY_NEEDED is set, and there is no {missing}");
        eprintln!("left out: there is no {missing}; `make mqtt` installs it");
        return None;
    }
    find("nginx")
}

impl Proxy {
    /// Begins nginx with the configuration of the documentation, for another port, certificate and service.
    fn begin(nginx: &Path, laboratory: &Laboratory, service: &Service) -> Self {
        let folder = laboratory.path("proxy");
        fs::create_dir(&folder).unwrap();
        let place = folder.display();
        let (key, certificate) = (format!("{place}/pumps.key"), format!("{place}/pumps.crt"));
        let names = ["-subj", "/CN=pumps.local", "-addext", "subjectAltName=DNS:pumps.local"];
        let mut openssl = Command::new("openssl");
        openssl.args(["req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2"]).args(names);
        openssl.args(["-keyout", &key, "-out", &certificate]).stderr(Stdio::null());
        assert!(openssl.status().unwrap().success());
        // The port is free once this listener is dropped.
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let mut server = include_str!("../../packaging/dose-proxy.conf").to_owned();
        for (from, to) in [
            ("listen 443 ssl", format!("listen 127.0.0.1:{port} ssl")),
            ("/etc/nginx/pumps.crt", certificate.clone()),
            ("/etc/nginx/pumps.key", key.clone()),
            ("http://127.0.0.1:8737", service.url.clone()),
        ] {
            assert_eq!(server.matches(from).count(), 1, "{from}");
            server = server.replace(from, &to);
        }
        let aside: String = ASIDE.iter().map(|name| format!("{name}_temp_path {place}/{name};\n")).collect();
        let text = format!(
            "daemon off;\nmaster_process off;\npid {place}/pid;\nerror_log {place}/errors;\nevents {{}}\n\
             http {{\naccess_log off;\n{aside}{server}}}\n"
        );
        fs::write(folder.join("nginx.conf"), text).unwrap();
        let mut command = Command::new(nginx);
        command.arg("-p").arg(&folder).arg("-c").arg(folder.join("nginx.conf"));
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let proxy = Self { folder, port, child };
        wait_for("the proxy to listen", || TcpStream::connect(("127.0.0.1", port)).ok());
        proxy
    }

    /// A request by this name to the proxy, which keeps its cookies.
    fn curl(&self, name: &str, path: &str) -> Command {
        let (port, jar) = (self.port, self.folder.join("cookies"));
        let mut command = Command::new("curl");
        command
            .args(["--silent", "--no-buffer", "--noproxy", "*", "--cacert"])
            .arg(self.folder.join("pumps.crt"));
        command
            .args(["--resolve", &format!("{name}:{port}:127.0.0.1")])
            .arg("-b")
            .arg(&jar)
            .arg("-c")
            .arg(&jar);
        command.arg(format!("https://{name}:{port}{path}"));
        command
    }

    /// Sends a request, and returns its status and its JSON.
    fn answer(&self, command: &mut Command) -> Answer {
        let made = command.args(["--write-out", "\n%{http_code}"]).output().unwrap();
        let text = String::from_utf8(made.stdout).unwrap();
        let (text, status) = text.rsplit_once('\n').unwrap();
        (status.parse().unwrap(), serde_json::from_str(text).unwrap_or(Value::String(text.to_owned())))
    }

    fn get(&self, path: &str) -> Answer {
        self.answer(&mut self.curl("pumps.local", path))
    }

    /// Posts as a page of this origin does.
    fn post(&self, path: &str, body: &Value, origin: &str) -> Answer {
        let mut curl = self.curl("pumps.local", path);
        curl.args(["-H", "content-type: application/json", "-H", &format!("origin: {origin}")]);
        self.answer(curl.args(["--data", &body.to_string()]))
    }
}

#[test]
fn a_proxy_with_tls_serves_page_login_events_and_stop() {
    let Some(nginx) = nginx() else { return };
    let laboratory =
        Laboratory::new(&["acid"], "[service]\nhosts = [\"pumps.local\"]\ntoken_file = \"token\"\n");
    fs::write(laboratory.path("token"), "0123456789abcdef\n").unwrap();
    let service = laboratory.serve(&[]);
    let proxy = Proxy::begin(&nginx, &laboratory, &service);
    let origin = format!("https://pumps.local:{}", proxy.port);
    let (status, page) = proxy.get("/");
    assert_eq!(status, 200);
    assert!(page.as_str().unwrap().contains("<html"), "{page}");

    // The login's cookie opens the rest.
    assert_eq!(proxy.get("/api/v1/pumps").0, 401);
    assert_eq!(proxy.post("/login", &json!({"token": "0123456789abcdef"}), &origin).0, 200);
    assert_eq!(proxy.get("/api/v1/pumps").0, 200);

    // A page of another site, and a name that was bent to the proxy, are refused as without it.
    let foreign = proxy.post("/api/v1/stop", &json!({}), "https://evil.example");
    assert_eq!((foreign.0, &foreign.1["kind"]), (403, &json!("origin")), "{}", foreign.1);
    let mut bent = proxy.curl("evil.example", "/api/v1/pumps");
    assert_eq!(proxy.answer(bent.arg("--insecure")).0, 421);

    // Events come as they happen.
    let mut watcher = proxy.curl("pumps.local", "/events").stdout(Stdio::piped()).spawn().unwrap();
    let heard = Arc::new(Mutex::new(String::new()));
    let (hears, events) = (heard.clone(), watcher.stdout.take().unwrap());
    thread::spawn(move || {
        for line in BufReader::new(events).lines().map_while(Result::ok) {
            hears.lock().unwrap().push_str(&(line + "\n"));
        }
    });
    let hears = |words: &str| {
        wait_for(words, || heard.lock().unwrap().contains(words).then_some(()));
    };
    hears("event: hello");
    let dose = json!({"volume": "40mL", "options": {"rate": "1mL/s"}});
    let (status, order) = proxy.post("/api/v1/pumps/acid/dose", &dose, &origin);
    assert_eq!(status, 202, "{order}");
    hears("event: progress");
    let stopped_at = Instant::now();
    assert_eq!(proxy.post("/api/v1/stop", &json!({}), &origin).0, 200);
    hears("\"state\":\"failed\"");
    assert!(stopped_at.elapsed() < SOON, "{:?}", stopped_at.elapsed());
    watcher.kill().unwrap();
    watcher.wait().unwrap();
    assert_eq!(service.get_with("/api/v1/orders", &[("authorization", "Bearer 0123456789abcdef")]).0, 200);
}

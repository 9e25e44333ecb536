"""A laboratory of simulated pumps with a service of its own, which ends with the test."""

import contextlib
import json
import os
import signal
import subprocess
import time
import urllib.request
from pathlib import Path
from urllib.parse import quote

ROOT = Path(__file__).parents[2]
DOSE = Path(os.environ.get("DOSE", ROOT / "target/debug/dose"))
PATIENCE = 60.0
"""Longest wait for anything, in seconds."""

# Asks this machine, whatever proxy its environment names.
opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))


def wait_for(what, is_so, seconds=PATIENCE):
    """Wait until `is_so` has something to return."""
    end = time.monotonic() + seconds
    while not (found := is_so()):
        assert time.monotonic() < end, f"waited in vain for {what}"
        time.sleep(0.02)
    return found


class Laboratory:
    """A folder with a configuration, pump files and records."""

    def __init__(self, folder, pumps=("acid",), more="", racks="", titles=None, lines=None):
        """Write the files: `titles` and further `lines` by the pump, `more` lines of the configuration."""
        self.folder = folder
        self.services = []
        config = f'schema = "config/1"\nstate_dir = "records"\ndefault_pump = "{pumps[0]}"\n'
        shown = subprocess.check_output([DOSE, "pumps", "show", "three-roller"], text=True, timeout=PATIENCE)
        for pump in pumps:
            file = shown.replace('id = "three-roller"', f'id = "{pump}"')
            assert file != shown, "the built-in pump's id was replaced"
            title = (titles or {}).get(pump, f"{pump.capitalize()}, 3 rollers")
            file = file.replace('name = "McIntyre et al., 3 rollers"', f"name = {json.dumps(title)}")
            (folder / f"{pump}.toml").write_text(file + (lines or {}).get(pump, ""))
        config += "[pumps]\n" + "".join(f'{pump} = "{pump}.toml"\n' for pump in pumps)
        if racks:
            (folder / "mix.toml").write_text(racks)
            config += '[racks]\nmix = "mix.toml"\n'
        (folder / "config.toml").write_text(config + more)

    def _words(self, words):
        env = {name: value for name, value in os.environ.items() if not name.startswith("DOSE")}
        env |= {"DOSE_CONFIG": str(self.folder / "config.toml"), "HOME": str(self.folder)}
        return {"args": [DOSE, *words], "env": env, "cwd": self.folder, "stdin": subprocess.DEVNULL}

    def run(self, *words):
        """Run the command to its end, and return what it printed."""
        return subprocess.run(**self._words(words), check=True, capture_output=True, text=True, timeout=PATIENCE).stdout

    def start(self, *words):
        """Start the command, and return its process."""
        return subprocess.Popen(**self._words(words), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def log(self, pump):
        """Return the doses of a pump on record."""
        lines = self.run("log", "--pump", pump, "--format", "json").splitlines()
        return [json.loads(line) for line in lines]

    def serve(self, *words, listen="127.0.0.1:0"):
        """Start a service, at a free port unless it is told another."""
        with (self.folder / "service.txt").open("a") as said:
            child = subprocess.Popen(
                **self._words(["serve", "--listen", listen, *words]),
                stdout=said,
                stderr=said,
                # A Ctrl-C at the terminal ends the tests, which end the service.
                start_new_session=True,
            )
        service = Service(child, words)
        self.services.append(service)

        def told():
            assert child.poll() is None, (self.folder / "service.txt").read_text()
            with contextlib.suppress(OSError, ValueError):
                place = json.loads((self.folder / "records/serve.json").read_text())
                return place if place["process"] == child.pid else None
            return None

        place = wait_for("the service to begin", told)
        service.url = place["url"]
        return service

    def serve_again(self, service):
        """Start a service that was killed at the same address."""
        return self.serve(*service.words, listen=service.url.removeprefix("http://"))

    def end(self):
        """End what runs."""
        for service in self.services:
            service.end()


class Service:
    """A running service."""

    url = ""

    def __init__(self, child, words):
        """Keep the process and the words that start it again."""
        self.child = child
        self.words = words

    def get(self, path, token=None):
        """Return the answer to a GET request."""
        return self._ask(urllib.request.Request(self.url + path), token)

    def post(self, path, body=None, token=None):
        """Return the answer to a POST request."""
        head = {"Content-Type": "application/json"}
        return self._ask(urllib.request.Request(self.url + path, json.dumps(body or {}).encode(), head), token)

    def _ask(self, request, token):
        if token:
            request.add_header("Authorization", f"Bearer {token}")
        with opener.open(request, timeout=PATIENCE) as answer:
            return json.loads(answer.read() or b"null")

    def dose(self, pump, volume, **options):
        """Order a dose, and return once the pump moves."""
        order = self.post(f"/api/v1/pumps/{quote(pump)}/dose", {"volume": volume, "options": options})
        assert order["state"] == "running", order
        wait_for(f"{pump} to move", lambda: (self.view(pump)["progress"] or {}).get("delivered_ml"))
        return order["id"]

    def view(self, pump):
        """Return what a pump's record says and what it does now."""
        return self.get(f"/api/v1/pumps/{quote(pump)}")

    def worker(self):
        """Return the process that moves the service's only pump."""
        for entry in Path("/proc").glob("[0-9]*/stat"):
            with contextlib.suppress(OSError):
                stat = entry.read_text().rpartition(") ")[2].split()
                if int(stat[1]) == self.child.pid:
                    return int(entry.parent.name)
        return None

    def ended(self, pump):
        """Wait until a pump has ended its order."""
        wait_for(f"{pump} to end", lambda: not self.view(pump)["order"])

    def stop(self):
        """Stop every pump, and wait until all stand."""
        self.post("/api/v1/stop")
        wait_for("every pump to stand", lambda: not any(view["order"] for view in self.get("/api/v1/pumps")))

    def signal(self, number):
        """Send a signal to the service alone."""
        self.child.send_signal(number)

    def kill(self):
        """Kill the service as a power cut of it alone would."""
        self.child.kill()
        self.child.wait(PATIENCE)

    def end(self):
        """End the service in order, or by force after its time."""
        if self.child.poll() is not None:
            return
        self.child.send_signal(signal.SIGCONT)
        self.child.send_signal(signal.SIGINT)
        try:
            self.child.wait(35)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait(PATIENCE)
            raise

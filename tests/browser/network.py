"""A network between the page and the service that fails as it is told."""

import contextlib
import http.client
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


class Network:
    """Passes requests on to a service, unless they shall be lost."""

    def __init__(self, service):
        """Begin at a free port of this machine."""
        self.host = service.url.removeprefix("http://")
        self.is_down = False
        """True while nothing is let through."""
        self.has_events = True
        """False while the stream of events alone is cut."""
        self.answers_to_lose = 0
        """How many orders reach the service whose answers do not come back."""
        self.orders = []
        """The path, key and body of each order that was passed on."""
        self.server = ThreadingHTTPServer(("127.0.0.1", 0), lambda *words: Passage(self, *words))
        self.server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self.server.server_port}"
        self.thread = threading.Thread(target=self.server.serve_forever, args=(0.05,), daemon=True)
        self.thread.start()

    def lets(self, path):
        """Return true if a request of this path passes now."""
        return not self.is_down and (self.has_events or path != "/events")

    def end(self):
        """End it."""
        self.is_down = True
        self.server.shutdown()
        self.server.server_close()
        self.thread.join(10)


class Passage(BaseHTTPRequestHandler):
    """One connection, which has one request."""

    def __init__(self, network, *words):
        """Keep the network."""
        self.network = network
        super().__init__(*words)

    def log_message(self, *words):
        """Say nothing."""

    def do_GET(self):
        """Pass a request on, and the answer back piece by piece."""
        self.close_connection = True
        network = self.network
        if not network.lets(self.path):
            return
        host = network.host
        head = {name: value for name, value in self.headers.items() if name.lower() != "connection"}
        head["Host"] = host
        if "Origin" in head:
            head["Origin"] = f"http://{host}"
        body = self.rfile.read(int(self.headers.get("Content-Length") or 0))
        if self.command == "POST":
            network.orders.append((self.path, head.get("Idempotency-Key"), body))
        service = http.client.HTTPConnection(host, timeout=20)
        with contextlib.closing(service), contextlib.suppress(OSError, http.client.HTTPException):
            service.request(self.command, self.path, body, head)
            answer = service.getresponse()
            if self.command == "POST" and network.answers_to_lose:
                network.answers_to_lose -= 1
                return
            self.send_response(answer.status)
            for name, value in answer.getheaders():
                if name.lower() not in ("transfer-encoding", "connection", "date", "server"):
                    self.send_header(name, value)
            self.end_headers()
            while network.lets(self.path) and (piece := answer.read1(65536)):
                self.wfile.write(piece)
                self.wfile.flush()

    do_POST = do_GET  # noqa: N815

"""Pages served and opened in Chromium, which is driven through a pipe by the DevTools protocol."""

import functools
import http.server
import json
import os
import subprocess
import threading
from itertools import count

FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run")
ENABLED = ("Page", "Runtime", "Log", "Network")

SAID = ("Log.entryAdded", "Runtime.consoleAPICalled", "Runtime.exceptionThrown")
ASKED = "Network.requestWillBeSent"


class Chromium:
    """One tab of a browser; ``events`` holds what it reported."""

    def __init__(self, folder):
        self.numbers = count(1)
        self.events = []
        read_by_browser, self._to = os.pipe()
        self._from, written_by_browser = os.pipe()
        command = ["chromium", *FLAGS, "--remote-debugging-pipe", f"--user-data-dir={folder}"]
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{read_by_browser} 4>&{written_by_browser}', "-", *command],
            pass_fds=(read_by_browser, written_by_browser),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(read_by_browser)
        os.close(written_by_browser)
        self._rest, self.session = b"", None
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ENABLED:
            self.ask(f"{domain}.enable")

    def close(self):
        """End the browser."""
        os.close(self._to)
        os.close(self._from)
        self.process.terminate()
        self.process.wait(20)

    def ask(self, method, **parameters):
        """Send a command and return its result."""
        number = next(self.numbers)
        message = {"id": number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self._to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == number:
                assert "error" not in answer, (method, answer)
                return answer["result"]
            self.events.append(answer)

    def _next(self):
        while b"\0" not in self._rest:
            self._rest += os.read(self._from, 1 << 20)
        message, _, self._rest = self._rest.partition(b"\0")
        return json.loads(message)

    def open(self, url):
        """Open a page and wait until it is ready."""
        self.ask("Page.navigate", url=url)
        self.run("new Promise((r) => document.readyState === 'complete' ? r() : addEventListener('load', r))")
        return self.run("window.symflex?.ready.then(() => true)")

    def run(self, expression):
        """Return the value of an expression, awaited."""
        answer = self.ask("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def complaints(self):
        """Return everything that pages printed, and every address that was asked for."""
        self.run("1")
        by_kind = {kind: [e["params"] for e in self.events if e["method"] == kind] for kind in (*SAID, ASKED)}
        return [by_kind[kind] for kind in SAID if by_kind[kind]], [
            e["request"]["url"] for e in by_kind[ASKED]
        ]


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves files, and says nothing."""

    extensions_map = http.server.SimpleHTTPRequestHandler.extensions_map | {".mjs": "text/javascript"}

    def log_message(self, *_):
        pass


def serving(folder):
    """Return a server of a folder's files, which runs."""
    served = http.server.ThreadingHTTPServer(
        ("127.0.0.1", 0), functools.partial(Quiet, directory=str(folder))
    )
    threading.Thread(target=served.serve_forever, daemon=True).start()
    return served

"""Pages run their own script alone and load nothing from a network."""

from __future__ import annotations

import http.server
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from conftest import run

# Tries what somebody's text in a page might do. Returns what the browser refused, by directive.
HOSTILE = """async network => {
  const refused = new Set();
  document.addEventListener('securitypolicyviolation', event => refused.add(event.effectiveDirective));
  window.ran = false;
  const script = document.createElement('script');
  script.textContent = 'window.ran = true';
  document.body.append(script);
  document.body.insertAdjacentHTML('beforeend', '<img src="x:" onerror="window.ran = true">');
  document.body.insertAdjacentHTML('beforeend', `<base href="${network}">`);
  const other = document.createElement('script');
  other.src = network + 'x.js';
  document.body.append(other);
  const image = new Image();
  image.src = network + 'x.png';
  await fetch(network).catch(() => null);
  await new Promise(resolve => setTimeout(resolve, 200));
  return {refused: [...refused].sort(), ran: window.ran};
}"""


class Network:
    """A server, and what it was asked for."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        asked = self.asked

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                asked.append(self.path)
                self.send_error(404)

            def log_message(self, *_: Any) -> None:
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.address = f"http://127.0.0.1:{self.server.server_address[1]}/"


@pytest.fixture
def network() -> Iterator[Network]:
    made = Network()
    threading.Thread(target=made.server.serve_forever, daemon=True).start()
    yield made
    made.server.shutdown()
    made.server.server_close()


@pytest.mark.parametrize("kind", ["view", "index"])
def test_nothing_foreign_runs_or_loads(kind: str, fits: Path, browser: Any, network: Network) -> None:
    page_of = {"view": fits / "plastic/of_the_model.html", "index": fits / "index.html"}
    run("view", fits / "plastic/model.json", f"--out={page_of['view']}")
    page = browser.new_page()
    complaints: list[str] = []
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
    page.goto(f"file://{page_of[kind]}")
    page.wait_for_timeout(500)
    assert complaints == []
    assert all(address.startswith(("file:", "data:", "blob:")) for address in asked)
    if kind == "index":
        assert page.eval_on_selector_all("img", "images => images.every(i => i.complete && i.naturalWidth > 0)")
    outcome = page.evaluate(HOSTILE, network.address)
    assert not outcome["ran"]
    assert {"base-uri", "connect-src", "img-src", "script-src-elem"} <= set(outcome["refused"])
    assert network.asked == []
    page.close()

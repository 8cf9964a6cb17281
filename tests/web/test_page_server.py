"""The server: what it sends, to whom, and what it says when it cannot start."""

import http.client
import signal
import socket
import subprocess
import sys
import threading
import urllib.request
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from skinnet.cli import main
from skinnet.errors import InputError
from skinnet.inference._web import page_files
from skinnet.inference._web.page_files import list_files
from skinnet.inference._web.page_server import HOST, PageServer

LARGEST_PAGE = 20e6
"""Bytes of the page with its runtime, the models and the sample."""


@pytest.fixture
def connection(server: PageServer) -> Iterator[http.client.HTTPConnection]:
    connection = http.client.HTTPConnection(HOST, server.server_port)
    yield connection
    connection.close()


@pytest.mark.parametrize(
    ("address", "type_"),
    [
        ("/", "text/html; charset=utf-8"),
        ("/style.css", "text/css; charset=utf-8"),
        ("/src/page.js", "text/javascript; charset=utf-8"),
        ("/runtime/ort-wasm-simd-threaded.wasm.gz", "application/gzip"),
        ("/models/skin.decoder.onnx", "application/octet-stream"),
        ("/samples/astronaut.png", "image/png"),
    ],
)
def test_files_have_their_types_and_are_isolated(
    connection: http.client.HTTPConnection, address: str, type_: str
) -> None:
    connection.request("GET", address)
    answer = connection.getresponse()
    content = answer.read()
    assert answer.status == 200
    assert answer.headers["Content-Type"] == type_
    assert int(answer.headers["Content-Length"]) == len(content)
    assert answer.headers["Cross-Origin-Opener-Policy"] == "same-origin"
    assert answer.headers["Cross-Origin-Embedder-Policy"] == "require-corp"
    assert "connect-src 'self'" in answer.headers["Content-Security-Policy"]


@pytest.mark.parametrize(
    "address", ["/absent", "/../pyproject.toml", "/src/", "/%2e%2e/LICENSE", "/src/../../LICENSE"]
)
def test_nothing_else_is_sent(connection: http.client.HTTPConnection, address: str) -> None:
    connection.request("GET", address)
    assert connection.getresponse().status == 404


def test_nothing_is_taken(connection: http.client.HTTPConnection) -> None:
    connection.request("POST", "/", b"a photograph")
    assert connection.getresponse().status == 501


def test_another_name_for_this_computer_is_refused(
    connection: http.client.HTTPConnection,
) -> None:
    connection.request("GET", "/", headers={"Host": "rebound.example"})
    assert connection.getresponse().status == 403


def test_the_page_is_small(server: PageServer) -> None:
    assert sum(file.path.stat().st_size for file in server.files.values()) < LARGEST_PAGE


def test_a_busy_port_is_a_sentence(server: PageServer, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["web", "--port", str(server.server_port), "--no-open"]) == 2
    message = capsys.readouterr().err
    assert f"Port {server.server_port} is busy" in message and "--port 0" in message


@pytest.mark.parametrize("port", ["-1", "65536"])
def test_a_port_out_of_range_is_a_sentence(port: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["web", f"--port={port}", "--no-open"]) == 2
    assert f"got {port}" in capsys.readouterr().err


def test_a_missing_runtime_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "index.html").write_text("<!doctype html>", encoding="utf-8")
    monkeypatch.setattr(page_files, "_PLACES", (tmp_path,))
    with pytest.raises(InputError, match="make runtime"):
        list_files()


def test_a_missing_page_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_files, "_PLACES", (tmp_path,))
    with pytest.raises(InputError, match="not installed"):
        list_files()


def test_a_browser_that_leaves_is_no_error(
    server: PageServer, capfd: pytest.CaptureFixture[str]
) -> None:
    with socket.create_connection((HOST, server.server_port)) as caller:
        host = f"{HOST}:{server.server_port}"
        caller.sendall(f"GET /models/skin.onnx HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
        caller.recv(100)
    assert main(["web", "--port", str(server.server_port), "--no-open"]) == 2
    assert "Traceback" not in capfd.readouterr().err


@pytest.mark.skipif(sys.platform == "win32", reason="Windows sends no SIGINT to one process")
def test_the_command_serves_the_page_until_it_is_interrupted(server: PageServer) -> None:
    command = [sys.executable, "-m", "skinnet", "web", "--port", "0", "--no-open"]
    # Jobs in the background of a shell ignore interrupts, and so do their children.
    usual = partial(signal.signal, signal.SIGINT, signal.default_int_handler)
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=usual
    ) as process:
        try:
            assert process.stdout is not None
            address = process.stdout.readline().strip()
            with urllib.request.urlopen(address) as answer:
                assert b"Your photo never leaves this page." in answer.read()
            process.send_signal(signal.SIGINT)
            said = process.communicate(timeout=60)[1]
        finally:
            process.kill()
    assert process.returncode == 0 and "Traceback" not in said


@pytest.fixture
def open_server() -> Iterator[PageServer]:
    """A server for the network, as a container needs it."""
    with PageServer(0, "0.0.0.0") as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        yield server
        server.shutdown()
        thread.join()


@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("127.0.0.1:8765", 200),
        ("localhost:9000", 200),
        ("192.168.1.7:8765", 200),
        ("[::1]:8765", 200),
        ("rebound.example:8765", 403),
        ("127.0.0.1.rebound.example", 403),
        ("127.0.0.1:port", 403),
        ("[", 403),
        ("", 403),
    ],
)
def test_names_of_others_are_refused_on_a_network_too(
    open_server: PageServer, host: str, status: int
) -> None:
    caller = http.client.HTTPConnection(HOST, open_server.server_port)
    caller.request("GET", "/style.css", headers={"Host": host})
    assert caller.getresponse().status == status
    caller.close()
    assert open_server.address == f"http://{HOST}:{open_server.server_port}/"


def test_a_server_for_the_network_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(PageServer, "serve_forever", lambda server: None)
    assert main(["web", "--port=0", "--host=0.0.0.0", "--no-open"]) == 0
    assert "warning: --host 0.0.0.0 opens the page to everyone" in capsys.readouterr().err
    assert main(["web", "--port=0", "--no-open"]) == 0
    assert "open to this computer alone" in capsys.readouterr().err


@pytest.mark.parametrize("host", ["203.0.113.7", "absent.invalid", "a" * 80, ""])
def test_a_host_that_is_not_here_is_a_sentence(
    host: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["web", "--port=0", f"--host={host}", "--no-open"]) == 2
    assert "is no address of this computer" in capsys.readouterr().err

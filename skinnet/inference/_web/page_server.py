"""Serves the page on this computer alone."""

import errno
import shutil
import sys
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import unquote, urlsplit

from skinnet.errors import InputError
from skinnet.inference._web.page_files import PageFile, list_files

HOST = "127.0.0.1"

_LARGEST_PORT = 65535

_HEADERS = {
    # Memory that threads share is for pages that are isolated from others.
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Embedder-Policy": "require-corp",
    "Cross-Origin-Resource-Policy": "same-origin",
    # The browser itself then refuses to send anything to another place.
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; "
        "style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; "
        "form-action 'none'; frame-ancestors 'none'"
    ),
    "Permissions-Policy": "camera=(self), geolocation=(), microphone=()",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-cache",
}


class PageServer(ThreadingHTTPServer):
    """A server of the page; each request has a thread of its own.

    Args:
        port: 1 to 65535, or 0 for any that is free.

    Raises:
        InputError: The port cannot be used, or the page is not installed.
    """

    daemon_threads = True
    # On Windows it would let two servers have one port.
    allow_reuse_address = sys.platform != "win32"

    def __init__(self, port: int) -> None:
        if not 0 <= port <= _LARGEST_PORT:
            raise InputError(f"A port is 1 to {_LARGEST_PORT}, or 0 for any; got {port}.")
        self.files = list_files()
        try:
            super().__init__((HOST, port), _PageRequest)
        except OSError as error:
            raise InputError(_explain(port, error)) from error

    @property
    def address(self) -> str:
        """The page's address."""
        return f"http://{HOST}:{self.server_port}/"


class _PageRequest(BaseHTTPRequestHandler):
    server: PageServer
    protocol_version = "HTTP/1.1"

    def do_GET(self) -> None:
        """Send a file of the page."""
        file = self._begin()
        if file is not None:
            with file.path.open("rb") as content:
                shutil.copyfileobj(content, self.wfile)

    def do_HEAD(self) -> None:
        """Send the headers of a file."""
        self._begin()

    def handle(self) -> None:
        """Answer requests until the browser closes the connection, at whatever place."""
        try:
            super().handle()
        except (BrokenPipeError, ConnectionResetError, ConnectionAbortedError):
            self.close_connection = True

    def log_message(self, format: str, *args: Any) -> None:
        """Log nothing: the terminal is the user's."""

    def _begin(self) -> PageFile | None:
        """Send the headers; None if there is no such file, or the request is not from the page."""
        if self.headers.get("Host") not in self._list_hosts():
            # Another page may point its own name at this computer.
            self.send_error(HTTPStatus.FORBIDDEN)
            return None
        file = self.server.files.get(unquote(urlsplit(self.path).path))
        if file is None:
            self.send_error(HTTPStatus.NOT_FOUND)
            return None
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", file.type)
        self.send_header("Content-Length", str(file.path.stat().st_size))
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        self.end_headers()
        return file

    def _list_hosts(self) -> list[str]:
        return [f"{host}:{self.server.server_port}" for host in (HOST, "localhost")]


def _explain(port: int, error: OSError) -> str:
    if error.errno == errno.EADDRINUSE:
        return (
            f"Port {port} is busy, perhaps with another skinnet web; give another by --port, or "
            "--port 0 for any that is free."
        )
    return f"Port {port} cannot be used ({error.strerror}); give another by --port, such as 8765."

"""Serves the page, by default to this computer alone."""

import errno
import ipaddress
import shutil
import socket
import sys
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import unquote, urlsplit

from skinnet.errors import InputError
from skinnet.inference._web.page_files import PageFile, list_files

HOST = "127.0.0.1"

_LARGEST_PORT = 65535

_NO_ADDRESS = errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT

_HEADERS = {
    # Memory that threads share is for pages that are isolated from others.
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Embedder-Policy": "require-corp",
    "Cross-Origin-Resource-Policy": "same-origin",
    # The browser itself then refuses to send anything to another place.
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; "
        "style-src 'self'; img-src 'self' blob: data:; media-src blob:; connect-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
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
        host: The address or name to listen at. By default only this computer can open the page.

    Raises:
        InputError: The port or the host cannot be used, or the page is not installed.
    """

    daemon_threads = True
    # On Windows it would let two servers have one port.
    allow_reuse_address = sys.platform != "win32"

    def __init__(self, port: int, host: str = HOST) -> None:
        if not 0 <= port <= _LARGEST_PORT:
            raise InputError(f"A port is 1 to {_LARGEST_PORT}, or 0 for any; got {port}.")
        if not host:  # it would be all networks
            raise InputError(_explain_host("''"))
        self.files = list_files()
        self.host = host
        self.address_family = socket.AF_INET6 if ":" in host else socket.AF_INET
        try:
            super().__init__((host, port), _PageRequest)
        except (OSError, UnicodeError) as error:
            raise InputError(_explain(host, port, error)) from error

    @property
    def address(self) -> str:
        """The page's address on this computer."""
        bound = ipaddress.ip_address(str(self.server_address[0]))
        if bound.is_unspecified:
            return f"http://{HOST}:{self.server_port}/"
        return f"http://{f'[{bound}]' if bound.version == 6 else bound}:{self.server_port}/"

    @property
    def is_local(self) -> bool:
        """Whether nothing but this computer can open the page."""
        return ipaddress.ip_address(str(self.server_address[0])).is_loopback

    def is_named(self, host: str | None) -> bool:
        """Whether a request's header `Host` names this server.

        Another page may point a name of its own at this computer, and then read what is here. An
        address cannot be pointed elsewhere, so that others may use the server's addresses. They
        may also come by another port, such as that of a container.
        """
        try:
            parts = urlsplit(f"//{host}")
            name, port = parts.hostname or "", parts.port
        except ValueError:
            return False
        if self.is_local:
            own = {HOST, "localhost", self.server_address[0]}
            return name in own and port == self.server_port
        return name in ("localhost", self.host.lower()) or _is_address(name)


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
        if not self.server.is_named(self.headers.get("Host")):
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


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _explain(host: str, port: int, error: OSError | UnicodeError) -> str:
    if isinstance(error, (socket.gaierror, UnicodeError)) or error.errno in _NO_ADDRESS:
        return _explain_host(host)
    if error.errno == errno.EADDRINUSE:
        return (
            f"Port {port} is busy, perhaps with another skinnet web; give another by --port, or "
            "--port 0 for any that is free."
        )
    return f"Port {port} cannot be used ({error.strerror}); give another by --port, such as 8765."


def _explain_host(host: str) -> str:
    return (
        f"{host} is no address of this computer; give --host 127.0.0.1, or --host 0.0.0.0 for all "
        "its networks."
    )

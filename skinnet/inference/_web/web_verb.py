"""The verb `skinnet web`."""

import argparse
import webbrowser

from skinnet.inference._messages import note, print_line
from skinnet.inference._web.page_server import PageServer


def web(options: argparse.Namespace) -> None:
    """Serve the page until Ctrl-C.

    Raises:
        InputError: The port or the host cannot be used, or the page is not installed.
    """
    with PageServer(options.port, options.host) as server:
        print_line(server.address)
        note(_describe_reach(server))
        if options.open:
            webbrowser.open(server.address)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            return


def _describe_reach(server: PageServer) -> str:
    if server.is_local:
        return "the page is open to this computer alone, until Ctrl-C."
    return (
        f"warning: --host {server.host} opens the page to everyone who can reach port "
        f"{server.server_port} of this computer, without a password and unencrypted, until Ctrl-C. "
        "Photographs still stay in the browser of whoever opens it."
    )

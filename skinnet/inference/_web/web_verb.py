"""The verb `skinnet web`."""

import argparse
import webbrowser

from skinnet.inference._messages import note, print_line
from skinnet.inference._web.page_server import PageServer


def web(options: argparse.Namespace) -> None:
    """Serve the page until Ctrl-C.

    Raises:
        InputError: The port cannot be used, or the page is not installed.
    """
    with PageServer(options.port) as server:
        print_line(server.address)
        note("the page is open to this computer alone, until Ctrl-C.")
        if options.open:
            webbrowser.open(server.address)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            return

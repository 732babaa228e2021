"""The server on this machine: its socket, its address, and how it ends."""

from __future__ import annotations

import os
import secrets
import socket
import threading
import webbrowser
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import uvicorn

from profiletool.errors import OutputError
from profiletool.studio.app import app_of
from profiletool.studio.session import Session

_LOOPBACK = "127.0.0.1"
_SLOW = "profiletool.studio.preview"  # to load: it shall be there when the first joint is dragged
_QUIET_SECONDS = 2  # for open connections to end


def serve(
    folder: Path, file: Path | None, port: int, *, browse: bool, say: Callable[[str], None]
) -> None:
    """Show the page until Ctrl-C.

    Parameters
    ----------
    folder : Path
        The work folder.
    file : Path or None
        A picture, a drawing or a design to begin with.
    port : int
        0 for any that is free.
    browse : bool
        Whether to open a browser.
    say : callable
        Takes one line at a time.

    Raises
    ------
    ProfiletoolError
    """
    with _socket(port) as ours, Session(folder) as session:
        if file is not None:
            session.open(file)
        token = secrets.token_urlsafe(16)
        port = ours.getsockname()[1]
        address = f"http://{_LOOPBACK}:{port}/{token}/"
        say(f"work folder: {folder}")
        say(f"the studio is at {address}")
        if "SSH_CONNECTION" in os.environ:
            say(f"from your own machine: ssh -L {port}:{_LOOPBACK}:{port} HOST, then open the same")
        say("Ctrl-C ends it; nothing is lost")
        threading.Thread(target=import_module, args=(_SLOW,), daemon=True).start()
        config = uvicorn.Config(
            app_of(session, token), log_level="critical", access_log=False, lifespan="off",
            ws="none", timeout_graceful_shutdown=_QUIET_SECONDS, server_header=False,
            h11_max_incomplete_event_size=16_384,
        )  # fmt: skip
        if browse:
            threading.Timer(0.3, webbrowser.open, (address,)).start()
        uvicorn.Server(config).run(sockets=[ours])


def _socket(port: int) -> socket.socket:
    """Listen on this machine alone.

    Raises
    ------
    OutputError
        Another program does on this port.
    """
    # With its protocol said, asyncio sends without delay: 40 ms less for each answer.
    ours = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        if os.name == "posix":  # elsewhere it would let two servers have one port
            ours.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        ours.bind((_LOOPBACK, port))
        ours.listen()
    except (OSError, OverflowError) as error:
        ours.close()
        raise OutputError(
            f"port {port} cannot be taken ({getattr(error, 'strerror', None) or error}): another "
            "studio may be there; choose another with `port`, or 0 for any"
        ) from error
    return ours

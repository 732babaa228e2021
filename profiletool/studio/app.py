"""The server's answers: the page, the state, what the page asks for, and the files."""

from __future__ import annotations

import io
import json
import math
import mimetypes
import time
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import asdict
from importlib import resources
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Route

from profiletool.errors import ProfiletoolError, UsageError
from profiletool.records.edit import Edit, edit_of
from profiletool.studio.commands import commands, export, files_of_version, toml_of
from profiletool.studio.form import fields, in_words, to_toml
from profiletool.studio.guard import Guard
from profiletool.studio.session import Session

_MOST_JSON, _MOST_PICTURE = 100_000, 50_000_000  # bytes, the latter as the readers take
_ASSETS = {"report.css": "profiletool.report", "film.js": "profiletool.report"}
_MOST_EDITS = 200
# The report has a script and styles of its own; it may do nothing here.
_OF_FILES = (
    "sandbox allow-scripts allow-popups; default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data:"
)


def app_of(session: Session, token: str) -> Guard:
    """Make the application of a session; its address begins with the token."""
    server = _Server(session)
    routes = [
        Route("/", server.page),
        Route("/page/{name}", server.asset),
        Route("/state", server.state),
        Route("/form", server.form),
        Route("/view/{number:int}", server.view),
        Route("/near", server.near),
        Route("/picture/{name}", server.picture),
        Route("/files/{number:int}/{name}", server.file),
        Route("/zip/{number:int}", server.zip),
        Route("/put/{name}", server.put, methods=["POST"]),
        Route("/do/{what}", server.do, methods=["POST"]),
        Route("/bend", server.bend, methods=["POST"]),
    ]
    handlers: Mapping[Any, Any] = {ProfiletoolError: _refused, ClientDisconnect: _gone}
    return Guard(Starlette(routes=routes, exception_handlers=handlers), token)


class _Server:
    def __init__(self, session: Session) -> None:
        self._session = session
        self._began = time.time_ns()

    async def page(self, request: Request) -> Response:
        return _asset("index.html")

    async def asset(self, request: Request) -> Response:
        return _asset(request.path_params["name"])

    async def form(self, request: Request) -> Response:
        return JSONResponse(fields())

    def state(self, request: Request) -> Response:
        session = self._session
        state, running = session.state, session.running
        current = None if state.current is None else session.version()
        tree: dict[str, Any] = {
            "server": self._began,
            "revision": session.revision,
            "folder": str(session.folder),
            "picture": state.picture,
            "values": state.values,
            "toml": to_toml(state.values) if current is None else toml_of(session, current),
            "said": session.said,
            "versions": [asdict(version) for version in state.versions],
            "current": state.current,
            "commands": [] if current is None else commands(session, current),
            "running": None,
        }  # fmt: skip
        if running is not None:
            tree["running"] = {
                "kind": running.job.kind, "share": running.share, "line": running.line,
                "seconds": time.monotonic() - running.began, "ticket": running.ticket,
                "near": running.near is not None,
            }  # fmt: skip
        if request.query_params.get("found") != str(session.found_revision):
            tree["found"] = session.found
        tree["found_revision"] = session.found_revision
        return JSONResponse(tree)

    def view(self, request: Request) -> Response:
        place = self._session.place(request.path_params["number"])
        return FileResponse(place.with_name(f"{place.name}.json"), media_type="application/json")

    def near(self, request: Request) -> Response:
        running = self._session.running
        if running is None or running.near is None:
            raise HTTPException(404, "nothing yet")
        return JSONResponse(running.near)

    def picture(self, request: Request) -> Response:
        return self._kept(self._session.folder, request.path_params["name"], ".jpg")

    def file(self, request: Request) -> Response:
        place = self._session.place(request.path_params["number"])
        answer = self._kept(place, request.path_params["name"])
        answer.headers["Content-Security-Policy"] = _OF_FILES
        return answer

    def _kept(self, folder: Any, name: str, ending: str = "") -> Response:
        """Give a file that lies in a folder itself: a name leads nowhere else."""
        names = {path.name for path in folder.iterdir() if path.is_file() and not path.is_symlink()}
        if name not in names or not name.endswith(ending):
            raise HTTPException(404, "no such file")
        return FileResponse(folder / name)

    def zip(self, request: Request) -> Response:
        number = request.path_params["number"]
        version = self._session.version(number)
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as packed:
            for name, data in files_of_version(self._session, version).items():
                packed.writestr(zipfile.ZipInfo(name), data, zipfile.ZIP_DEFLATED)
        headers = {"Content-Disposition": f'attachment; filename="design_{number}.zip"'}
        return Response(buffer.getvalue(), media_type="application/zip", headers=headers)

    async def put(self, request: Request) -> Response:
        data = await _body(request, _MOST_PICTURE)
        await run_in_threadpool(self._session.put, request.path_params["name"], data)
        return JSONResponse({})

    async def bend(self, request: Request) -> Response:
        tree = await _tree(request)
        return JSONResponse(await run_in_threadpool(self._bent, tree))

    def _bent(self, tree: dict[str, Any]) -> Any:
        from profiletool.studio.preview import preview

        edits, pressure = _edits(tree)
        changes = [edit_of(text) for text in edits]
        if pressure is not None:
            changes.append(Edit(pressure_bar=pressure))
        return preview(self._session.place(_number(tree)) / "design.json", changes)

    async def do(self, request: Request) -> Response:
        tree = await _tree(request)
        act = self._acts.get(request.path_params["what"])
        if act is None:
            raise HTTPException(404, "no such thing to do")
        return JSONResponse(await run_in_threadpool(act, self, tree) or {})

    def _set(self, tree: dict[str, Any]) -> None:
        self._session.set(tree.get("values"))

    def _change(self, tree: dict[str, Any]) -> None:
        self._session.change(*_edits(tree), base=_number(tree))

    def _go(self, tree: dict[str, Any]) -> None:
        self._session.go(_number(tree))

    def _export(self, tree: dict[str, Any]) -> dict[str, str]:
        name, force = tree.get("name"), tree.get("force", False)
        if not isinstance(name, str) or not isinstance(force, bool):
            raise UsageError("a folder's name is needed")
        version = self._session.version(_number(tree))
        return {"folder": str(export(self._session, version, name, force))}

    _acts: Mapping[str, Callable[[_Server, dict[str, Any]], Any]] = {
        "set": _set,
        "find": lambda server, tree: server._session.find(),
        "design": lambda server, tree: server._session.design(),
        "change": _change,
        "refine": lambda server, tree: server._session.refine(),
        "cancel": lambda server, tree: server._session.cancel(),
        "go": _go,
        "export": _export,
    }


def _asset(name: str) -> Response:
    place = resources.files(_ASSETS.get(name, "profiletool.studio.page"))
    file = place.joinpath(name)
    kind = mimetypes.guess_type(name)[0]
    if kind not in ("text/html", "text/css", "text/javascript") or not file.is_file():
        raise HTTPException(404, "no such file")
    return Response(file.read_bytes(), media_type=kind)


async def _body(request: Request, most: int) -> bytes:
    """Read a request's body, and no more of it than makes sense."""
    data = bytearray()
    async for part in request.stream():
        data += part
        if len(data) > most:
            raise HTTPException(413, f"larger than {most / 1e6:g} MB")
    return bytes(data)


async def _tree(request: Request) -> dict[str, Any]:
    """Read a request's JSON."""
    if request.headers.get("content-type", "").partition(";")[0] != "application/json":
        raise HTTPException(415, "JSON is needed")
    try:
        tree = json.loads(await _body(request, _MOST_JSON))
    except (ValueError, RecursionError):
        raise HTTPException(400, "this is no JSON") from None
    if not isinstance(tree, dict):
        raise HTTPException(400, "an object is needed")
    return tree


def _edits(tree: dict[str, Any]) -> tuple[list[str], float | None]:
    edits, pressure = tree.get("edits", []), tree.get("pressure_bar")
    texts = isinstance(edits, list) and all(isinstance(text, str) for text in edits)
    if not texts or len(edits) > _MOST_EDITS:
        raise UsageError("changes come as a list of texts")
    if pressure is not None:
        if isinstance(pressure, bool) or not isinstance(pressure, int | float):
            raise UsageError("a pressure is a number")
        if not math.isfinite(pressure):
            raise UsageError("a pressure is a finite number")
    return edits, None if pressure is None else float(pressure)


def _number(tree: dict[str, Any]) -> int:
    number = tree.get("version")
    if isinstance(number, bool) or not isinstance(number, int):
        raise UsageError("a version's number is needed")
    return number


async def _refused(request: Request, error: Exception) -> Response:
    del request
    return JSONResponse({"error": in_words(str(error))}, 400)


async def _gone(request: Request, error: Exception) -> Response:
    del request, error
    return Response(status_code=400)

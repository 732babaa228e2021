"""Who may ask the studio, and what it does with junk."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from tests.studio.conftest import TOKEN, Studio


@pytest.mark.parametrize(
    ("path", "headers", "code"),
    [
        (f"/{TOKEN}/state", {}, 200),
        (f"/{TOKEN}/state", {"host": "localhost:9000"}, 200),  # forwarded by SSH
        (f"/{TOKEN}/state", {"host": "[::1]:8741"}, 200),
        (f"/{TOKEN}/state", {"host": "evil.example"}, 421),
        (f"/{TOKEN}/state", {"host": "127.0.0.1.evil.example:8741"}, 421),
        (f"/{TOKEN}/state", {"host": ""}, 421),
        (f"/{TOKEN}/state", {"origin": "http://127.0.0.1:8741"}, 200),
        (f"/{TOKEN}/state", {"origin": "http://127.0.0.1:9999"}, 403),
        (f"/{TOKEN}/state", {"origin": "null"}, 403),
        (f"/{TOKEN}/state", {"sec-fetch-site": "cross-site"}, 403),
        (f"/{TOKEN}/state", {"sec-fetch-site": "same-site"}, 403),
        ("/state", {}, 404),
        ("/", {}, 404),
        ("//state", {}, 404),
        (f"/{TOKEN}", {}, 404),
        (f"/{TOKEN}x/state", {}, 404),
        (f"/{TOKEN[:-1]}/state", {}, 404),
        ("/\u00e4/state", {}, 404),
    ],
)
def test_who_may_ask(studio: Studio, path: str, headers: dict[str, str], code: int) -> None:
    answer = studio.client.get(path, headers=headers)
    assert answer.status_code == code
    if code != 200:
        assert "values" not in answer.text


def test_answers_are_for_our_page_alone(studio: Studio) -> None:
    for place in ("", "state", "page/main.js", "page/report.css", "form"):
        answer = studio.get(place)
        assert answer.status_code == 200, place
        assert "access-control-allow-origin" not in answer.headers
        assert "default-src 'none'" in answer.headers["content-security-policy"]
        assert answer.headers["referrer-policy"] == "no-referrer"
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["cache-control"] == "no-store"


@pytest.mark.parametrize(
    "place",
    [
        "page/../session.py", "page/..%2fsession.py", "page/%2e%2e/session.py", "page/session.py",
        "page/report.html", "picture/session.json", "picture/..%2f..%2fetc%2fpasswd",
        "picture/%2fetc%2fpasswd", "picture/link.jpg", "files/1/design.json", "files/0/x",
        "files/-1/x", "view/1", "zip/1", "nowhere",
    ],
)  # fmt: skip
def test_nothing_outside_the_work_folder(studio: Studio, place: str, tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("secret")
    (studio.session.folder / "link.jpg").symlink_to(tmp_path / "secret")
    answer = studio.get(place)
    assert 400 <= answer.status_code < 500
    assert "secret" not in answer.text


@pytest.mark.parametrize(
    "name",
    ["..%2fx.png", "%2e%2e%2fx.png", ".x.png", "a%2fb.png", "session.json", "1.json", "1.toml",
     "mask_0.png", "photo_a.jpg", "a%00.png", "a%0a.png", "-x.png", "x" * 200],
)  # fmt: skip
def test_names_that_no_picture_may_have(studio: Studio, name: str, samples: Path) -> None:
    before = sorted(studio.session.folder.parent.rglob("*"))
    data = (samples / "egg.png").read_bytes()
    answer = studio.client.post(f"/{TOKEN}/put/{name}", content=data)
    assert 400 <= answer.status_code < 500
    assert sorted(studio.session.folder.parent.rglob("*")) == before


def test_a_picture_that_is_too_large_is_not_taken(
    studio: Studio, monkeypatch: pytest.MonkeyPatch
) -> None:
    from profiletool.studio import app

    monkeypatch.setattr(app, "_MOST_PICTURE", 1000)
    answer = studio.client.post(f"/{TOKEN}/put/a.png", content=b"x" * 1001)
    assert answer.status_code == 413
    assert studio.state["picture"] is None


def test_malformed_requests_end_in_a_word(studio: Studio) -> None:
    """None of them raises: the client would raise it here."""
    draw = random.Random(1)
    junk = [
        None, True, -1, 1e999, "", "x", "\x00", "1:alpha=nan", "1:move=1e999", [], {}, [[]],
        {"version": {}}, "../..", 10**30, ["1:alpha=90"], ["0:"], "1" * 300,
    ]  # fmt: skip
    names = ["values", "version", "edits", "pressure_bar", "name", "force", "joints"]
    acts = ["set", "change", "go", "export", "cancel", "refine", "design", "nothing"]
    for number in range(200):
        place = draw.choice([*(f"do/{act}" for act in acts), "bend", "put/a.png", "state"])
        if number % 3:
            tree = {draw.choice(names): draw.choice(junk) for _ in range(3)}
            body = json.dumps(tree).encode()
        else:
            body = bytes(draw.randrange(256) for _ in range(draw.randrange(60)))
        headers = {"content-type": draw.choice(["application/json", "text/plain", "application/"])}
        answer = studio.client.post(f"/{TOKEN}/{place}", content=body, headers=headers)
        assert answer.status_code < 500, (place, body)
        assert "Traceback" not in answer.text
    assert studio.state["current"] is None


def test_deep_and_long_json_is_refused(studio: Studio) -> None:
    headers = {"content-type": "application/json"}
    for body, code in ((b"[" * 50_000, 400), (b" " * 200_000, 413), (b"[]", 400)):
        answer = studio.client.post(f"/{TOKEN}/do/set", content=body, headers=headers)
        assert answer.status_code == code

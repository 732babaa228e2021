"""The XML of a drawing, checked before anything of it is used: encodings, declarations, size."""

from __future__ import annotations

import re
import zlib
from xml.etree import ElementTree

from profiletool.errors import UnreadableInput

_MOST_BYTES = 20_000_000  # of what a .svgz unpacks to
_ENCODING = re.compile(rb"<\?xml[^>]*encoding\s*=\s*[\"']([A-Za-z0-9._-]+)[\"']")
_ENCODINGS = re.compile(r"utf-?8|us-ascii|ascii|iso-?8859-\d+|latin-?1|(?:windows-|cp)125\d",
                        re.IGNORECASE)  # fmt: skip
_DOCTYPE = re.compile(
    r"<!DOCTYPE\s+[\w:.-]+(?:\s+(?:PUBLIC\s+(?:\"[^\"<]*\"|'[^'<]*')|SYSTEM))?"
    r"(?:\s+(?:\"[^\"<]*\"|'[^'<]*'))?\s*(\[[^\[\]]*\])?\s*>",
    re.IGNORECASE,
)
# As Illustrator declares namespaces, and nothing else.
_NAMESPACE = re.compile(r"\s*<!ENTITY\s+([\w.-]+)\s+\"(https?://[\w./:-]{1,100})\"\s*>\s*")
_MAX_ENTITIES = 30
_DECLARED = (
    "holds a DOCTYPE or ENTITY declaration that declares more than names; save it as plain SVG"
)
_DECLARATION = re.compile(r"<!(?:DOCTYPE|ENTITY)", re.IGNORECASE)


def safe_text(data: bytes) -> str:
    """Decode a drawing, unpacked where it is packed, and take its DOCTYPE out.

    A DOCTYPE may name a public or system identifier, which nobody follows, and declare
    namespaces; in any other encoding than those known a declaration could hide.

    Raises
    ------
    UnreadableInput
    """
    if data.startswith(b"\x1f\x8b"):
        data = _unpacked(data)
    text = _decoded(data)
    found = _DOCTYPE.search(text)
    if found is not None:
        names = _namespaces((found[1] or "[]")[1:-1])
        text = text[: found.start()] + text[found.end() :]
        for name, value in names.items():
            if text.count(f"&{name};") <= _MAX_ENTITIES:
                text = text.replace(f"&{name};", value)
    if _DECLARATION.search(text):
        raise UnreadableInput(_DECLARED)
    return text


def parsed(text: str) -> ElementTree.Element:
    """Parse what `safe_text` gives.

    Raises
    ------
    UnreadableInput
        Not well-formed.
    """
    try:
        if "\0" in text:
            raise ValueError("holds null characters")
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise _malformed(error) from None


def _unpacked(data: bytes) -> bytes:
    unpacker = zlib.decompressobj(wbits=31)
    try:
        found = unpacker.decompress(data, _MOST_BYTES)
    except zlib.error as error:
        raise UnreadableInput(f"a damaged .svgz ({error}); export it again as plain SVG") from None
    if unpacker.unconsumed_tail:
        raise UnreadableInput(f"unpacks to more than {_MOST_BYTES / 1e6:g} MB; simplify it")
    return found


def _decoded(data: bytes) -> str:
    named = _ENCODING.match(data.lstrip()[:200])
    encoding = "utf-8-sig" if named is None else named[1].decode()
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        encoding = "utf-16"
    elif data.startswith(b"\xef\xbb\xbf") or not _ENCODINGS.fullmatch(encoding):
        encoding = "utf-8-sig"
    try:
        return data.decode(encoding)
    except (ValueError, LookupError) as error:
        raise _malformed(error) from None


def _malformed(error: Exception) -> UnreadableInput:
    return UnreadableInput(f"not well-formed XML in UTF-8 ({error}); export again")


def _namespaces(subset: str) -> dict[str, str]:
    """Read declarations of namespaces; nothing where there is any other declaration."""
    names = dict(_NAMESPACE.findall(subset))
    if _NAMESPACE.sub("", subset).strip() or len(names) > _MAX_ENTITIES:
        raise UnreadableInput(_DECLARED)
    return names

"""SVG files as drawing programs write them: pages, styles, clips, symbols, layers, grounds."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from pathlib import Path

import pytest

from profiletool.errors import NoObject, NoScale, UnreadableInput, UsageError
from tests.profile.drawing.egg import SIZE, path_data, size_of

NAMES = (
    'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
    'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
)
PAGE = 'width="100mm" height="110mm" viewBox="0 0 100 110"'
D = path_data()
EGG = f'<path d="{D}"/>'
LAYERS = (
    '<g inkscape:groupmode="layer" inkscape:label="Egg" id="layer1" style="display:none">'
    f'{EGG}</g><g inkscape:label="Other" id="layer2"><circle cx="200" cy="50" r="60"/></g>'
)


@pytest.fixture
def svg(tmp_path: Path) -> Callable[..., Path]:
    def save(body: str, page: str = PAGE, before: str = "") -> Path:
        (tmp_path / "a.svg").write_text(f"{before}<svg {NAMES} {page}>{body}</svg>")
        return tmp_path / "a.svg"

    return save


@pytest.mark.parametrize(
    ("body", "page"),
    [
        (EGG, 'width="200mm" height="110mm" viewBox="0 0 100 110"'),
        (EGG, 'width="100mm" height="55mm" viewBox="0 0 100 110" '
              'preserveAspectRatio="xMidYMid slice"'),
        (EGG, 'width="100mm" height="100%" viewBox="0 0 100 110"'),
        (EGG, 'width="10CM" viewBox="0 0 100 110"'),
        (EGG, 'style="top:0;width:100mm;height:110mm" viewBox="0 0 100 110"'),
        (EGG, f'{PAGE} inkscape:version="0.91 r13725"'),
        (f'<svg x="1" y="2" width="50" height="55" viewBox="0 0 100 110">{EGG}</svg>',
         'width="200mm" height="220mm" viewBox="0 0 100 110"'),
        (f'<symbol id="s" viewBox="0 0 100 110">{EGG}</symbol>'
         '<use href="#s" x="9" y="9" width="50" height="55" transform="scale(2)"/>', PAGE),
        (f'<switch><foreignObject/><g>{EGG}</g></switch>', PAGE),
        (f'<a xlink:href="#x">{EGG}</a>', PAGE),
        # what is not painted
        (f'<path d="M0 0h100v110H0z" fill="none"/>{EGG}', PAGE),
        (f'<rect width="99" height="109" fill="rgba(0,0,0,0)"/>{EGG}', PAGE),
        (f'<rect width="99" height="109" fill-opacity="0"/>{EGG}', PAGE),
        (f'<g opacity="0"><rect width="99" height="109" opacity="1"/></g>{EGG}', PAGE),
        (f'<rect width="99" height="109" fill="none" stroke="red" stroke-width="0"/>{EGG}', PAGE),
        ('<style>.a{fill:none} #b{display:none} g .c{opacity:0} rect.d{visibility:hidden}</style>'
         '<rect class="a" width="98" height="99"/><rect id="b" width="98" height="99"/>'
         '<g><rect class="c x" width="98" height="99"/></g><rect class="d" width="98" height="99"/>'
         f'{EGG}', PAGE),
        ('<style><![CDATA[ .w{fill:#FFFFFF;} /* .k{display:none} */ ]]></style>'
         f'<rect class="w" width="97" height="97"/><g class="k">{EGG}</g>', PAGE),
        (f'<rect width="97" height="97" fill="white" stroke="#fff"/>{EGG}', PAGE),
        # what is seen
        (f'<path fill="#333" d="{D[:-1]}"/>', PAGE),
        (f'<path fill="none" stroke="#000" d="{D}"/>', PAGE),
        (f'<linearGradient id="g"/><path fill="url(#g)" d="{D}"/>', PAGE),
        (f'<path fill-rule="evenodd" d="{D}M45 50h9v9h-9z"/>', PAGE),
        (f'<clipPath id="c"><path d="{D}"/></clipPath>'
         '<circle clip-path="url(#c)" cx="50" cy="55" r="90"/>', PAGE),
        (f'<defs><path id="p" d="{D}"/><clipPath id="c"><use href="#p"/></clipPath></defs>'
         '<g clip-path="url(#c)"><rect width="100" height="110"/></g>', PAGE),
        (f'<clipPath id="c"><rect width="100" height="110"/></clipPath><g clip-path="url(#c)">'
         f'<g clip-path="url(#c)">{EGG}</g></g>', PAGE),
        (f'<style>.k{{clip-path:url(#c)}}</style><clipPath id="c" transform="translate(1 1)"><path '
         f'd="{path_data(49, 54)}"/></clipPath><rect class="k" width="100" height="110"/>', PAGE),
    ],
)  # fmt: skip
def test_the_same_egg(
    svg: Callable[..., Path], notes_of: Callable[..., list[str]], body: str, page: str
) -> None:
    path = svg(body, page)
    assert size_of(path) == pytest.approx(SIZE, rel=1e-3)
    assert notes_of(path) == []


@pytest.mark.parametrize(
    ("body", "page", "before", "said"),
    [
        (f'<g transform="scale(3.7795276)">{EGG}</g>', 'width="378px" height="416"', "",
         "size in px alone, taken for 1/96 inch; `height_mm` or `width_mm` settle it"),
        (f'<path d="{path_data(99, 99, 90 / 25.4)}"/>', 'inkscape:version="0.48.4" width="9mm"', "",
         "Inkscape 0.48 has 90 px per inch"),
        (f'<path d="{path_data(99, 99, 72 / 25.4)}"/>', 'viewBox="0 0 300 300"',
         "<!-- Generator: Adobe Illustrator 25 -->", "Illustrator has 72 px per inch"),
        (f'<rect x="2" y="2" width="96" height="106" rx="6" fill="none" stroke="red"/>{EGG}', PAGE,
         "", "96.0 x 106.0 mm at (50.0, -55.0), was taken for a frame and left out"),
        (f'<rect x="2" y="2" width="96" height="106"/><path d="{D}" fill="#fff"/>', PAGE, "",
         "was taken for a frame and left out"),
        (f'<rect width="100" height="110" fill="#222"/><path d="{D}" fill="#fff"/>', PAGE, "",
         "a rectangle that covers the page was taken for the page and left out"),
        (f'<path fill="none" d="{D}"/>', PAGE, "", "nothing of the drawing is painted"),
        (f'<g inkscape:label="Off" style="display:none"><circle r="9"/></g>{EGG}', PAGE, "",
         "left out of the drawing: 1 hidden layer"),
        (f'<mask id="m"/><g mask="url(#m)">{EGG}</g>', PAGE, "", "left out of the drawing: 1 mask"),
        (f'{EGG}<rect x="30" y="40" width="40" height="40" fill="#fff"/>', PAGE, "",
         "a shape of 40.0 x 40.0 mm lies in it"),
        (f'<path d="{path_data(5.2e6, 100)}"/>', PAGE, "", "5200 m from its origin: it was moved"),
    ],
)  # fmt: skip
def test_what_was_done_is_told(
    svg: Callable[..., Path], notes_of: Callable[..., list[str]],
    body: str, page: str, before: str, said: str,
) -> None:  # fmt: skip
    path = svg(body, page, before)
    assert size_of(path) == pytest.approx(SIZE, rel=1e-3)
    (note,) = notes_of(path)
    assert said in note


@pytest.mark.parametrize("page", ["", 'viewBox="0 0 9 9"', 'width="20em" height="9em"'])
def test_no_physical_size(svg: Callable[..., Path], page: str) -> None:
    path = svg(EGG, page)
    with pytest.raises(NoScale, match="the file states no physical size; give `height_mm`"):
        size_of(path)
    assert size_of(path, height_mm=90.0) == pytest.approx(SIZE, rel=1e-3)
    assert size_of(path, width_mm=SIZE[0]) == pytest.approx(SIZE, rel=1e-3)
    assert size_of(path, mm_per_px=1.0) == pytest.approx(SIZE, rel=1e-3)


def test_stretched_pages_and_styles_that_turn(svg: Callable[..., Path]) -> None:
    wide = svg(EGG, f'{PAGE.replace("100mm", "200mm")} preserveAspectRatio="none"')
    assert size_of(wide) == pytest.approx((2 * SIZE[0], SIZE[1]), rel=1e-3)
    turned = svg(f'<path transform="rotate(90 50 55)" d="{D}"/>')
    assert size_of(turned) == pytest.approx(SIZE[::-1], rel=1e-3)


def test_a_layer_alone_even_if_it_is_hidden(svg: Callable[..., Path]) -> None:
    path = svg(LAYERS)
    assert size_of(path) == pytest.approx((120.0, 120.0), abs=0.03)
    for layer in ("Egg", "layer1"):
        assert size_of(path, layer=layer) == pytest.approx(SIZE, rel=1e-3)
    with pytest.raises(UsageError, match="no `layer` 'none'; there are 'Egg', 'Other'"):
        size_of(path, layer="none")


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("<text>egg</text>", "only text: turn it into paths"),
        (
            '<g inkscape:label="A" display="none"><circle r="9"/></g>',
            "not hidden: show it, or choose",
        ),
        ('<image href="data:image/png;base64,x"/>', "only a picture: trace it"),
    ],
)
def test_nothing_to_draw(svg: Callable[..., Path], body: str, says: str) -> None:
    with pytest.raises(NoObject, match=says):
        size_of(svg(body))


DOCTYPE = '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/svg11.dtd" [{}]>'


def test_everyday_declarations_encodings_and_packing(
    svg: Callable[..., Path], tmp_path: Path
) -> None:
    names = '<!ENTITY ns "http://www.w3.org/1999/xlink">\n<!ENTITY ns_ai "http://ns.adobe.com/a/">'
    assert size_of(svg(EGG, PAGE + ' xmlns:i="&ns_ai;"', DOCTYPE.format(names)))[1] > 89.9
    with pytest.raises(UnreadableInput, match="declares more than names"):
        size_of(svg(EGG, PAGE, DOCTYPE.format('<!ENTITY a SYSTEM "file:///etc/passwd">')))
    text = f'<svg {NAMES} {PAGE}><g id="Größe">{EGG}</g></svg>'
    for encoding in ("iso-8859-1", "windows-1252", "utf-16"):
        path = tmp_path / f"{encoding}.svg"
        path.write_bytes(f'<?xml version="1.0" encoding="{encoding}"?>{text}'.encode(encoding))
        assert size_of(path) == pytest.approx(SIZE, rel=1e-3)
    (tmp_path / "b.svg").write_bytes(gzip.compress(text.encode()))  # whatever its name
    assert size_of(tmp_path / "b.svg") == pytest.approx(SIZE, rel=1e-3)
    (tmp_path / "c.svgz").write_bytes(gzip.compress(b" " * 30_000_000))
    with pytest.raises(UnreadableInput, match="unpacks to more than 20 MB"):
        size_of(tmp_path / "c.svgz")

"""Drawings from text and from ezdxf."""

import ezdxf
import pytest

from profiletool import find_subject
from profiletool.api import request_for
from profiletool.profile.drawing.load import load_vector
from profiletool.subject.find import drawing_notes


@pytest.fixture
def load(tmp_path):
    def from_text(name, text):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return load_vector(path)

    return from_text


@pytest.fixture
def dxf(tmp_path):
    """Save a drawing that ``draw(modelspace, document)`` makes, and load it."""

    def through_file(draw, units=4, name="drawing.dxf", version="R2000"):
        document = ezdxf.new(version, units=units)
        draw(document.modelspace(), document)
        path = tmp_path / name
        document.saveas(path)
        return load_vector(path)

    return through_file


@pytest.fixture
def notes_of():
    """Notes on a drawing as a design would carry them."""

    def notes(path, **options):
        request = request_for(path, **options)
        return list(drawing_notes(request, find_subject(request)))

    return notes

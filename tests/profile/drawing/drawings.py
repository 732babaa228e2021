"""What the tests of drawings share."""

import ezdxf
import numpy as np
import pytest
import shapely

PX = 25.4 / 96


def svg(body, head='width="100mm" height="100mm" viewBox="0 0 100 100"'):
    return f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{body}</svg>'


def assert_same_ring(found, expected, atol=1e-9):
    """Same closed polygon, whatever its start and direction."""
    assert found.closed
    assert len(found.points) == len(expected)
    mine, theirs = shapely.LinearRing(found.points), shapely.LinearRing(expected)
    assert shapely.hausdorff_distance(mine, theirs) <= atol


def assert_circle(found, centre, radius, sagitta=0.0101):
    assert found.closed
    distance = np.hypot(*(found.points - centre).T)
    np.testing.assert_allclose(distance, radius, atol=1e-4)
    ring = shapely.LinearRing(found.points)
    assert radius - shapely.Point(centre).distance(ring) < sagitta
    assert ring.length == pytest.approx(2 * np.pi * radius, rel=2e-3)


SQUARE = [(0, 0), (20, 0), (20, 10), (0, 10)]


def dxf_text(draw):
    import io

    document = ezdxf.new("R2000", units=4)
    draw(document.modelspace())
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue()

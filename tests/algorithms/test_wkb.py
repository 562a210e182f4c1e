"""Geometries to arrays and back, bit for bit."""

import numpy as np
import pytest
from isthmus.algorithms.layers import wkb
from isthmus.core import wkb as core_wkb
from qgis.core import QgsGeometry, QgsWkbTypes


@pytest.mark.parametrize("kind, extra", [("", 0), (" Z", 1000), (" M", 2000), (" ZM", 3000)])
@pytest.mark.parametrize("multi", [False, True])
def test_round_trip(qgis_app, kind, extra, multi):
    more = {"": "", " Z": " 7.25", " M": " 8", " ZM": " 7.25 1e-300"}[kind]
    rings = [["0.1 0", "3 0", "0 1e17", "0.1 0"], ["0.2 0.1", "0.3 0.1", "0.2 0.2", "0.2 0.1"]]
    body = "(%s)" % ",".join("(%s)" % ",".join(p + more for p in ring) for ring in rings)
    wkt = f"MULTIPOLYGON{kind}({body},{body})" if multi else f"POLYGON{kind}{body}"
    geometry = QgsGeometry.fromWkt(wkt)
    rings, owner, dimensions = wkb.read_polygons([QgsGeometry(), geometry])
    count = 1 + multi
    assert owner.tolist() == [1] * count and dimensions == [0, extra]
    assert rings.offsets.tolist() == list(range(0, 6 * count + 1, 3))
    assert rings.polygon_offsets.tolist() == list(range(0, 2 * count + 1, 2))
    assert rings.coords.shape == (6 * count, 2 + len(kind.strip()))
    expected = QgsGeometry.fromWkt(f"MULTIPOLYGON{kind}({body})" if multi else f"POLYGON{kind}{body}")
    data = core_wkb.polygons(
        rings.coords, np.arange(6 * count), rings.offsets, rings.polygon_offsets, [extra] * count, multi
    )
    for back in wkb.geometries(data):
        assert back.asWkb() == expected.asWkb()
    ends = np.array([[0, 4]])
    (line,) = wkb.geometries(core_wkb.lines(rings.coords, ends, [extra]))
    assert (
        line.asWkb() == QgsGeometry.fromWkt(f"LINESTRING{kind}({rings_text(rings.coords[ends[0]])})").asWkb()
    )


def rings_text(points):
    return ", ".join(" ".join(map(repr, point)) for point in points.tolist())


def test_a_closing_vertex_with_another_z_is_kept(qgis_app):
    geometry = QgsGeometry.fromWkt("POLYGON Z((0 0 1,1 0 2,1 1 3,0 0 4))")
    rings, _, _ = wkb.read_polygons([geometry])
    assert rings.coords[:, 2].tolist() == [1, 2, 3, 4]


@pytest.mark.parametrize("wkt", ["POLYGON EMPTY", "MULTIPOLYGON EMPTY", "MULTIPOLYGON(EMPTY)"])
def test_empty(qgis_app, wkt):
    rings, owner, _ = wkb.read_polygons([QgsGeometry.fromWkt(wkt), QgsGeometry()])
    assert len(rings.coords) == len(owner) == 0


def test_common_type(qgis_app):
    kinds = QgsWkbTypes.Type
    assert wkb.common_type({kinds.Polygon}) == kinds.Polygon
    assert wkb.common_type({kinds.CurvePolygonZ}) == kinds.PolygonZ
    assert wkb.common_type({kinds.Polygon, kinds.MultiPolygonM}) == kinds.MultiPolygonM
    assert wkb.common_type({kinds.PolygonZ, kinds.PolygonM}) == kinds.PolygonZM
    assert wkb.line_type(kinds.MultiPolygonZM) == kinds.LineStringZM

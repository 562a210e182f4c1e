"""Natural candidates: do the cuts fall where people, maps and names have them?

    ./run python tests/benchmarks/natural.py [PART ...]

The parts are shapes, vertices, layers, coasts, necks, basins, levels, time. Without arguments all of it. --note writes what the pages tell to docs/measured/natural.json.
`shapes`, `vertices` and `basins` read data that are not part of the project, from the
folder shared/ beside it (or $ISTHMUS_SHARED); `coasts`, `necks`, `levels` and `time` read GSHHG (see gshhg.py
for the package to install). What is missing is said, and skipped. On maps the smallest part is
1 % of its feature and tau is 3; on silhouettes 0.2 % and 1, as the tables say.
"""

import importlib.util
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

import gshhg
import numpy as np
import shapely

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import conftest  # noqa: E402  (makes the package importable)

sys.path[:0] = [str(conftest.ROOT), str(conftest.ROOT / "tools")]

from measured import note  # noqa: E402

from isthmus.core import metric  # noqa: E402
from isthmus.core.partition import solve  # noqa: E402
from isthmus.core.partition.hierarchy import hierarchy  # noqa: E402
from isthmus.core.partition.natural import natural  # noqa: E402
from isthmus.core.partition.polygon import from_rings  # noqa: E402
from isthmus.core.partition.triangulation import diagonals, triangulate  # noqa: E402
from isthmus.core.rings import one_polygon, signed_areas  # noqa: E402
from tests.core import shapes, stages  # noqa: E402

GLOBE = metric.ellipsoidal()
SMALLEST, TAU = 0.01, 3.0  # on maps
SHARED = Path(os.environ.get("ISTHMUS_SHARED", conftest.ROOT.parent / "shared"))
NOTED = {}  # for docs/measured
WORLD = Path("/usr/share/qgis/resources/data/world_map.gpkg")


def table(head, rows):
    rows = [[str(cell) for cell in row] for row in rows]
    print("| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print(flush=True)


def missing(path):
    if not path.exists():
        print(f"skipped: there is no {path.name} in {SHARED}\n")
        return True
    return False


def no_coasts(*letters):
    absent = [letter for letter in letters if not gshhg.installed(letter)]
    if absent:
        print(f"skipped: GSHHG {', '.join(absent)} is not installed\n{gshhg.__doc__}\n")
    return bool(absent)


def ground(shape):
    return shapely.transform(shape, GLOBE.equal_area)


def prepare(told, share, measure=None):
    """Polygons with natural candidates; smaller parts than a share of their shells are none."""
    return solve.prepare(told, natural=True, smallest=share * shells(told, measure), measure=measure)


def shells(told, measure=None):
    """(p,) float: the area of each polygon without its holes."""
    plane = told.coords if measure is None else measure.equal_area(told.coords)
    return np.abs(signed_areas(plane, told.offsets)[told.polygon_offsets[:-1]])


# --------------------------------------------------------------------------------- people's parts


def measured_shapes():
    """Agreement with people on silhouettes, all in one chunk."""
    path, tool = SHARED / "data/shapes/shapes_dev.npz", SHARED / "tools/score_shapes.py"
    if missing(path) or missing(tool):
        return
    people, data = silhouettes()
    told = [(one["ring"], [0, len(one["ring"])]) for one in data]
    rings = stages.together(told)
    # halves by name, so that one kind of thing is in one of them
    kind = [one["name"].rstrip("0123456789").rstrip("-_") for one in data]
    first = np.isin(kind, sorted(set(kind))[::2])
    person = np.mean([people.person(one)[1] for one in data])

    rows = [("a person against another", "", "", f"{person:.3f}", "", "")]
    NOTED.update(silhouettes=len(data), person=round(person, 2))
    settings = [("Any", None, tau) for tau in (4.0, 3.0)]
    settings += [("Natural", 0.002, tau) for tau in (1.0, 1.5, 2.0, 3.0)]
    settings += [("Natural", SMALLEST, tau) for tau in (1.0, TAU)]
    prepared = {None: solve.prepare(rings)}
    for place, smallest, tau in settings:
        if smallest not in prepared:
            prepared[smallest] = prepare(rings, smallest)
        selection = solve.select(prepared[smallest], tau)
        ari = agreement(people, data, rings, solve.finish(prepared[smallest], selection).parts)
        share = "" if smallest is None else f"{smallest:.1%}"
        name = {
            ("Any", None, 4.0): "any",
            ("Natural", 0.002, 1.0): "shapes",
            ("Natural", SMALLEST, TAU): "default",
        }.get((place, smallest, tau))
        if name:
            NOTED[f"agreement_{name}"] = round(ari.mean(), 2)
        rows.append(
            (place, share, tau, f"{ari.mean():.3f}", f"{ari[first].mean():.3f}", f"{ari[~first].mean():.3f}")
        )
    print(f"Agreement with people (ARI), {len(data)} silhouettes; to reach: 0.53, and 0.45 at tau = {TAU:g}")
    table(("places", "smallest part", "tau", "ARI", "half of the kinds", "other half"), rows)


def silhouettes():
    """The module that scores them, and the silhouettes of the development half."""
    spec = importlib.util.spec_from_file_location("score_shapes", SHARED / "tools/score_shapes.py")
    people = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(people)
    return people, people.load(SHARED / "data/shapes/shapes_dev.npz")


def agreement(people, data, rings, parts, back=lambda xy: xy):
    """(s,) float: the ARI of parts with people's; ``back`` takes vertices to where people saw them."""
    outlines = [shapely.Polygon(back(rings.coords[part[0], :2])) for part in parts.rings]
    found = []
    for k, one in enumerate(data):
        own = outlines[parts.part_offsets[k] : parts.part_offsets[k + 1]]
        middle = shapely.points(one["triangle"].mean(axis=1))
        triangle, part = shapely.STRtree(own).query_nearest(middle, all_matches=False)
        label = np.empty(len(middle), dtype=int)
        label[triangle] = part
        found.append(people.score(one, label)[1])
    return np.array(found)


def measured_vertices():
    """The same silhouettes with other vertices: do people's parts come out as before?"""
    path = SHARED / "data/shapes/shapes_dev.npz"
    if missing(path) or missing(SHARED / "tools/score_shapes.py"):
        return
    people, data = silhouettes()
    told = [shapely.Polygon(one["ring"]) for one in data]

    def width(shape):
        west, south, east, north = shape.bounds
        return max(east - west, north - south)

    def quartered(shape):
        ring = shapely.get_coordinates(shape)
        at = np.arange(0, len(ring) - 1, 0.25)
        here, share = ring[at.astype(int)], (at % 1.0)[:, None]
        return shapely.Polygon(here + (ring[at.astype(int) + 1] - here) * share)

    turn = np.array(((0.6, 0.8), (-0.8, 0.6)))
    ways = {
        "as they are": lambda shape: shape,
        "turned by 53 degrees, and 5 million away": lambda shape: shapely.transform(
            shape, lambda xy: xy @ turn + 5e6
        ),
        "each edge in four": quartered,
        "a vertex every 1/200 of the width": lambda shape: shapely.segmentize(shape, width(shape) / 200),
        "generalised by 0.3 % of the width": lambda shape: shapely.simplify(shape, 0.003 * width(shape)),
        "outlines of pixels, 300 to a width": lambda shape: of_pixels(shape, width(shape) / 300),
        "outlines of pixels, 100 to a width": lambda shape: of_pixels(shape, width(shape) / 100),
    }
    rows = []
    for name, way in ways.items():
        shown = [way(one) for one in told]
        back = (lambda xy: (xy - 5e6) @ turn.T) if "turned" in name else (lambda xy: xy)
        row = [name, sum(len(one.exterior.coords) - 1 for one in shown)]
        rings = stages.together([shapes.from_shapely(one) for one in shown])
        for smallest, tau in ((0.002, 1.0), (SMALLEST, TAU)):
            prepared = prepare(rings, smallest)
            selection = solve.select(prepared, tau)
            found = agreement(people, data, rings, solve.finish(prepared, selection).parts, back)
            row += [len(selection.selected), f"{found.mean():.3f}"]
        rows.append(row)
    print("The same silhouettes with other vertices: cuts, and agreement with people")
    table(("", "vertices", "cuts, 0.2 %, tau 1", "ARI", f"cuts, 1 %, tau {TAU:g}", "ARI"), rows)


def of_pixels(shape, size):
    """The largest piece of the pixels with their middles in a polygon, as a raster is made polygons."""
    west, south, east, north = shape.bounds
    x, y = np.arange(west - size, east + size, size), np.arange(south - size, north + size, size)
    middle = np.meshgrid(x + size / 2, y + size / 2)
    full = np.zeros(np.array(middle[0].shape) + 2, dtype=bool)
    shapely.prepare(shape)
    full[1:-1, 1:-1] = shapely.contains_xy(shape, *middle)
    lines = []  # one for each edge between a full pixel and an empty one
    for axis, step in enumerate(((1, 0), (0, 1))):
        row, column = np.nonzero(np.diff(full, axis=axis))
        low = np.column_stack((column, row)) - step
        lines.append(np.stack((low, low + step), axis=1))
    faces = shapely.get_parts(shapely.polygonize(shapely.linestrings(np.concatenate(lines).astype(float))))
    largest = max((shapely.Polygon(face.exterior) for face in faces), key=lambda face: face.area)
    return shapely.transform(shapely.simplify(largest, 0), lambda xy: xy * size + (x[0], y[0]))


# ------------------------------------------------------------------------------------------- layers


def features(name):
    from osgeo import ogr

    ogr.UseExceptions()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "world.gpkg")  # opening it may write to it
        shutil.copyfile(WORLD, copy)
        source = ogr.Open(str(copy))
        found = [
            shapely.from_wkb(bytes(feature.GetGeometryRef().ExportToWkb()))
            for feature in source.GetLayerByName(name)
        ]
        source = None
    return found


def measured_layers():
    if not WORLD.exists():
        print(f"skipped: {WORLD.name} is not where QGIS has it\n")
        return
    rows = []
    for name in ("countries", "states_provinces"):
        told, smallest, whole = [], [], []
        for shape in features(name):
            polygons = shapely.get_parts(shape)
            area = shapely.area(ground(polygons))
            large = area >= 2 * SMALLEST * area.sum()  # the others have nothing to cut
            told += [shapes.from_shapely(one) for one in polygons[large]]
            smallest += [SMALLEST * area.sum()] * int(large.sum())
            whole += [area.sum()] * int(large.sum())
        all_told = stages.together(told)
        prepared = solve.prepare(all_told, natural=True, smallest=np.array(smallest), measure=GLOBE)
        number = prepared.polygons.number
        whole = np.array(whole)
        area = shells(all_told, GLOBE)[number]
        for tau in (2.5, TAU, 3.5):
            part = solve.finish(prepared, solve.select(prepared, tau))
            cut = np.flatnonzero(part.role == 0)
            side = prepared.share[cut] * area[prepared.owner[cut]]
            blunt = np.mean(side < prepared.chord[cut] ** 2)
            if tau == TAU:
                NOTED[name] = {"cuts": len(cut), "blunt": round(100 * blunt, 1)}
            made = np.repeat(np.diff(part.parts.part_offsets) > 1, np.diff(part.parts.part_offsets))
            of = np.repeat(number, np.diff(part.parts.part_offsets))
            rows.append(
                (
                    name,
                    tau,
                    len(cut),
                    np.count_nonzero(made),
                    f"{np.mean(part.parts.area[made] < 0.01 * whole[of[made]]):.1%}",
                    f"{blunt:.1%}",
                )
            )
    print("QGIS's world map; to reach: at most 1 %, and 15 %")
    table(
        (
            "layer",
            "tau",
            "cuts",
            "parts",
            "parts below 1 % of their feature",
            "cuts with less than a square on them",
        ),
        rows,
    )


# ------------------------------------------------------------------------------------------- coasts


def lands(letter, count=10):
    """The largest land masses, but for Antarctica, which GSHHG does not close."""
    found = []
    for size, _, read in sorted(gshhg.coasts(letter), key=lambda coast: -coast[0])[:120]:
        ring = read()
        if ring[:, 1].min() < -60.0 or np.ptp(ring[:, 0]) > 300.0:
            continue
        shape = shapely.Polygon(ring)
        if not shape.is_valid:
            shape = max(shapely.get_parts(shapely.make_valid(shape)), key=lambda part: part.area)
        found.append((ground(shape).area, shape))
    return [shape for _, shape in sorted(found, key=lambda one: -one[0])[:count]]


def ends_of_cuts(shape, tau, smallest=SMALLEST):
    told = shapes.from_shapely(shapely.Polygon(shape.exterior))
    prepared = prepare(one_polygon(*told), smallest, GLOBE)
    return prepared.polygons.xy[prepared.edges[solve.select(prepared, tau).selected]]


def near(one, other, within):
    """How many cuts of the one have a cut of the other with its middle, and its ends, within a distance."""
    a, b = (GLOBE.positions(cuts.reshape(-1, 2)).reshape(-1, 2, 3) for cuts in (one, other))
    if not len(a) or not len(b):
        return np.zeros(2, dtype=int)
    middle = np.linalg.norm(a.mean(axis=1)[:, None] - b.mean(axis=1)[None], axis=2).min(axis=1)
    ends = np.minimum(
        *(np.linalg.norm(a[:, None] - c[None], axis=3).max(axis=2) for c in (b, b[:, ::-1]))
    ).min(axis=1)
    return np.array([np.count_nonzero(middle <= within), np.count_nonzero(ends <= within)])


def measured_coasts():
    if no_coasts(*"lihf"):
        return
    rows, found = [], {}
    for letter in "lihf":
        begun = time.process_time()
        land = lands(letter)
        found[letter] = [(shape, ends_of_cuts(shape, TAU)) for shape in land]
        count = [len(cuts) for _, cuts in found[letter]]
        NOTED[f"land_{letter}"] = sum(count)
        rows.append((letter, sum(count), " ".join(map(str, count)), f"{time.process_time() - begun:.1f} s"))
    print(f"The ten largest land masses of GSHHG, tau = {TAU:g}; to reach: within 15 %")
    table(("detail", "cuts", "of each", "time"), rows)
    rows = []
    for name, one, other in (("i in f", "i", "f"), ("f in i", "f", "i")):
        hit, total = np.zeros(2, dtype=int), 0
        for shape, cuts in found[one]:
            twin = min(found[other], key=lambda pair: pair[0].centroid.distance(shape.centroid))
            west, south, east, north = ground(shape).bounds
            hit += near(cuts, twin[1], 0.02 * max(east - west, north - south))
            total += len(cuts)
        NOTED[f"same_{one}_{other}"] = dict(zip(("middles", "ends"), (round(100 * x) for x in hit / total)))
        rows.append((name, total, *(f"{share:.0%}" for share in hit / total)))
    print("Of these cuts, within 2 % of the land mass's width of each other; to reach: 85 %")
    table(("", "cuts", "middles", "both ends"), rows)


def measured_necks():
    """The named necks of docs/choosing_tau.md: the numbers are read from the script behind it."""
    if not WORLD.exists():
        print(f"skipped: {WORLD.name} is not where QGIS has it\n")
        return
    source = (conftest.ROOT / "tools/choosing_tau.py").read_text()
    begin = source.index("NECKS = {")
    names = {}
    exec(source[begin : source.index("}\n", begin) + 2], names)
    canals = {"Panama", "Africa, at Suez"}  # where GSHHG has open water
    least = 1e9  # 1,000 square kilometres: the smallest land that one of them holds, Cotentin, has more
    land = shapely.union_all(shapely.make_valid(features("countries")))
    maps = {"QGIS's map": [one for one in shapely.get_parts(land) if one.area > 5]}
    for letter in "li":  # on h and f, 22 necks against each cut take long and say the same
        if gshhg.installed(letter):
            maps[f"GSHHG {letter}"] = lands(letter, 12)
    rows = {name: [name] for name in names["NECKS"]}
    kinds = "of the page", "as typed"
    inside = {}  # whether the line as typed lies in the land of the map: else there is no such neck
    total = {(kind, what): [] for what in ("coast", "ends") for kind in kinds}
    drawn = []
    for label, shape in maps.items():
        best = {(name, kind): (np.inf, 0.0) for name in names["NECKS"] for kind in kinds}
        for one in shape:
            if ground(one).area > 3 * least:
                ring = shapely.get_coordinates(one.exterior)[:-1]
                cuts = ends_of_cuts(one, TAU, least / ground(one).area)
                for name, ends in names["NECKS"].items():
                    if typed_in_land(one, ring, np.array(ends)):
                        inside[label, name] = True
                    for kind, found in zip(kinds, against_neck(ring, cuts, np.array(ends))):
                        away, same = best[name, kind]
                        best[name, kind] = min(found[0], away), max(found[1], same)
        real = [name for name in names["NECKS"] if name not in canals or label == "QGIS's map"]
        for name in names["NECKS"]:
            away, same = best[name, kinds[0]]
            rows[name].append(f"{same:.2f}, {away:.0f} km" if name in real else "")
        for kind in kinds:
            total[kind, "coast"].append(np.mean([best[name, kind][1] >= 0.75 for name in real]))
            total[kind, "ends"].append(np.mean([best[name, kind][0] <= 60.0 for name in real]))
        there = [name for name in real if (label, name) in inside]
        drawn.append((len(there), sum(best[name, kinds[1]][1] >= 0.75 for name in there)))
        key = label.replace(" ", "_").replace("'", "")
        for noted, what in (("necks", "coast"), ("necks_ends", "ends")):
            NOTED.setdefault(noted, {})[key] = round(100 * total[kinds[0], what][-1])
    print(
        f"Named necks, smallest part {least / 1e6:,.0f} km2, tau = {TAU:g}: the best cut's share of the "
        "coast in common with what the neck of the page holds (of the coast that either has), and how far "
        "the ends of the nearest cut lie from that neck's; to reach: 90 %. As typed: of the vertices next "
        "to the places from which the page looks for the neck; drawable: only where the line between these "
        "vertices lies in the land of that map"
    )
    words = {"coast": "three quarters of the coast in common", "ends": "ends within 60 km"}
    table(
        ("neck", *maps),
        [
            *rows.values(),
            *(
                [f"**{words[what]}**, {kind}", *(f"{share:.0%}" for share in shares)]
                for (kind, what), shares in total.items()
            ),
            [
                f"**{words['coast']}**, as typed, where drawable",
                *(f"{hit} of {count}: {hit / count:.0%}" for count, hit in drawn),
            ],
        ],
    )


def typed_in_land(shape, ring, ends):
    """Whether the land holds the line between the vertices next to two places, which lie within 60 km."""
    place = GLOBE.positions(ring)
    far = [np.linalg.norm(place - end, axis=1) for end in GLOBE.positions(ends)]
    if max(distance.min() for distance in far) > 60_000:
        return False
    line = shapely.LineString(ring[[int(np.argmin(distance)) for distance in far]])
    return bool(shapely.covers(shapely.Polygon(shape.exterior), line))


def against_neck(ring, cuts, ends):
    """For the neck of docs/choosing_tau.md, and for the vertices next to where it is looked for: the
    distance of the nearest cut's ends (km), and the largest share of coast in common."""
    place, (a, b) = GLOBE.positions(ring), GLOBE.positions(ends)
    far = [np.linalg.norm(place - end, axis=1) for end in (a, b)]
    u, v = (int(np.argmin(distance)) for distance in far)
    if not len(cuts) or max(far[0][u], far[1][v]) > 60_000:
        return [(np.inf, 0.0)] * 2
    end = GLOBE.positions(cuts.reshape(-1, 2)).reshape(-1, 2, 3)
    step = np.linalg.norm(np.roll(place, -1, axis=0) - place, axis=1)
    row = {tuple(xy): k for k, xy in enumerate(ring.tolist())}
    held = [interval(*(row[tuple(xy)] for xy in cut), step) for cut in cuts.tolist()]
    held += [~one for one in held]

    def nearest(u, v, ends):
        off = np.linalg.norm(end[:, :, None] - ends, axis=3)  # cut, its end, end of the neck
        away = np.minimum(np.maximum(off[:, 0, 0], off[:, 1, 1]), np.maximum(off[:, 0, 1], off[:, 1, 0]))
        neck = interval(u, v, step)
        same = max(step[neck & one].sum() / step[neck | one].sum() for one in held)
        return away.min() / 1000.0, same

    neck = neck_near(place, step, u, v, *(np.flatnonzero(distance < 60_000) for distance in far))
    return nearest(*neck, place[list(neck)]), nearest(u, v, np.array((a, b)))


def neck_near(place, step, u, v, near_u, near_v):
    """The neck as tools/choosing_tau.py has it: of the chords between vertices near both ends that cut off
    about as much coast as those next to them, the one with the largest detour."""
    along = np.append(0.0, np.cumsum(step))
    way = np.abs(along[near_u][:, None] - along[near_v])
    way = np.minimum(way, along[-1] - way)
    wanted = abs(along[u] - along[v])
    wanted = min(wanted, along[-1] - wanted)
    chord = np.linalg.norm(place[near_u][:, None] - place[near_v], axis=2)
    same = (way >= wanted / 2) & (way <= wanted * 2) & (chord > 0.0)
    detour = np.where(same, way, 0.0) / np.maximum(chord, 1.0)
    i, j = np.unravel_index(np.argmax(detour), detour.shape)
    return int(near_u[i]), int(near_v[j])


def interval(u, v, step):
    """Which edges of a ring lie on the shorter way between two vertices."""
    one = np.zeros(len(step), dtype=bool)
    one[min(u, v) : max(u, v)] = True
    return one if step[one].sum() <= step[~one].sum() else ~one


# -------------------------------------------------------------------------------------------- basins


# Waters that these data do not name, by a place in the mouth of each (degrees), as sea charts have them.
UNNAMED = {
    "the Bothnian Bay, north of the Quark": (19.8, 62.8),
    "the Arkona Basin": (13.2, 54.9),
    "the east of the Gulf of Finland": (27.8, 60.1),
    "Green Bay": (-87.5, 45.0),
    "Saginaw Bay": (-83.5, 44.0),
    "Georgian Bay, Main Channel": (-81.7, 45.4),
    "Georgian Bay, Little Current": (-81.7, 45.9),
    "the North Channel": (-82.7, 46.1),
    "the North Channel, De Tour to the Mississagi Strait": (-83.6, 46.0),
    "the Gulf of Bahrain": (50.6, 26.2),
}


def measured_basins():
    import json

    folder = SHARED / "data/basins"
    if missing(folder):
        return

    def read(name):
        text = json.loads((folder / f"{name}.geojson").read_text())
        names = [one["properties"].get("name", "") for one in text["features"]]
        return [shapely.from_geojson(json.dumps(one["geometry"])) for one in text["features"]], names

    rows, drawn = [], []
    for name in ("baltic", "michigan_huron", "persian_oman"):
        (sea,), (truth, names) = read(f"{name}_input")[0], read(f"{name}_truth")
        truth = [shapely.make_valid(one) for one in truth]
        told = shapes.from_shapely(sea)
        prepared = solve.prepare(
            one_polygon(*told), natural=True, smallest=SMALLEST * ground(sea).area, measure=GLOBE
        )

        def polygons(selection):
            return [
                shapely.Polygon(told.coords[part[0], :2], [told.coords[hole, :2] for hole in part[1:]])
                for part in solve.finish(prepared, selection).parts.rings
            ]

        for tau in (TAU, 4.0):
            selection = solve.select(prepared, tau)
            parts = polygons(selection)
            found, joined = rand_indices(parts, truth)
            if tau == TAU:
                NOTED[f"agreement_{name}"] = round(found, 2)
                NOTED[f"joined_{name}"] = round(joined, 2)
                cuts = prepared.polygons.xy[prepared.edges[selection.selected]] * prepared.polygons.unit[0]
                km = prepared.chord[selection.selected] / 1000.0
                told_rows, with_unnamed = told_of_cuts(cuts, km, parts, truth, names)
                drawn += [(name, *row) for row in told_rows]
            rows.append(
                (
                    name,
                    len(truth),
                    tau,
                    len(parts),
                    len(selection.selected),
                    f"{found:.2f}",
                    f"{joined:.2f}",
                    f"{with_unnamed:.2f}" if tau == TAU else "",
                )
            )
        # the hierarchy's level with as many parts as there are names
        selection = solve.select(prepared, 1.0)
        nested = hierarchy(prepared, selection)
        for rank in range(len(nested.cut) + 1):
            level = selection._replace(selected=nested.cut[nested.rank <= rank])
            parts = polygons(level)
            if len(parts) == len(truth):
                found, joined = rand_indices(parts, truth)
                NOTED[f"level_{name}"] = round(found, 2)
                rows.append(
                    (
                        name,
                        len(truth),
                        f"{len(truth)} parts",
                        len(parts),
                        rank,
                        f"{found:.2f}",
                        f"{joined:.2f}",
                        "",
                    )
                )
                break
    print("Named seas and lakes (ARI by area); to reach: 0.8 where the truth has that many names")
    table(
        ("water", "names", "tau", "parts", "cuts", "ARI", "parts of one name joined", "unnamed waters named"),
        rows,
    )
    print("Each cut at the defaults: between two names, right though nobody named it, or not right")
    table(("water", "from", "to", "km", "parts beside it, 1,000 km2", "what it divides"), drawn)


def told_of_cuts(cuts, km, parts, truth, names):
    """A row for each cut: its ends in degrees, its length, the parts beside it, and what it divides.

    A part is of the water in which most of it lies. Also the ARI against the truth with what UNNAMED tells of.
    """
    region = ground(np.array(parts))
    area = shapely.area(region) / 1e9
    water = shapely.area(shapely.intersection(region[:, None], ground(np.array(truth))[None])).argmax(axis=1)
    corners = [set(map(tuple, shapely.get_coordinates(part).tolist())) for part in parts]
    rows, group = [], np.arange(len(parts))  # parts that should be one
    for ends, length in sorted(zip(cuts.tolist(), km), key=lambda row: row[1]):
        beside = [k for k, own in enumerate(corners) if own.issuperset(map(tuple, ends))]
        beside.sort(key=area.__getitem__)
        middle = np.mean(ends, axis=0)
        unnamed = [name for name, place in UNNAMED.items() if np.abs(middle - place).max() < 0.2]
        if len(set(water[beside])) > 1:
            what = " and ".join(names[water[k]] for k in beside)
        elif unnamed:
            what = f"not named: {unnamed[0]}"
        else:
            what = f"not right: {names[water[beside[0]]]}"
            group[group == group[beside[0]]] = group[beside[1]]
        places = (f"{y:.2f} N {abs(x):.2f} {'W' if x < 0 else 'E'}" for x, y in ends)
        rows.append((*places, f"{length:.0f}", " and ".join(f"{area[k]:.1f}" for k in beside), what))
    waters = []
    for k, whole in enumerate(truth):
        own = [parts[group == g] for parts, g in ((np.array(parts), g) for g in np.unique(group[water == k]))]
        nearest = [shapely.union_all(one) for one in own]
        if len(nearest) < 2:
            waters.append(whole)
            continue
        cells = [shapely.intersection(whole, one) for one in nearest]
        rest = shapely.difference(whole, shapely.union_all(nearest))
        largest = int(np.argmax(shapely.area(cells)))
        cells[largest] = shapely.union(cells[largest], rest)
        waters += cells
    return rows, rand_indices(parts, waters)[0]


def rand_indices(parts, truth):
    """Adjusted Rand index by area: two places are together or apart. The second when parts that lie mostly in
    the same named water are one, so that cuts which no name asks for do not count.
    """
    parts, truth = ground(np.array(parts)), ground(np.array(truth))
    both = shapely.area(shapely.intersection(parts[:, None], truth[None]))
    both /= both.sum()
    joined = np.zeros((len(truth), len(truth)))
    np.add.at(joined, both.argmax(axis=1), both)

    def index(both):
        together = (both**2).sum()
        one, other = (both.sum(axis=1) ** 2).sum(), (both.sum(axis=0) ** 2).sum()
        return (together - one * other) / ((one + other) / 2 - one * other)

    return index(both), index(joined)


# ------------------------------------------------------------------------------------ levels and time


def measured_levels():
    """Nested cuts beside the optimum."""
    told = []
    path = SHARED / "data/shapes/shapes_dev.npz"
    sets = {}
    if not missing(path):
        data = np.load(path)
        told = np.split(data["ring"], data["ring_start"][1:-1])
        sets["silhouettes"] = prepare(stages.together([(ring, [0, len(ring)]) for ring in told]), 0.002)
    if WORLD.exists():
        polygons = shapely.get_parts(np.array(features("countries")))
        polygons = [one for one in polygons if shapely.area(ground(one)) > 1e9 and one.is_valid]
        sets["countries"] = prepare(
            stages.together([shapes.from_shapely(one) for one in polygons]), SMALLEST, GLOBE
        )
    if not no_coasts("i"):
        land = [shapes.from_shapely(shapely.Polygon(one.exterior)) for one in lands("i")]
        sets["coasts"] = prepare(stages.together(land), 1e-3, GLOBE)
    taus = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 30.0)
    rows = []
    for name, prepared in sets.items():
        found = hierarchy(prepared, solve.select(prepared, taus[0], with_dilation=False))
        nested = [np.count_nonzero(found.persistence > tau) for tau in taus]
        best = [len(solve.select(prepared, tau, with_dilation=False).selected) for tau in taus]
        rows += [(name, "nested", *nested), (name, "optimum", *best)]
    print("Cuts by tau: one nested set beside the optimum for each tau")
    table(("", "", *(f"{tau:g}" for tau in taus)), rows)


def measured_time():
    """What the stage costs beside the triangulation, and the hierarchy beside the partition."""
    rows = []
    told = []
    if not no_coasts("f"):
        told.append(("coast", gshhg.eurasia("f"), GLOBE))
    n = 580_000
    x = np.arange(n, dtype=float)
    rough = np.random.default_rng(1).uniform(-0.2, 0.2, (2, n))
    corridor = np.concatenate((np.column_stack((x, rough[0])), np.column_stack((x, 3 + rough[1]))[::-1]))
    told.append(("corridor", corridor, metric.planar()))
    for name, ring, measure in told:
        triangulate(from_rings(one_polygon(ring[:9], [0, 9]))[0])  # it is loaded
        clock = [time.process_time()]

        def lap():
            clock.append(time.process_time())

        polygons, _ = from_rings(one_polygon(ring, [0, len(ring)]))
        lap()
        triangles, *_ = triangulate(polygons, conformal=measure.conformal)
        lap()
        edges = diagonals(polygons, triangles)
        position = measure.positions(polygons.xy)
        area = shells(one_polygon(ring, [0, len(ring)]), measure)
        lap()
        found = natural(polygons, edges, triangles, position, measure, SMALLEST * area)
        lap()
        prepared = solve.prepare(
            one_polygon(ring, [0, len(ring)]), natural=True, smallest=SMALLEST * area, measure=measure
        )
        selection = solve.select(prepared, 1.0)
        solve.finish(prepared, selection)
        lap()
        hierarchy(prepared, selection)
        lap()
        rows.append(
            (
                name,
                f"{len(ring):,}",
                int(found.kept.sum()),
                *(f"{d:.2f}" for d in np.diff(clock)[[0, 1, 3, 4, 5]]),
            )
        )
    print("Seconds of one processor")
    table(
        (
            "",
            "vertices",
            "candidates",
            "checks",
            "triangulation",
            "natural",
            "checks to parts",
            "hierarchy after it",
        ),
        rows,
    )


PARTS = {
    name.removeprefix("measured_"): function
    for name, function in list(globals().items())
    if name.startswith("measured_")
}

if __name__ == "__main__":
    asked = [word for word in sys.argv[1:] if word != "--note"]
    unknown = set(asked) - set(PARTS)
    if unknown:
        sys.exit(f"{', '.join(sorted(unknown))}: choose from {', '.join(PARTS)}\n{__doc__}")
    for name in asked or PARTS:
        PARTS[name]()
    if "--note" in sys.argv:
        note("natural", {"source": "natural.py --note", **NOTED})

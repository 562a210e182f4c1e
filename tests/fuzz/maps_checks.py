"""What must hold for every map, told by other means than the tools' own."""

import math
from fractions import Fraction

import numpy as np
import shapely
from qgis.core import NULL, QgsUnitTypes

SURE = 1e-6  # relative; for sums of lengths and areas


def shape_of(feature):
    """A shapely geometry; None where there is none, or a coordinate is not finite."""
    geometry = feature.geometry()
    if geometry.isNull() or geometry.isEmpty():
        return None
    try:
        shape = shapely.force_2d(shapely.from_wkb(bytes(geometry.asWkb())))
    except shapely.errors.GEOSException:  # a ring of three points, for one
        return None
    return shape if np.isfinite(shapely.get_coordinates(shape)).all() else None


def vertices(geometry):
    """Bit for bit: x, y, z, m of all vertices (NaN as text, since it is not equal to itself)."""
    return [(repr(v.x()), repr(v.y()), repr(v.z()), repr(v.m())) for v in geometry.vertices()]


def is_tame(shapes):
    """Whether these are areas that everything is promised of: valid, without overlaps, of sane size."""
    known = [one for one in shapes if one is not None]
    if not known or not shapely.is_valid(known).all():
        return False
    largest = np.abs(shapely.get_coordinates(known)).max()
    size = np.ptp(shapely.get_coordinates(known), axis=0).max()
    if not (1e-12 < size and largest < 1e6 * size and largest < 1e15):
        return False
    if min(one.area / one.length for one in known) < 1e-7 * largest:  # as thin as what counts as equal
        return False
    tree = shapely.STRtree(known)
    a, b = tree.query(known, predicate="intersects")
    twice = sum(known[i].intersection(known[j]).area for i, j in zip(a, b) if i < j)
    return twice <= 1e-12 * sum(one.area for one in known) and min(one.area for one in known) > 1e-9 * size**2


def shared_lengths(shapes):
    """The length of boundary that each pair has in common; None where a hair's breadth decides."""
    known = [k for k, one in enumerate(shapes) if one is not None]
    segments, owner = [], []
    for k in known:
        for ring in shapely.get_rings(shapely.get_parts(shapes[k])):
            xy = shapely.get_coordinates(ring)
            some = np.stack((xy[:-1], xy[1:]), axis=1)
            segments.append(some[(some[:, 0] != some[:, 1]).any(axis=1)])
            owner += [k] * len(segments[-1])
    if not owner:
        return {}
    segments, owner = np.concatenate(segments), np.array(owner)
    tolerance = 1e-9 * np.abs(segments).max()
    lines = shapely.linestrings(segments)
    a, b = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=8 * tolerance)
    apart = owner[a] < owner[b]
    a, b = a[apart], b[apart]
    found = [{}, {}]
    along = segments[a, 1] - segments[a, 0]
    length = np.hypot(*along.T)
    along /= length[:, None]
    other = segments[b] - segments[a, :1]
    at = (other * along[:, None]).sum(axis=2)  # where the other's ends are along this, and beside it
    beside = other[..., 0] * along[:, None, 1] - other[..., 1] * along[:, None, 0]
    slope = np.divide(
        *np.diff(np.stack((beside, at)), axis=2)[..., 0],
        out=np.full(len(a), np.inf),
        where=at[:, 0] != at[:, 1],
    )
    lo, hi = np.maximum(at.min(axis=1), 0.0), np.minimum(at.max(axis=1), length)
    with np.errstate(invalid="ignore"):
        off = np.maximum(*(np.abs(beside[:, 0] + slope * (end - at[:, 0])) for end in (lo, hi)))
    for one, limit in zip(found, (tolerance / 8, tolerance * 8)):
        for k in np.flatnonzero((off <= limit) & (hi - lo > 16 * tolerance)).tolist():
            pair = int(owner[a[k]]), int(owner[b[k]])
            one[pair] = one.get(pair, 0.0) + float(hi[k] - lo[k])
    sure, perhaps = found
    same = set(sure) == set(perhaps) and all(abs(sure[p] - perhaps[p]) <= 1e-5 * sure[p] for p in sure)
    return sure if same else None


def metres(crs):
    """Metres in a unit of a projected CRS; QGIS 3.22 takes the foot of the survey for the other one."""
    if crs.authid() != "EPSG:2263":
        return 1.0
    return QgsUnitTypes.fromUnitToUnitFactor(crs.mapUnits(), QgsUnitTypes.DistanceUnit.DistanceMeters)


def connected(members, pairs):
    """Whether areas hang together by a union-find over pairs."""
    parent = {v: v for v in members}

    def root(v):
        while parent[v] != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    for a, b in pairs:
        if a in parent and b in parent:
            parent[root(a)] = root(b)
    return len({root(v) for v in members}) <= 1


def messages(case, out):
    """No exception but a clear one."""
    wrong = [f"exception: {text.strip().splitlines()[-1]}\n{text}" for text in out.crashes]
    for text in [out.refused, *out.feedback.said]:
        if "Traceback" in text or " object at 0x" in text or text == "(no words)" or "None." in text:
            wrong.append(f"unclear message: {text[:300]}")
    if out.left and (out.refused or out.feedback.isCanceled()):
        wrong.append(f"half written: {out.left}")
    if out.refused and not case.get("may_refuse"):
        wrong.append(f"refused: {out.refused[:300]}")
    return wrong


def close(a, b, scale=0.0):
    return abs(a - b) <= SURE * max(abs(a), abs(b)) + 1e-9 * scale


def written(out, names):
    return [name for name in names if out.layers.get(name) is None]


# ---- prepareaggregation


def check_prepare(case, out):
    wrong = messages(case, out)
    if wrong or out.refused or "OUTPUT" not in out.results:
        return wrong + ["no result"] * (not wrong and not out.refused and not out.feedback.isCanceled())
    if written(out, case["outputs"]):
        return ["a layer that was written cannot be read"]
    areas, pieces, pairs = out.rows["INPUT"], out.layers["OUTPUT"], out.layers["ADJACENCY"]
    whole = case["output"] == "memory"
    own = [f.name() for f in out.inputs["INPUT"].fields()]
    got = [f.name() for f in pieces[0].fields()] if pieces else own
    base = got.index(own[-1]) + 1 if whole else len(got) - 4  # a GeoPackage has a fid of its own
    found = {}
    for piece in pieces:
        found.setdefault(piece.attributes()[base], []).append(piece)
    ids = {area.id() for area in areas}
    if set(found) != ids:
        return [
            f"areas without a piece: {sorted(ids - set(found))[:5]}, unknown: {sorted(set(found) - ids)[:5]}"
        ]
    numbers = [p.attributes()[base + 1] for p in pieces if p.attributes()[base + 1] != NULL]
    if sorted(numbers) != list(range(1, len(numbers) + 1)):
        wrong.append(f"numbers of pieces: {numbers[:20]}")
    for area in areas:
        mine = found[area.id()]
        if whole and any(p.attributes()[:base] != area.attributes() for p in mine):
            wrong.append(f"attributes of area {area.id()} changed")
        states = [p.attributes()[base + 3] for p in mine]
        wrong += _tiles(area, mine, states, whole, out.parameters.get("NEW_VERTICES"))
    shapes = [shape_of(p) for p in pieces]
    crs = out.inputs["INPUT"].crs()
    if crs.isGeographic() or not whole or not is_tame(shapes):
        return wrong
    area_of = {p.attributes()[base + 1]: p.attributes()[base] for p in pieces}
    expected = shared_lengths(shapes)
    if expected is None:
        return wrong
    longest = max(expected.values(), default=1.0)
    number = [p.attributes()[base + 1] for p in pieces]
    metre = metres(crs)
    listed = {}
    for row in pairs:
        a, b, length, virtual = row.attributes()[-4:]
        if (min(a, b), max(a, b)) in listed:
            wrong.append(f"pair {a} {b} twice")
        listed[min(a, b), max(a, b)] = length
        if bool(virtual) != (area_of[a] == area_of[b]):
            wrong.append(f"pair {a} {b} virtual {virtual}")
    for (i, j), length in expected.items():
        key = min(number[i], number[j]), max(number[i], number[j])
        said = listed.pop(key, 0.0) / metre
        if abs(said - length) > 1e-4 * length:
            wrong.append(f"pieces {key} share {length}, listed {said}")
    wrong += [f"pieces {key} are no neighbours" for key, length in listed.items() if length > 1e-6 * longest]
    return wrong


def _edges(geometry):
    """Directed edges of all rings, the polygon on the left, by points bit for bit (Z and M too)."""
    found = []
    abstract = geometry.constGet()
    parts = list(geometry.constParts()) if abstract else []
    for part in parts:
        for k in range(1 + part.numInteriorRings() if part.exteriorRing() else 0):
            ring = part.exteriorRing() if k == 0 else part.interiorRing(k - 1)
            points = [(repr(p.x()), repr(p.y()), repr(p.z()), repr(p.m())) for p in ring.points()]
            flat = [(p.x(), p.y()) for p in ring.points()]
            turn = sum(
                (a[0] - flat[0][0]) * (b[1] - flat[0][1]) - (b[0] - flat[0][0]) * (a[1] - flat[0][1])
                for a, b in zip(flat[:-1], flat[1:])
            )
            steps = [(a, b) for a, b in zip(points[:-1], points[1:]) if a[:2] != b[:2]]
            found += [(b, a) for a, b in steps] if (turn > 0) != (k == 0) else steps
    return found


def _tiles(area, pieces, states, whole, added):
    """The pieces have the area's own vertices, and its own edges once; new edges cut both ways.

    Where vertices may be ``added``, they lie on the outline: the lone edges make the same one.
    """
    before = area.geometry()
    if any(state not in ("", None, NULL) for state in states) or before.isNull() or before.isEmpty():
        after = [p.geometry() for p in pieces if not p.geometry().isNull()]
        count = sum(len(vertices(one)) for one in after)
        if whole and count != len(vertices(before)) and len(pieces) == 1:
            return [f"area {area.id()} has {len(vertices(before))} vertices, and {count} after"]
        return []
    wrong = []
    flat = {v[:2] for v in vertices(before)}
    new = {v[:2] for p in pieces for v in vertices(p.geometry())} - flat
    if whole and new and not added:
        wrong.append(f"area {area.id()} has new vertices {sorted(new)[:3]}")
    if whole and not all(p.geometry().isGeosValid() for p in pieces):  # a GeoJSON is rounded
        wrong.append(f"a piece of area {area.id()} is not valid")
    old = [(a[:2], b[:2]) for a, b in _edges(before)]
    made = [(a[:2], b[:2]) for p in pieces for a, b in _edges(p.geometry())]
    lone = set(made) - {(b, a) for a, b in made}
    if whole and len(set(old)) == len(old):
        kept = set(old) - {(b, a) for a, b in old}
        if not kept <= set(made) or lone != kept:
            # a vertex of one ring inside an edge of another is put in
            if not _same_outline(kept, lone):
                wrong.append(f"the pieces of area {area.id()} do not tile it")
    if len(set(made)) != len(made) and len(set(old)) == len(old):
        wrong.append(f"pieces of area {area.id()} have an edge twice")
    return wrong


def _same_outline(a, b):
    lines = [
        shapely.union_all(shapely.linestrings([[tuple(map(float, p)) for p in edge] for edge in edges]))
        for edges in (a, b)
    ]
    # a vertex that was put in lies on the edge but for rounding
    near = 1e-9 * lines[0].length
    return abs(lines[0].length - lines[1].length) <= near and shapely.hausdorff_distance(*lines) <= near


# ---- aggregate


def check_aggregate(case, out):
    wrong = messages(case, out)
    if wrong or out.refused or "OUTPUT" not in out.results:
        return wrong + ["no result"] * (not wrong and not out.refused and not out.feedback.isCanceled())
    if written(out, case["outputs"]):
        return ["a layer that was written cannot be read"]
    rows, regions, given = out.rows["INPUT"], out.layers["OUTPUT"], out.layers["ASSIGNMENT"]
    results = out.results
    names = out.inputs["INPUT"].fields().names()
    cls, key = names.index(out.parameters["CLASS"]), len(names) - 1
    memory = case["output"] == "memory"
    shift = 0 if memory or not given else len(given[0].attributes()) - len(names) - 4
    keys = [f.attributes()[key] for f in rows]
    if sorted(f.attributes()[key + shift] for f in given) != sorted(keys):
        return [f"areas in: {sorted(keys)}, out: {sorted(f.attributes()[key + shift] for f in given)}"]
    at = {k: place for place, k in enumerate(keys)}
    numbers = [f.attributes()[-6] for f in regions]
    if len(set(numbers)) != len(numbers) or len(regions) != results["REGION_COUNT"]:
        wrong.append(f"numbers of regions {numbers}, {results['REGION_COUNT']} told")
    label, kept = {}, {}
    for f in given:
        region, new_class, changed, status = f.attributes()[-4:]
        k = at[f.attributes()[key + shift]]
        label[k] = None if region == NULL else region
        kept[k] = new_class
        if not bool(changed) and text(new_class) != text(rows[k].attributes()[cls]):
            wrong.append(f"area {k} keeps its class {rows[k].attributes()[cls]!r}, and gets {new_class!r}")
        if label[k] is None and not status:
            wrong.append(f"area {k} has no region, and no reason")
    members = {}
    for k, region in label.items():
        if region is not None:
            members.setdefault(region, []).append(k)
    if set(members) != set(numbers):
        return wrong + [f"regions {sorted(members)} given, {sorted(numbers)} written"]
    shapes = [shape_of(f) for f in rows]
    tame = is_tame(shapes)
    crs = out.inputs["INPUT"].crs()
    metre = metres(crs)
    planar = not crs.isGeographic()
    sizes = [0.0 if one is None else one.area * metre**2 for one in shapes]
    pairs = shared_lengths(shapes) if tame else None
    tame = pairs is not None
    theta = case["thresholds"]
    least = float(out.parameters["THRESHOLD"])
    core_of = {}
    for f in regions:
        region, own_class, size, count, core, status = f.attributes()[-6:]
        mine = members[region]
        classes = {text(rows[k].attributes()[cls]) for k in mine}
        if text(own_class) not in classes or any(text(kept[k]) != text(own_class) for k in mine):
            wrong.append(f"region {region} has class {own_class!r}, its areas {classes}")
        place = [k for k in mine if rows[k].id() == core]
        if not place or text(rows[place[0]].attributes()[cls]) != text(own_class):
            wrong.append(f"the core {core} of region {region} is none of its areas, or has another class")
        core_of[region] = place[0] if place else mine[0]
        if count != len(mine):
            wrong.append(f"region {region} has {len(mine)} areas, and says {count}")
        need = theta.get(text(own_class), least)
        if not status and (need is None or size < need * (1 - 1e-9)):
            wrong.append(f"region {region} is too small ({size} of {need}), and nothing is said")
        known = all(shapes[k] is not None or rows[k].geometry().isEmpty() for k in mine)
        if tame and planar and known and not close(size, sum(sizes[k] for k in mine)):
            wrong.append(f"region {region} has size {size}, its areas {sum(sizes[k] for k in mine)}")
        if tame and not connected(mine, pairs):
            wrong.append(f"region {region} with areas {mine} is not contiguous")
        if case["output"] in ("memory", "gpkg"):  # a GeoJSON is rounded, and takes no NaN
            wrong += _region_shape(f, [rows[k] for k in mine], [shapes[k] for k in mine], tame, memory)
    if not (tame and planar and memory) or wrong:
        return wrong
    return _cost(case, out, rows, cls, shapes, sizes, label, core_of, pairs, metre)


def text(value):
    if value is None or value == NULL:
        return None
    return str(int(value) if isinstance(value, float) and value.is_integer() else value).strip() or None


def _region_shape(region, rows, shapes, tame, memory):
    after = shape_of(region)
    known = [one for one in shapes if one is not None]
    wrong = []
    if all(shapely.is_valid(one) for one in known) and len(known) == len(shapes):
        if after is None or not after.is_valid:
            return [f"region {region.id()} of valid areas is not valid"]
        whole = shapely.union_all(known)
        apart = shapely.symmetric_difference(after, whole).area
        if apart > 1e-9 * whole.area + 1e-13 * np.abs(shapely.get_coordinates(known)).max() ** 2:
            wrong.append(f"region {region.id()} and the union of its areas differ by {apart}")
    elif len(rows) > 1 and (after is None or not after.is_valid):
        wrong.append(f"region {region.id()} of several areas is not valid")
    if tame and memory:
        flat = {v[:2] for one in rows for v in vertices(one.geometry())}
        new = {v[:2] for v in vertices(region.geometry())} - flat
        if new:
            wrong.append(f"region {region.id()} has new vertices {sorted(new)[:3]}")
    return wrong


def _spread(shape):
    """Root mean square distance of the points of a polygon from its centroid, by fans of triangles."""
    if shape is None or not shape.area:
        return 0.0
    middle, second, area = np.array(shape.centroid.coords[0]), 0.0, 0.0
    for part in shapely.get_parts(shape):
        for ring, sign in ((part.exterior, 1), *((hole, -1) for hole in part.interiors)):
            xy = shapely.get_coordinates(ring) - middle
            turn = sign * (1 if ring.is_ccw else -1)
            for p, q in zip(xy[:-1], xy[1:]):  # the triangle of the centroid and an edge
                size = turn * (p[0] * q[1] - p[1] * q[0]) / 2.0
                area += size
                second += size * (p @ p + q @ q + p @ q) / 6.0
    return math.sqrt(max(second / area, 0.0)) if area > 0.0 else 0.0


def _cost(case, out, rows, cls, shapes, sizes, label, core_of, pairs, metre):
    """The cost from the areas themselves, and the truth of small maps."""
    from isthmus.core.aggregation.instance import build
    from core.aggregation.brute_force import cheapest

    p, results, wrong = out.parameters, out.results, []
    texts = [text(f.attributes()[cls]) for f in rows]
    classes = sorted({one for one in texts if one is not None})
    distance, width = case["distance"], max(map(len, classes), default=1)
    skipped = [k for k, one in enumerate(texts) if one is None or shapes[k] is None]
    centre = [complex(*one.centroid.coords[0]) * metre if one is not None else 0j for one in shapes]
    spread = [_spread(one) for one in shapes]
    change = boundary = away = 0.0
    for k, region in label.items():
        if region is None or k in skipped:
            continue
        core = core_of[region]
        change += sizes[k] * _distance(distance, texts[k], texts[core], width)
        away += sizes[k] * math.hypot(abs(centre[k] - centre[core]), spread[k] * metre)
    for (a, b), length in pairs.items():
        if a in skipped or b in skipped or label[a] == label[b]:
            continue
        if p["BOUNDARY"] == "regions" or texts[core_of[label[a]]] != texts[core_of[label[b]]]:
            boundary += length * metre
    scale = sum(sizes)
    for name, mine, weight in (
        ("CHANGE_COST", change, p["WEIGHT_CHANGE"]), ("CENTRE_COST", away, p["WEIGHT_CENTRE"]),
        ("BOUNDARY_COST", boundary, p["WEIGHT_BOUNDARY"]),
    ):  # fmt: skip
        if not abs(results[name] - weight * mine) <= 1e-4 * weight * mine + 1e-6 * scale * weight:
            wrong.append(f"{name} is {results[name]}, and should be {weight * mine}")
    total = results["TOTAL_COST"]
    if "LOWER_BOUND" in results and results["LOWER_BOUND"] > total * (1 + 1e-9):
        wrong.append(f"the bound {results['LOWER_BOUND']} is above the cost {total}")
    if not case.get("brute") or len(rows) > 8 or wrong or skipped:
        return wrong
    number = {one: k for k, one in enumerate(classes)}
    theta = [case["thresholds"].get(one, float(p["THRESHOLD"])) for one in classes]
    problem = build(
        sizes, [number[one] for one in texts], centre, list(pairs) or np.zeros((0, 2)),
        [length * metre for length in pairs.values()],
        [[_distance(distance, a, b, width) for b in classes] for a in classes],
        [math.inf if one is None else one for one in theta], change=p["WEIGHT_CHANGE"],
        boundary=p["WEIGHT_BOUNDARY"], centre=p["WEIGHT_CENTRE"], by_class=p["BOUNDARY"] == "classes",
        spread=np.square(spread) * metre**2,
    )  # fmt: skip
    big = None
    if p["METHOD"] == "exact" and p["DECOMPOSE"]:
        big = problem.size >= problem.theta[problem.cls] * (1 - 1e-12)
    best = cheapest(problem, big)
    out.brute = True
    if math.isinf(best):
        if not results["TOO_SMALL_COUNT"]:
            wrong.append("there is no solution, and the tool says it has one")
        return wrong
    if results["TOO_SMALL_COUNT"]:
        return [f"there is a solution (cost {best}), and {results['TOO_SMALL_COUNT']} regions are too small"]
    if p["METHOD"] == "exact" and not total <= best * (1 + 1e-5) + 1e-6 * scale:
        wrong.append(f"exact costs {total}, the brute force finds {best}")
    if big is None and not total >= best * (1 - 1e-5) - 1e-6 * scale:
        wrong.append(f"{p['METHOD']} costs {total}, less than the brute force's {best}")
    return wrong


def _distance(distance, a, b, width):
    """Distance of two classes: ``"equal"``, ``"code"``, or a table with keys ``"a|b"``."""
    if a == b:
        return 0.0
    if distance == "equal":
        return 1.0
    if distance == "code":
        a, b = a.ljust(width), b.ljust(width)
        same = next(k for k in range(width) if a[k] != b[k])
        return 1.0 - same / width
    return distance.get(f"{a}|{b}", distance.get(f"{b}|{a}"))


# ---- focusmap


def check_focus(case, out):
    wrong = messages(case, out)
    if wrong or out.refused or "OUTPUT" not in out.results:
        return wrong + ["no result"] * (not wrong and not out.refused and not out.feedback.isCanceled())
    if written(out, case["outputs"]):
        return ["a layer that was written cannot be read"]
    before, after, results = out.rows["INPUT"], out.layers["OUTPUT"], out.results
    memory = case["output"] == "memory"
    own = len(before[0].attributes()) if before else 0
    if len(before) != len(after):
        return [f"{len(before)} features in, {len(after)} out"]
    olds, news, runs, everywhere = [], [], [], []
    known = shapely.get_coordinates([one for one in map(shape_of, before) if one is not None])
    extent = np.ptp(known, axis=0).max() if len(known) else 0.0
    for a, b in zip(before, after):
        if memory and a.attributes() != b.attributes():
            wrong.append(f"attributes of {a.id()} changed")
        elif a.attributes()[-1] != b.attributes()[-1]:
            wrong.append(f"the last of {own} attributes of {a.id()} changed")
        old, new = points(a.geometry()), points(b.geometry())
        if np.isfinite(old[:, :2]).all():
            everywhere.append(old[:, :2])
        if len(old) != len(new):
            if memory and len(new) < len(old):  # files close rings whose ends differ in Z or M
                wrong.append(f"feature {a.id()} has {len(old)} vertices, and {len(new)} after")
            if case["output"] != "shp":  # others meet its lines, and points were put in there
                wrong += _kept_shape(a, b, extent)
            continue
        if memory and not same(old[:, 2:], new[:, 2:]):
            wrong.append(f"Z or M of {a.id()} changed")
        if not np.isfinite(old[:, :2]).all():
            if memory and not same(old, new):
                wrong.append(f"feature {a.id()} is not finite, and changed")
            continue
        olds.append(old[:, :2])
        news.append(new[:, :2])
        start = 0
        for count, closed in rings_of(a.geometry()):
            runs.append((old[start : start + count, :2], new[start : start + count, :2], closed))
            start += count
        if case["output"] != "shp":  # whose shells all run clockwise
            wrong += _kept_shape(a, b, extent)
    if wrong or not olds or case["output"] == "shp":  # its rings start and turn as they like
        return wrong
    old, new = np.concatenate(olds), np.concatenate(news)
    if not len(old):
        return wrong
    size = np.ptp(old, axis=0).max() or 1.0
    exact = 1e-9 * size + 4e-16 * np.abs(old).max() * 16
    asked, reached = float(out.parameters["SCALE"]), results["SCALE_REACHED"]
    if reached != asked or results["PROBLEM"]:
        wrong.append(f"scale {asked} asked, {reached} reached")
    if out.parameters["FRAME"] and not out.parameters["GROWTH"]:
        frame = np.concatenate(everywhere)
        low, high = frame.min(axis=0) - exact, frame.max(axis=0) + exact
        if (new.min(axis=0) < low).any() or (new.max(axis=0) > high).any():
            wrong.append("something left the frame")
    _, first, again = np.unique(old + 0.0, axis=0, return_index=True, return_inverse=True)
    if not np.array_equal(new, new[first[again.ravel()]]):
        wrong.append("equal points do not stay together")
    if not np.isfinite(new).all():
        wrong.append("coordinates are not finite")
    if asked == 1.0 and case["output"] in ("memory", "gpkg") and not np.array_equal(old, new):
        wrong.append("scale 1 changes the map")
    focus = [shape_of(f) for f in out.rows["FOCUS"]]
    known = [one for one in focus if one is not None]
    if (
        len(known) == len(focus) == 1
        and known[0].is_valid
        and known[0].geom_type == "Polygon"
        and not case["other_crs"]
    ):
        inside = shapely.covers(known[0], shapely.points(old))
        if inside.any():
            expected = new[inside][0] + reached * (old[inside] - old[inside][0])
            if np.abs(new[inside] - expected).max() > 4 * exact * max(1.0, reached):
                wrong.append(
                    f"the focus is not {reached} times as large: {np.abs(new[inside] - expected).max()}"
                )
    wrong += _crossings(runs)
    edges = out.layers["EDGES_USED"]
    if len(edges) != results["EDGE_COUNT"]:
        wrong.append(f"{len(edges)} edges written, {results['EDGE_COUNT']} told")
    for one, many in zip(case["layers"].get("ALONG", []), out.carried):
        if len(many) != len(one["rows"]):
            wrong.append(f"a layer of {len(one['rows'])} features was carried as {len(many)}")
        elif [f.attributes()[-1] for f in many] != [row[1][-1] for row in one["rows"]]:
            wrong.append("attributes of a carried layer changed")
    if len(out.carried) != len(case["layers"].get("ALONG", [])) and not out.feedback.isCanceled():
        wrong.append("a layer was not carried")
    return wrong


def points(geometry):
    found = [(v.x(), v.y(), v.z(), v.m()) for v in geometry.vertices()]
    return np.array(found).reshape(-1, 4)


def same(a, b):
    return a.tobytes() == b.tobytes() or np.array_equal(a, b, equal_nan=True)


def rings_of(geometry):
    """Number of points of each line or ring, and whether it is a ring."""
    found = []
    for part in geometry.constParts() if not geometry.isNull() else ():
        if hasattr(part, "exteriorRing"):
            rings = [part.exteriorRing()] if part.exteriorRing() else []
            rings += [part.interiorRing(k) for k in range(part.numInteriorRings())]
            found += [(ring.numPoints(), True) for ring in rings]
        else:
            found.append((part.nCoordinates(), False))
    return found


def _kept_shape(a, b, size):
    """Valid polygons stay valid, and their rings keep their direction."""
    old, new = shape_of(a), shape_of(b)
    if old is None or not old.geom_type.endswith("Polygon") or not old.is_valid:
        return []
    if new is None or not new.is_valid:
        return [f"feature {a.id()} was valid"]
    for one, other in zip(shapely.get_parts(old), shapely.get_parts(new)):
        for p, q in zip([one.exterior, *one.interiors], [other.exterior, *other.interiors]):
            seen = shapely.Polygon(p).area > 1e-6 * p.length * size  # else too thin for anyone to see
            if seen and p.is_ccw != q.is_ccw:
                return [f"a ring of feature {a.id()} turned around"]
    return []


def _crossings(runs, most=250):
    """Segments that cross, in exact arithmetic, and neither met nor touched before."""
    before, after = [], []
    for old, new, _ in runs:
        before += list(zip(map(tuple, old[:-1].tolist()), map(tuple, old[1:].tolist())))
        after += list(zip(map(tuple, new[:-1].tolist()), map(tuple, new[1:].tolist())))
    if not before or len(before) > most:
        return []
    tree = shapely.STRtree(shapely.linestrings(after))
    found = set()
    for i, j in zip(*tree.query(shapely.linestrings(after), predicate="intersects").tolist()):
        if i < j and _cross(*after[i], *after[j], True) and not _cross(*before[i], *before[j], False):
            found.add((i, j))
    return [f"segments cross that did not: {sorted(found)[:3]}"] * bool(found)


def _cross(a, b, c, d, strictly):
    """Whether segments cross; not strictly, whether they have a point in common."""
    p = [[Fraction(x) for x in one] for one in (a, b, c, d)]

    def side(i, j, k):
        turn = (p[j][0] - p[i][0]) * (p[k][1] - p[i][1]) - (p[j][1] - p[i][1]) * (p[k][0] - p[i][0])
        return (turn > 0) - (turn < 0)

    one, two, three, four = side(0, 1, 2), side(0, 1, 3), side(2, 3, 0), side(2, 3, 1)
    if one * two < 0 and three * four < 0:
        return True
    if strictly:
        return False
    for turn, (i, j), k in ((one, (0, 1), 2), (two, (0, 1), 3), (three, (2, 3), 0), (four, (2, 3), 1)):
        if turn == 0 and all(min(p[i][t], p[j][t]) <= p[k][t] <= max(p[i][t], p[j][t]) for t in (0, 1)):
            return True
    return False


# ---- the example models


def check_aggregation_model(case, out):
    """Areas are cut, aggregated and put together again: none is lost, and they fill what they filled."""
    wrong = messages(case, out)
    if wrong or out.refused or out.feedback.isCanceled():
        return wrong
    if written(out, case["outputs"]):
        return ["a layer that was written cannot be read"]
    regions, given = out.layers["aggregate:regions"], out.layers["aggregate:areas"]
    rows = out.rows["INPUT"]
    names = out.inputs["INPUT"].fields().names()
    key = [f.attributes()[len(names) - 1] for f in rows]
    parts = {}
    for f in given:
        parts.setdefault(f.attributes()[len(names) - 1], []).append(f)
    if set(parts) != set(key):
        return [f"areas in: {sorted(key)}, out: {sorted(parts)}"]
    for f in rows:
        mine = parts[f.attributes()[len(names) - 1]]
        if any(one.attributes()[: len(names)] != f.attributes() for one in mine):
            wrong.append(f"attributes of area {f.id()} changed")
        labels = [one.attributes()[-4] for one in mine]
        if len(set(map(str, labels))) != len(labels) and not mine[0].attributes()[-1]:
            wrong.append(f"area {f.id()} comes twice in one region")
    shapes = [shape_of(f) for f in rows]
    finite = all(one is not None or f.geometry().isEmpty() for one, f in zip(shapes, rows))
    if not finite or not is_tame(shapes):
        return wrong
    whole = shapely.union_all([one for one in shapes if one is not None])
    for name, layer in (("regions", regions), ("areas", given)):
        found = [one for one in map(shape_of, layer) if one is not None]
        if not shapely.is_valid(found).all():
            wrong.append(f"some of the {name} are not valid")
        elif (
            shapely.symmetric_difference(shapely.union_all(found), whole).area > 1e-9 * whole.area
            or abs(sum(one.area for one in found) - whole.area) > 1e-9 * whole.area
        ):
            wrong.append(f"the {name} do not fill what the areas fill")
    return wrong


def check_focus_model(case, out):
    """The cuts of the partition are the relevant edges of the map; no feature is lost."""
    wrong = messages(case, out)
    if wrong or out.refused or out.feedback.isCanceled():
        return wrong
    if written(out, case["outputs"]):
        return ["a layer that was written cannot be read"]
    before, after = out.rows["map"], out.layers["focusmap:Focus map"]
    if [f.attributes()[-1] for f in before] != [f.attributes()[-1] for f in after]:
        return [f"{len(before)} features in, {len(after)} out, or in another order"]
    known = shapely.get_coordinates([one for one in map(shape_of, before) if one is not None])
    extent = np.ptp(known, axis=0).max() if len(known) else 0.0
    for a, b in zip(before, after):
        wrong += _kept_shape(a, b, extent)
    kinds = {f["kind"] for f in out.layers["focusmap:Relevant edges"]}
    return wrong + [f"edges of kind {kinds}"] * (not kinds <= {"given", "join"})

"""Hostile maps, as plain data that a JSON file can hold: tessellations, foci, lines, mutations.

A *geometry* is None or ``{"type", "dims", "parts"}``: parts of runs of points, as in
``{"type": "Polygon", "dims": "Z", "parts": [[shell, hole]]}``; closed rings repeat their first point.
A *layer* is ``{"type", "crs", "fields": [[name, kind]], "rows": [[geometry, [value]]], "store"}``. All
randomness comes from numbers that hypothesis draws, so that a case can be shrunk and repeated.
"""

import copy
import math
import struct
from random import Random

from hostile import NOT_FINITE
import shapely
from hypothesis import strategies as st

KINDS = {
    "Point": 1,
    "LineString": 2,
    "Polygon": 3,
    "MultiPoint": 4,
    "MultiLineString": 5,
    "MultiPolygon": 6,
}
PROJECTED = ("EPSG:25832", "EPSG:3035", "EPSG:2263")  # metres, metres, US feet
ODD_NAMES = (
    "code", "class", "part", "piece", "area_id", "size", "status", "region", "areas", "core", "changed",
    "new_class", "select", "from", "order", "geom", "geometry", "ogc_fid", "rowid", "класс", "土地",
    "área ß", "a b", 'a"b', "a'b", "a.b", "1", "_", "n" * 300,
)  # fmt: skip
ODD_CLASSES = (
    "a",
    "A",
    " a",
    "a,b",
    "'",
    '"',
    "",
    "NULL",
    "nan",
    "0",
    "x" * 200,
    "лес",
    "🌲",
    "311",
    "312",
    "3",
)


def wkb(geometry):
    """The geometry as ISO WKB; nothing is checked, so that it can be as wrong as it likes."""
    dims = geometry["dims"]
    extra = 1000 * ("Z" in dims) + 2000 * ("M" in dims)
    kind = KINDS[geometry["type"]]

    def run(points):
        return struct.pack("<I", len(points)) + b"".join(
            struct.pack(f"<{2 + len(dims)}d", *(list(p) + [0.0, 0.0])[: 2 + len(dims)]) for p in points
        )

    def part(runs, kind):
        head = struct.pack("<BI", 1, kind + extra)
        if kind == 1:
            return head + run(runs[0][:1])[4:]
        if kind == 2:
            return head + run(runs[0])
        return head + struct.pack("<I", len(runs)) + b"".join(run(points) for points in runs)

    parts = geometry["parts"]
    if kind <= 3:
        return part(parts[0], kind)
    return struct.pack("<BII", 1, kind + extra, len(parts)) + b"".join(part(p, kind - 3) for p in parts)


def polygon(*rings):
    return {"type": "Polygon", "dims": "", "parts": [[[list(p) for p in ring] for ring in rings]]}


def of_shape(shape):
    """A geometry from a shapely polygon."""
    return polygon(*(ring.coords for ring in (shape.exterior, *shape.interiors)))


def as_multi(geometry):
    return (
        geometry if geometry["type"].startswith("Multi") else {**geometry, "type": "Multi" + geometry["type"]}
    )


def points_of(geometry):
    """All points, to be changed in place."""
    return [p for part in geometry["parts"] for run in part for p in run] if geometry else []


# ---- tessellations


def cells(rng, kind, nx, ny):
    """The faces of a map as shapely polygons with equal vertices where they meet."""
    if kind == "voronoi":
        seeds = shapely.MultiPoint([(rng.uniform(0, nx), rng.uniform(0, ny)) for _ in range(nx * ny)])
        return [p for p in shapely.voronoi_polygons(seeds).geoms if p.is_valid and p.area > 0]
    shift = 0.0 if kind == "lattice" else 0.45
    at = {
        (i, j): (i + rng.uniform(-shift, shift), j + rng.uniform(-shift, shift)) if shift else (float(i), float(j))
        for i in range(nx + 1) for j in range(ny + 1)
    }  # fmt: skip
    faces = []
    for i in range(nx):
        for j in range(ny):
            a, b, c, d = (at[p] for p in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
            if kind == "triangles" or not shapely.Polygon([a, b, c, d]).is_valid:
                reflex = (
                    shapely.Polygon([a, b, c]).exterior.is_ccw and shapely.Polygon([a, c, d]).exterior.is_ccw
                )
                faces += [[a, b, c], [a, c, d]] if reflex else [[a, b, d], [b, c, d]]
            else:
                faces.append([a, b, c, d])
    return [face for face in map(shapely.Polygon, faces) if face.is_valid and face.area > 0]


def merged(rng, faces, share):
    """Join neighbouring faces at random: areas with bays, holes, and areas in these holes."""
    owner = {}
    for k, face in enumerate(faces):
        ring = list(face.exterior.coords)
        for edge in zip(ring[:-1], ring[1:]):
            owner.setdefault(frozenset(edge), []).append(k)
    label = list(range(len(faces)))
    borders = sorted(tuple(both) for both in owner.values() if len(both) == 2)
    for a, b in borders:
        if rng.random() < share and label[a] != label[b]:
            old, new = label[b], label[a]
            label = [new if one == old else one for one in label]
    result = []
    for one in sorted(set(label)):
        whole = shapely.coverage_union_all([f for f, l in zip(faces, label) if l == one])
        result += [p for p in shapely.get_parts(whole)]
    return result


def tessellation(seed, kind, nx, ny, merge, missing):
    """Areas that fill a map but for missing ones; as geometries."""
    rng = Random(seed)
    faces = [face for face in cells(rng, kind, nx, ny) if rng.random() >= missing]
    return [of_shape(shape) for shape in merged(rng, faces, merge)]


# ---- mutations of geometries


def _some(rng, rows):
    alive = [row for row in rows if row[0] and points_of(row[0])]
    return rng.choice(alive) if alive else None


def _some_ring(rng, rows):
    """A ring of some area; empty if there is none."""
    row = _some(rng, rows)
    return rng.choice(rng.choice(row[0]["parts"])) if row else []


def _move(rng, rows, by):
    """One vertex of one area, everywhere it stands in that area."""
    row = _some(rng, rows)
    if row:
        p = rng.choice(points_of(row[0]))
        old, new = tuple(p[:2]), [p[0] + by(), p[1] + by()]
        for q in points_of(row[0]):
            if tuple(q[:2]) == old:
                q[:2] = new


def duplicate(rng, rows):
    row = _some(rng, rows)
    if row:
        rows.append([copy.deepcopy(row[0]), list(row[1])])


def nudge(rng, rows):
    _move(rng, rows, lambda: rng.choice((1e-15, 1e-12, 1e-9, 1e-6, 1e-3)) * rng.uniform(-1, 1))


def push(rng, rows):
    _move(rng, rows, lambda: rng.uniform(-1.5, 1.5))


def drop_vertex(rng, rows):
    """T-junctions where it was on a straight line, gaps or overlaps where not."""
    ring = _some_ring(rng, rows)
    if len(ring) > 4:
        del ring[rng.randrange(1, len(ring) - 1)]


def straighten(rng, rows):
    """Drop all vertices of an area that lie on a straight line: T-junctions without nodes."""
    row = _some(rng, rows)
    for ring in (run for part in (row[0]["parts"] if row else ()) for run in part):
        for k in range(len(ring) - 2, 0, -1):
            (ax, ay), (bx, by), (cx, cy) = (p[:2] for p in ring[k - 1 : k + 2])
            if len(ring) > 4 and (bx - ax) * (cy - by) == (by - ay) * (cx - bx):
                del ring[k]


def add_vertex(rng, rows):
    """A vertex in the middle of an edge, on one side only."""
    ring = _some_ring(rng, rows)
    if len(ring) > 1:
        k = rng.randrange(1, len(ring))
        ring.insert(k, [(a + b) / 2.0 for a, b in zip(ring[k - 1], ring[k])])


def repeat_vertex(rng, rows):
    ring = _some_ring(rng, rows)
    if ring:
        k = rng.randrange(len(ring))
        ring.insert(k, list(ring[k]))


def turn_ring(rng, rows):
    """Another start and direction."""
    row = _some(rng, rows)
    if row:
        part = rng.choice(row[0]["parts"])
        k = rng.randrange(len(part)) if part else 0
        if part and len(part[k]) > 3:
            ring = part[k][:-1]
            s = rng.randrange(len(ring))
            ring = ring[s:] + ring[:s]
            ring = ring[::-1] if rng.random() < 0.5 else ring
            part[k] = [list(p) for p in ring + ring[:1]]


def not_finite(rng, rows):
    row = _some(rng, rows)
    if row:
        rng.choice(points_of(row[0]))[rng.randrange(2)] = float(rng.choice(NOT_FINITE))


def far_away(rng, rows):
    row = _some(rng, rows)
    if row:
        by = rng.choice((1e6, 1e9, 1e13, 1e40, 1e155, 1e300))
        for p in points_of(row[0]):
            p[0] += by
            p[1] = p[1] * max(by / 1e9, 1.0)


def no_geometry(rng, rows):
    row = _some(rng, rows)
    if row:
        row[0] = None


def empty(rng, rows):
    row = _some(rng, rows)
    if row:
        row[0] = {
            **row[0],
            "parts": rng.choice(([[]], [[[]]])) if row[0]["type"] == "Polygon" else row[0]["parts"],
        }


def flat(rng, rows):
    """No area: two points, or one."""
    row = _some(rng, rows)
    if row and row[0]["type"].endswith("Polygon"):
        a, b = (rng.choice(points_of(row[0])) for _ in range(2))
        row[0]["parts"] = [[[list(a), list(b), list(a)] if rng.random() < 0.5 else [list(a)] * 4]]


def swap_vertices(rng, rows):
    """Most often a ring that crosses itself."""
    ring = _some_ring(rng, rows)
    if len(ring) > 4:
        a, b = rng.sample(range(1, len(ring) - 1), 2)
        ring[a], ring[b] = ring[b], ring[a]


def spike(rng, rows):
    ring = _some_ring(rng, rows)
    if len(ring) > 2:
        k = rng.randrange(1, len(ring))
        out = [c + rng.uniform(-2, 2) for c in ring[k][:2]] + ring[k][2:]
        ring[k:k] = [list(ring[k]), out]


def sliver(rng, rows):
    """A thin triangle on top of an edge."""
    row = _some(rng, rows)
    if row and len(points_of(row[0])) > 1 and row[0]["type"].endswith("Polygon"):
        a, b = points_of(row[0])[:2]
        thin = rng.choice((1e-14, 1e-9, 1e-4))
        c = [(a[0] + b[0]) / 2 + thin, (a[1] + b[1]) / 2 + thin]
        rows.append([polygon([a[:2], b[:2], c, a[:2]]), list(row[1])])


def join(rng, rows):
    """Two areas become one of several parts."""
    first, second = _some(rng, rows), _some(rng, rows)
    if first and second and first is not second:
        first[0] = as_multi({**first[0], "parts": first[0]["parts"] + second[0]["parts"]})
        rows[:] = [row for row in rows if row is not second]


def strange_hole(rng, rows):
    """A hole that touches, crosses or leaves the shell, or repeats it."""
    row = _some(rng, rows)
    if row and row[0]["type"].endswith("Polygon") and row[0]["parts"][0]:
        shell = row[0]["parts"][0][0]
        hole = [list(p) for p in rng.sample(shell, min(3, len(shell)))]
        hole = [list(p) for p in shell] if rng.random() < 0.3 else hole + hole[:1]
        row[0]["parts"][0].append(hole)


def heights(rng, rows):
    for row in rows:
        if row[0] and rng.random() < 0.8:
            dims = rng.choice(("Z", "M", "ZM"))
            row[0]["dims"] = dims
            for p in points_of(row[0]):
                p[2:] = [rng.choice((0.0, -1e9, rng.random(), math.nan)) for _ in dims]


def even_heights(rng, rows):
    """A Z of every vertex that follows from its place: nothing that should keep it may lose it."""
    for row in rows:
        if row[0]:
            row[0]["dims"] = "Z"
            for p in points_of(row[0]):
                p[2:] = [p[0] + 3.0 * p[1]]


def stretch(rng, rows):
    """The whole map elsewhere, or of another size."""
    size, x, y = rng.choice((
        (1e-9, 0, 0), (1e-3, 0, 0), (1e3, 5e5, 5e6), (1.0, 5e5, 5e6), (0.01, 5e5, 5e6), (1e7, 0, 0), (1e12, -1e13, 0),
        (1e60, 0, 0),
    ))  # fmt: skip
    for row in rows:
        for p in points_of(row[0]):
            p[:2] = p[0] * size + x, p[1] * size + y


def shuffle(rng, rows):
    rng.shuffle(rows)


# those that leave a map without overlaps and invalid areas
GENTLE = (straighten, turn_ring, even_heights, join, no_geometry, shuffle)
HOSTILE = (
    duplicate, nudge, push, drop_vertex, add_vertex, repeat_vertex, not_finite, far_away, empty, flat, swap_vertices,
    spike, sliver, strange_hole, heights, stretch,
)  # fmt: skip
MUTATIONS = {one.__name__: one for one in GENTLE + HOSTILE}


def mutate(rows, mutations):
    """Apply (name, seed) pairs in place."""
    for name, seed in mutations:
        MUTATIONS[name](Random(seed), rows)
    return rows


# ---- strategies

seeds = st.integers(0, 2**31)
gentle = st.lists(st.tuples(st.sampled_from([m.__name__ for m in GENTLE]), seeds), max_size=3)
hostile = st.lists(st.tuples(st.sampled_from(sorted(MUTATIONS)), seeds), max_size=5)
stores = st.sampled_from(("memory", "memory", "memory", "gpkg", "shp", "geojson"))


def layer(rows, fields, crs, store="memory"):
    """A layer of a type that all of its rows fit in; what lacks Z or M is left as it is."""
    types = [row[0]["type"] for row in rows if row[0]] or ["Polygon"]
    dims = {one for row in rows if row[0] for one in row[0]["dims"]}
    kind = next((one for one in types if one.startswith("Multi")), types[0])
    kind += "Z" * ("Z" in dims) + "M" * ("M" in dims)
    return {"type": kind, "crs": crs, "fields": fields, "rows": rows, "store": store}


@st.composite
def area_layers(draw, largest=5, clean=None):
    """A layer of areas: ``(layer, class field, classes on it)``."""
    clean = draw(st.booleans()) if clean is None else clean
    rows = [[one, []] for one in tessellation(
        draw(seeds), draw(st.sampled_from(("lattice", "quads", "triangles", "voronoi"))),
        draw(st.integers(1, largest)), draw(st.integers(1, largest)),
        draw(st.sampled_from((0.0, 0.2, 0.5))), draw(st.sampled_from((0.0, 0.0, 0.15, 0.4))),
    )]  # fmt: skip
    mutate(rows, draw(gentle if clean else hostile))
    kind = draw(st.sampled_from(("string", "string", "integer", "double")))
    name = draw(st.sampled_from(("code",) * 20 + ODD_NAMES))
    rng = Random(draw(seeds))
    classes = [draw(st.sampled_from(("a", "b", "c"))), "b", "c", "d"] if clean else rng.sample(ODD_CLASSES, 4)
    classes = (
        classes if kind == "string" else [1, 2, 30, 311] if kind == "integer" else [1.0, 2.5, -3.0, 1e12]
    )
    classes = classes[: draw(st.integers(1, 4))]
    no_class = 0.0 if clean else draw(st.sampled_from((0.0, 0.2)))
    for key, row in enumerate(rows):
        row[1] = [None if rng.random() < no_class else rng.choice(classes), key]
    crs = draw(st.sampled_from(PROJECTED + ("", "EPSG:4326")))
    fields = [[name, kind], ["key", "integer"]]
    return layer(rows, fields, crs, draw(stores)), name, sorted({str(row[1][0]) for row in rows})

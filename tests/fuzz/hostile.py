"""Hostile polygons: shapes that are hard, and what goes wrong with shapes.

A polygon is a list of rings, a ring an (n, 2) array without its closing row; a geometry is a list of
polygons. Everything comes from a numpy generator, so a number names a geometry.
"""

import struct
import sys
from pathlib import Path

import numpy as np
import shapely

sys.path.append(str(Path(__file__).resolve().parents[1] / "core"))

import shapes  # noqa: E402

try:
    from qgis.core import Qgis

    # QGIS 3.34 itself throws at a memory layer with an infinite coordinate
    INFINITE = Qgis.QGIS_VERSION_INT // 100 != 334
except ImportError:
    INFINITE = True
NOT_FINITE = [np.nan, np.inf, -np.inf] if INFINITE else [np.nan]

# ---------------------------------------------------------------- kinds of polygons


def _seed(rng):
    return int(rng.integers(2**31))


def small_tour(rng):
    """Few enough vertices for a brute force."""
    return [shapes.tour(_seed(rng), int(rng.integers(4, 12))).rings]


def tour(rng):
    return [shapes.tour(_seed(rng), int(rng.integers(12, 32))).rings]


def lattice_tour(rng):
    """Collinear and cocircular points, and now and then an edge through a vertex."""
    while True:
        try:
            return [shapes.tour(_seed(rng), int(rng.integers(4, 14)), int(rng.integers(6, 20))).rings]
        except AssertionError:  # two points at one place
            continue


def random_ring(rng):
    """Crosses itself, nearly always."""
    n, size = int(rng.integers(1, 16)), int(rng.integers(2, 12))
    return [[rng.integers(0, size, (n, 2)).astype(float)]]


def mosaic(rng):
    return [shapes.mosaic(_seed(rng), int(rng.integers(8, 40)), 0.6, holes=rng.random() < 0.6).rings]


def lattice_mosaic(rng):
    """Holes that touch the shell and each other, at vertices."""
    size = int(rng.integers(4, 8))
    return [shapes.mosaic(_seed(rng), int(rng.integers(12, 40)), 0.65, size, True).rings]


def polyomino(rng):
    """Holes that touch the middle of an edge."""
    width, height = rng.integers(2, 7, 2).tolist()
    return [shapes.polyomino(_seed(rng), width, height, 0.7, float(rng.random())).rings]


def star(rng):
    n = int(rng.integers(3, 40))
    angle = np.sort(rng.random(n)) * 2 * np.pi
    radius = 10.0 ** rng.uniform(rng.choice([-0.3, -2.0, -6.0]), 0.0, n)
    return [[np.column_stack((np.cos(angle), np.sin(angle))) * radius[:, None] * 100.0]]


def comb(rng):
    return [shapes.comb(int(rng.integers(1, 10))).rings]


def spiral(rng):
    return [shapes.spiral(int(rng.integers(1, 4)), int(rng.integers(5, 14))).rings]


def corridor(rng):
    """A random walk with a width."""
    path = np.cumsum(rng.integers(-4, 5, (int(rng.integers(2, 12)), 2)), axis=0).astype(float)
    area = shapely.buffer(
        shapely.linestrings(path) if len(np.unique(path, axis=0)) > 1 else shapely.points(path[0]),
        float(10.0 ** rng.uniform(-3, 0)),
        quad_segs=1,
        cap_style="square",
    )
    return _polygons(area)


def koch(rng):
    return [shapes.koch(int(rng.integers(0, 3))).rings]


def sliver(rng):
    n = int(rng.integers(3, 12))
    xy = np.column_stack((np.sort(rng.random(n)), rng.random(n) * 10.0 ** rng.uniform(-14, -2)))
    return [[np.concatenate((xy, xy[::-1] - [0.0, 1e-3 * 10.0 ** rng.uniform(-12, 0)]))]]


def teeth(rng):
    """Long walls beside short cuts: sums of lengths cancel."""
    n, height = int(rng.integers(3, 20)), 10.0 ** rng.integers(0, 9)
    up = [(k, height * (k % 2)) for k in range(n)]
    return [[np.array(up + [(n, -1), (-1, -1)], dtype=float)]]


def circle(rng):
    return [[shapes.circle(int(rng.integers(3, 32)), 10.0)]]


def holes(rng):
    return [shapes.lattice_of_holes(int(rng.integers(1, 4))).rings]


def touching_holes(rng):
    """Trees of holes that touch; in some there is a circle, which makes the polygon invalid."""
    width, height = rng.integers(2, 6, 2).tolist()
    circles = int(rng.random() < 0.2)
    share = float(rng.choice([0.5, 0.7])) if not circles else 1.0
    return [shapes.touching_holes(_seed(rng), width, height, share, circles).rings]


def islands(rng):
    """Islands in the holes of islands, each in touch with what is around it at a vertex."""
    result = touching_holes(rng)
    waiting = [(ring, 0) for ring in result[0][1:]]
    while waiting:
        ring, depth = waiting.pop()
        if rng.random() < 0.6 and depth < 4:
            inner = _within_a_ring(ring, rng)
            if depth % 2 == 0:
                result.append([inner])
            else:
                result[-1].append(inner)
            waiting.append((inner, depth + 1))
    return result


def _within_a_ring(ring, rng):
    """A triangle in a convex ring that touches it at a vertex."""
    k, centre = int(rng.integers(len(ring))), ring.mean(axis=0)
    beside = ring[[k - 1, (k + 1) % len(ring)]]
    return np.concatenate((ring[k : k + 1], centre + (beside - centre) / 4))


def nested(rng):
    """Rings in rings in rings: holes in holes, equal rings, holes outside."""
    count = int(rng.integers(2, 5))
    rings = []
    for _ in range(count):
        x, y = rng.integers(0, 8, 2)
        w, h = rng.integers(1, 9, 2)
        rings.append(np.array(shapes.box(x, y, x + w, y + h), dtype=float))
    if rng.random() < 0.5:
        rings.sort(key=lambda r: -np.ptp(r[:, 0]) * np.ptp(r[:, 1]))
    return [rings]


HAND = [
    shapes.SQUARE,
    shapes.TRIANGLE,
    shapes.DUMBBELL,
    shapes.ANNULUS,
    shapes.TWO_HOLES,
    *shapes.TOUCHING.values(),
]


def by_hand(rng):
    return [HAND[int(rng.integers(len(HAND)))].rings]


def triangle_or_square(rng):
    n = int(rng.integers(3, 5))
    return [[rng.integers(0, 100, (n, 2)).astype(float)]]


def many(rng):
    """Several polygons in one geometry: apart, touching, overlapping or the same."""
    result = []
    for k in range(int(rng.integers(2, 5))):
        kind = SINGLE[int(rng.integers(len(SINGLE)))]
        polygon = kind(rng)[0]
        if rng.random() < 0.3 and result:
            polygon = result[-1]
        shift = rng.choice([0.0, 10.0, 22.0, 1e4]) * k
        result.append([ring + [shift, 0.0] for ring in polygon])
    return result


def nothing(rng):
    """Empty in some way."""
    return [[], [[]], [[np.empty((0, 2))]], [[np.empty((0, 2)), np.empty((0, 2))]]][int(rng.integers(4))]


SINGLE = [
    small_tour, tour, lattice_tour, random_ring, mosaic, lattice_mosaic, polyomino, star, comb, spiral,
    corridor, koch, sliver, teeth, circle, holes, touching_holes, nested, by_hand, triangle_or_square,
]  # fmt: skip
KINDS = {kind.__name__: kind for kind in [*SINGLE, many, islands, nothing]}


def _polygons(area):
    return [shapes.from_shapely(p).rings for p in shapely.get_parts(area)]


# ---------------------------------------------------------------- mutations


def _pick(polygons, rng):
    """A ring with vertices, as polygon and place; None if there is none."""
    places = [(p, k) for p in polygons for k, ring in enumerate(p) if len(ring)]
    return places[int(rng.integers(len(places)))] if places else None


def _on_a_ring(change):
    def mutate(polygons, rng):
        place = _pick(polygons, rng)
        if place:
            polygon, k = place
            polygon[k] = change(polygon[k], int(rng.integers(len(polygon[k]))), rng)
        return polygons

    mutate.__name__ = change.__name__
    return mutate


@_on_a_ring
def dropped(ring, i, rng):
    return np.delete(ring, i, axis=0)


@_on_a_ring
def doubled(ring, i, rng):
    return np.insert(ring, i, ring[i], axis=0)


@_on_a_ring
def moved_by_an_ulp(ring, i, rng):
    ring = ring.copy()
    side = int(rng.integers(2))
    ring[i, side] = np.nextafter(ring[i, side], rng.choice([-np.inf, np.inf]))
    return ring


@_on_a_ring
def near_duplicate(ring, i, rng):
    size = max(np.ptp(ring, axis=0).max(), 1e-300)
    return np.insert(ring, i, ring[i] + rng.normal(size=2) * size * 10.0 ** rng.uniform(-16, -6), axis=0)


@_on_a_ring
def swapped(ring, i, rng):
    ring, j = ring.copy(), int(rng.integers(len(ring)))
    ring[[i, j]] = ring[[j, i]]
    return ring


@_on_a_ring
def turned_round(ring, i, rng):
    return ring[::-1]


@_on_a_ring
def restarted(ring, i, rng):
    return np.roll(ring, i, axis=0)


@_on_a_ring
def walked_twice(ring, i, rng):
    return np.concatenate((ring, ring))


@_on_a_ring
def closed_twice(ring, i, rng):
    return np.concatenate((ring, ring[:1]))


@_on_a_ring
def spike(ring, i, rng):
    tip = ring[i] + rng.normal(size=2) * max(np.ptp(ring, axis=0).max(), 1e-300)
    return np.insert(ring, i, [ring[i], tip], axis=0)


@_on_a_ring
def vertex_on_edge(ring, i, rng):
    """The middle of an edge, as far as doubles know."""
    return np.insert(ring, i, ring[i] * 0.5 + ring[i - 1] * 0.5, axis=0)


@_on_a_ring
def touches_itself(ring, i, rng):
    return np.insert(ring, i, ring[int(rng.integers(len(ring)))], axis=0)


@_on_a_ring
def minus_zero(ring, i, rng):
    ring = ring.copy()
    ring[ring == 0.0] = -0.0
    ring[i] = rng.choice([0.0, -0.0], 2)
    return ring


@_on_a_ring
def not_finite(ring, i, rng):
    ring = ring.copy()
    ring[i, int(rng.integers(2))] = rng.choice(NOT_FINITE)
    return ring


def ring_repeated(polygons, rng):
    place = _pick(polygons, rng)
    if place:
        polygon, k = place
        polygon.append(polygon[k])
    return polygons


def ring_lost(polygons, rng):
    place = _pick(polygons, rng)
    if place:
        del place[0][place[1]]
    return polygons


def ring_empty(polygons, rng):
    place = _pick(polygons, rng)
    if place:
        place[0].append(np.empty((0, 2)))
    return polygons


MUTATIONS = {
    mutation.__name__: mutation
    for mutation in [
        dropped, doubled, moved_by_an_ulp, near_duplicate, swapped, turned_round, restarted,
        walked_twice, closed_twice, spike, vertex_on_edge, touches_itself, minus_zero, not_finite,
        ring_repeated, ring_lost, ring_empty,
    ]
}  # fmt: skip


# ---------------------------------------------------------------- places and sizes


def _fit(polygons, low, high):
    """Into a rectangle."""
    points = [ring for p in polygons for ring in p if len(ring)]
    if not points:
        return polygons
    xy = np.concatenate(points)
    xy = xy[np.isfinite(xy).all(axis=1)]
    if len(xy) == 0:
        return polygons
    start = xy.min(axis=0)
    size = np.maximum(xy.max(axis=0) - start, 1e-300)
    low, high = np.array(low), np.array(high)
    return _each(polygons, lambda ring: low + (ring - start) / size * (high - low))


def _each(polygons, change):
    with np.errstate(all="ignore"):
        return [[change(ring) if len(ring) else ring for ring in p] for p in polygons]


def _scaled(low, high):
    """By a random power of ten."""

    def change(polygons, rng):
        factor = 10.0 ** rng.uniform(low, high)
        return _each(polygons, lambda ring: ring * factor)

    return change


def turned(polygons, rng):
    a = rng.uniform(0, 2 * np.pi)
    turn = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
    return _each(polygons, lambda ring: ring @ turn)


def fine_and_far_away(polygons, rng):
    size = 1e-6 * 2.0 ** rng.integers(1, 24)
    return _each(_fit(polygons, (0, 0), (size, size)), lambda ring: ring + 1e9)


def flat(polygons, rng):
    factor = 10.0 ** -rng.uniform(3, 17)
    return _each(polygons, lambda ring: ring * [1.0, factor])


def in_degrees(polygons, rng):
    return _fit(polygons, *np.sort(rng.uniform([-180, -85], [180, 85], (2, 2)), axis=0))


def _within(low, high):
    return lambda polygons, rng: _fit(polygons, low, high)


PLACES = {
    "as it is": lambda polygons, rng: polygons,
    "turned": turned,
    "large": _scaled(6, 16),
    "huge": _scaled(30, 301),
    "tiny": _scaled(-301, -6),
    "fine and far away": fine_and_far_away,
    "far away": lambda polygons, rng: _each(polygons, lambda ring: ring + [5e5, 6e6]),
    "flat": flat,
    "in degrees": in_degrees,
    "a street in degrees": _within((13.4, 52.5), (13.401, 52.5005)),
    "across the antimeridian": _within((170, -20), (190, 10)),
    "the whole earth": _within((-180, -90), (180, 90)),
    "to the pole": _within((-30, 60), (60, 90)),
    "beyond the pole": _within((-30, 60), (60, 100)),
}

# ---------------------------------------------------------------- well-known binary

ORDINATES = ["", "Z", "M", "ZM"]


def write_wkb(polygons, ordinates="", multi=False, rng=None, odd_closing=False):
    """WKB of a geometry; Z and M are random, some NaN."""
    rng = rng or np.random.default_rng(0)
    extra = 1000 * ("Z" in ordinates) + 2000 * ("M" in ordinates)
    chunks = []
    for polygon in polygons:
        chunks.append(struct.pack("<BII", 1, 3 + extra, len(polygon)))
        for ring in polygon:
            more = rng.normal(size=(len(ring), len(ordinates)))
            more[rng.random(len(ring)) < 0.1] = np.nan
            rows = np.column_stack((np.asarray(ring, dtype="<f8").reshape(-1, 2), more))
            if len(rows):
                rows = np.concatenate((rows, rows[:1]))
                if odd_closing and len(ordinates):
                    rows[-1, 2:] = 77.0
            chunks += [struct.pack("<I", len(rows)), rows.astype("<f8").tobytes()]
    if multi or len(polygons) != 1:
        chunks.insert(0, struct.pack("<BII", 1, 6 + extra, len(polygons)))
    return b"".join(chunks)


def geometry(kind, seed, place="as it is", mutations=(), ordinates="", multi=False):
    """The WKB of a hostile geometry by its recipe."""
    rng = np.random.default_rng([seed, len(kind)])
    polygons = [[np.array(ring, dtype=float) for ring in p] for p in KINDS[kind](rng)]
    early = [m for m in mutations if m != "not_finite"]
    for name in early:
        polygons = MUTATIONS[name](polygons, rng)
    polygons = PLACES[place](polygons, rng)
    if len(early) < len(mutations):
        polygons = not_finite(polygons, rng)
    return write_wkb(polygons, ordinates, multi, rng, odd_closing=seed % 7 == 0)


def read_wkb(data):
    """Read a (multi)polygon: a list of polygons, each a list of rings, each (n, d) with its closing row.

    Independent of the tools' own reader.
    """
    data = memoryview(data)

    def polygon(at):
        order, kind, count = struct.unpack_from("<BII", data, at)
        assert order == 1 and kind % 1000 == 3, kind
        size = 2 + (kind // 1000 in (1, 3)) + (kind // 1000 in (2, 3))
        at, rings = at + 9, []
        for _ in range(count):
            (n,) = struct.unpack_from("<I", data, at)
            rings.append(np.frombuffer(data, "<f8", n * size, at + 4).reshape(n, size))
            at += 4 + 8 * n * size
        return rings, at

    _, kind, count = struct.unpack_from("<BII", data, 0)
    if kind % 1000 == 3:
        return [polygon(0)[0]]
    result, at = [], 9
    for _ in range(count):
        rings, at = polygon(at)
        result.append(rings)
    return result

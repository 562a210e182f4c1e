"""Polygons to test with. Coordinates are integers wherever an exact answer is wanted."""

import functools
import importlib.util
import os
import random
from typing import NamedTuple

import numpy as np
import pytest
import shapely


# not every machine has a wheel of each; ISTHMUS_ENGINE (`./run test --engine`) leaves only one
def _has(engine):
    if os.environ.get("ISTHMUS_ENGINE", engine) != engine:
        return False
    if engine == "shapely":
        return hasattr(shapely, "constrained_delaunay_triangles")
    return importlib.util.find_spec(engine) is not None


NAMES = ("triangle", "pythoncdt", "shapely")
INSTALLED = [name for name in NAMES if _has(name)]
needs = {
    name: pytest.mark.skipif(name not in INSTALLED, reason=f"the engine {name} is not here") for name in NAMES
}
ENGINES = [pytest.param(name, marks=needs[name]) for name in NAMES]


class Shape(NamedTuple):
    """A polygon as the core takes it: rows of coordinates and ring offsets."""

    coords: np.ndarray
    offsets: np.ndarray

    @property
    def rings(self):
        return [self.coords[lo:hi] for lo, hi in zip(self.offsets[:-1], self.offsets[1:])]

    @property
    def polygon(self):
        rings = [ring[:, :2] for ring in self.rings]
        return shapely.Polygon(rings[0], rings[1:])

    def mapped(self, function):
        return self._replace(coords=function(self.coords))


def shape(*rings):
    """A shape of rings, each a sequence of points, the shell first."""
    rings = [np.array(ring, dtype=float) for ring in rings]
    return Shape(np.concatenate(rings), np.cumsum([0] + [len(ring) for ring in rings]))


def from_shapely(polygon):
    """A shape of a shapely polygon, without the closing vertices."""
    return shape(*(shapely.get_coordinates(ring)[:-1] for ring in shapely.get_rings(polygon)))


def box(x0, y0, x1, y1):
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def circle(n, radius=1.0, centre=(0.0, 0.0)):
    angle = np.arange(n) * (2 * np.pi / n)
    return np.column_stack((np.cos(angle), np.sin(angle))) * radius + centre


# ---------------------------------------------------------------- random polygons


def drawn(function):
    """Draw each random polygon once: tests with other options share it, and none may change it."""

    @functools.wraps(function)
    @functools.lru_cache(maxsize=None)
    def once(*arguments, **options):
        found = function(*arguments, **options)
        for array in found:
            array.flags.writeable = False
        return found

    return once


@drawn
def tour(seed, n, size=10**6):
    """A simple polygon through n random points: a tour freed of crossings by 2-opt moves."""
    rng = np.random.default_rng([1, seed, n])
    points = rng.integers(0, size, (n, 2))
    assert len(np.unique(points, axis=0)) == n
    ring = points.tolist()
    moved = True
    while moved:
        moved = False
        for a in range(n - 1):
            for b in range(a + 2, n - (a == 0)):
                if _cross(ring[a], ring[a + 1], ring[b], ring[(b + 1) % n]):
                    ring[a + 1 : b + 1] = ring[a + 1 : b + 1][::-1]
                    moved = True
    return shape(ring)


@drawn
def mosaic(seed, points, share=0.6, size=10**6, holes=True):
    """Random triangles of a Delaunay triangulation, united; touching holes come naturally.

    With a small ``size`` the points fill a lattice, and many are collinear or cocircular.
    """
    rng = np.random.default_rng([2, seed, points, size])
    while True:
        sites = np.unique(rng.integers(0, size, (points, 2)), axis=0).astype(float)
        triangles = shapely.get_parts(shapely.delaunay_triangles(shapely.multipoints(sites)))
        chosen = triangles[rng.random(len(triangles)) < share]
        if len(chosen) == 0:
            continue
        area = shapely.union_all(chosen)
        polygon = max(shapely.get_parts(area), key=lambda part: part.area)
        rings = shapely.get_num_interior_rings(polygon)
        if shapely.is_valid(polygon) and polygon.area > 0 and (rings > 0) == holes:
            return from_shapely(polygon)


@drawn
def polyomino(seed, width, height, share=0.65, keep=1.0):
    """Unit cells united; the corners where it runs straight on are kept with a probability.

    Where they are not kept, a hole may touch the middle of an edge.
    """
    rng = np.random.default_rng([3, seed, width, height])
    chosen = rng.random((width, height)) < share
    chosen[0, 0] = True
    cells = np.argwhere(chosen).astype(float)
    area = shapely.union_all([shapely.box(x, y, x + 1, y + 1) for x, y in cells])
    polygon = max(shapely.get_parts(area), key=lambda part: part.area)
    rings = []
    for ring in from_shapely(shapely.segmentize(shapely.simplify(polygon, 0), 1.0)).rings:
        ring = np.rint(ring)
        turn = ring + ring - np.roll(ring, 1, axis=0) - np.roll(ring, -1, axis=0)
        corner = turn.any(axis=1) | (rng.random(len(ring)) < keep)
        rings.append(ring[corner])
    return shape(*rings)


def random_diagonals(ring, seed, share=1.0):
    """Random non-crossing diagonals of a ring of integer points; a triangulation if share is 1.

    Pairs of indices u < v. Exact, and independent of the solver.
    """
    rng = random.Random(seed)
    ring = [tuple(map(int, point)) for point in ring]
    n = len(ring)
    pairs = [(u, v) for u in range(n) for v in range(u + 2, n) if (u, v) != (0, n - 1)]
    rng.shuffle(pairs)
    accepted = []
    for u, v in pairs:
        if all(not _between(ring[w], ring[u], ring[v]) for w in range(n)) and _inside(ring, u, v):
            if not any(_cross(ring[u], ring[v], ring[a], ring[b]) for a, b in accepted):
                accepted.append((u, v))
    return sorted(rng.sample(accepted, round(share * len(accepted))))


def _turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _between(p, a, b):
    """Whether p lies inside the segment a-b."""
    return _turn(a, b, p) == 0 and (p[0] - a[0]) * (p[0] - b[0]) + (p[1] - a[1]) * (p[1] - b[1]) < 0


def _cross(a, b, c, d):
    """Whether the insides of two segments meet, other than along a line."""
    return _turn(a, b, c) * _turn(a, b, d) < 0 and _turn(c, d, a) * _turn(c, d, b) < 0


def _inside(ring, u, v):
    """Whether a segment that touches no other vertex lies inside the polygon."""
    n = len(ring)
    a, b = ring[u], ring[v]
    if any(_cross(a, b, ring[w], ring[(w + 1) % n]) for w in range(n)):
        return False
    x, y = a[0] + b[0], a[1] + b[1]  # the midpoint, twice as large
    odd = False
    for (px, py), (qx, qy) in zip(ring, ring[1:] + ring[:1]):
        if (2 * py > y) != (2 * qy > y):
            side = _turn((2 * px, 2 * py), (2 * qx, 2 * qy), (x, y))
            if side == 0:
                return False
            odd ^= (side > 0) == (qy > py)
    return odd


# ---------------------------------------------------------------- made by hand

SQUARE = shape(box(0, 0, 10, 10))
TRIANGLE = shape([(0, 0), (4, 0), (0, 3)])
DUMBBELL = shape(
    [
        (0, 0),
        (10, 0),
        (10, 4),
        (12, 4),
        (12, 0),
        (22, 0),
        (22, 10),
        (12, 10),
        (12, 6),
        (10, 6),
        (10, 10),
        (0, 10),
    ]
)
# the ring of one with a longer bar
HALLS = [(0, 0), (10, 0), (10, 4), (14, 4), (14, 0), (24, 0)]
HALLS += [(24, 10), (14, 10), (14, 6), (10, 6), (10, 10), (0, 10)]
ANNULUS = shape(box(0, 0, 10, 10), box(4, 4, 6, 6)[::-1])
TWO_HOLES = shape(box(0, 0, 20, 10), box(4, 4, 6, 6)[::-1], box(14, 4, 16, 6)[::-1])
TOUCH_AT_VERTEX = shape([(0, 0), (10, 0), (10, 10), (0, 10), (0, 5)], [(0, 5), (4, 7), (4, 3)])
TOUCH_IN_EDGE = shape(box(0, 0, 10, 10), [(0, 5), (4, 7), (4, 3)])
HOLES_TOUCH = shape(box(0, 0, 20, 10), [(4, 5), (10, 5), (7, 8)], [(10, 5), (16, 5), (13, 2)])
HOLES_TOUCH_IN_EDGE = shape(
    box(0, 0, 20, 10), [(4, 4), (4, 6), (10, 6), (10, 4)], [(10, 5), (15, 7), (15, 3)]
)
CHAIN_OF_HOLES = shape(
    box(0, 0, 30, 10),
    [(2, 5), (5, 8), (8, 5), (5, 2)],
    [(8, 5), (11, 8), (14, 5), (11, 2)],
    [(14, 5), (17, 8), (20, 5), (17, 2)],
)
# a hole between two others and the shell's edge: one vertex on three rings
THREE_AT_A_POINT = shape(
    box(0, 0, 20, 20),
    [(10, 10), (14, 18), (6, 18)],
    [(10, 10), (2, 6), (8, 2)],
    [(10, 10), (12, 2), (18, 6)],
)
# T leaves the vertex that the last ring shares with the shell
NOTCH_TOUCHES_LAST_HOLE = shape(
    [(0, 0), (20, 0), (20, 10), (9, 10), (8, 5), (7, 10), (0, 10)],
    box(4, 4, 6, 6)[::-1],
    [(8, 5), (12, 7), (12, 3)],
)
# GEOS 3.13 cannot triangulate this one ("Unable to find a convex corner"), only its mirror image
GEOS_FAILS = shape(
    [
        (22994, 497773),
        (38657, 815492),
        (87752, 837944),
        (602962, 994531),
        (426885, 644429),
        (740464, 611855),
        (893939, 341194),
        (537209, 80248),
        (35448, 150325),
        (149447, 455787),
    ],
    [(309752, 408668), (362540, 257977), (740464, 611855)],
    [(376772, 625544), (284131, 716399), (99275, 821794), (271529, 641985), (309752, 408668)],
    [(312297, 292680), (211332, 272765), (362540, 257977)],
)

TOUCHING = {
    "touch at vertex": TOUCH_AT_VERTEX,
    "touch in edge": TOUCH_IN_EDGE,
    "holes touch": HOLES_TOUCH,
    "holes touch in edge": HOLES_TOUCH_IN_EDGE,
    "chain of holes": CHAIN_OF_HOLES,
    "three at a point": THREE_AT_A_POINT,
    "notch touches last hole": NOTCH_TOUCHES_LAST_HOLE,
    "geos fails": GEOS_FAILS,
}


def touching_holes(seed, width, height, share=1.0, circles=0):
    """A lattice of holes that touch each other and the shell, at vertices and in edges, in random trees.

    ``share`` of what can touch does, but no circle closes: such a polygon is valid. Each of ``circles``
    closes one that walls in a piece of the interior: such a polygon is not.
    """
    rng = np.random.default_rng([4, seed, width, height])
    ahead = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    count = width * height  # also the number of the shell
    sites = [(i, j) for i in range(width) for j in range(height)]
    inside = lambda x, y: 0 <= x < width and 0 <= y < height  # noqa: E731
    pairs = []
    for a, (i, j) in enumerate(sites):
        for d, (x, y) in enumerate(ahead.tolist()):
            if not inside(i + x, j + y):
                pairs.append((a, count, d))
            elif d < 2:
                pairs.append((a, a + x * height + y, d))
    tree, ends, closing = list(range(count + 1)), {}, []

    def root(a):
        while tree[a] != a:
            tree[a] = a = tree[tree[a]]
        return a

    def touch(a, b, d):
        """Tip to tip, or the tip of one in an edge of the other."""
        kind = int(rng.integers(3))
        ends[a, d] = "edge" if kind == 1 and b < count else "tip"
        if b < count:
            ends[b, d + 2] = "edge" if kind == 2 else "tip"

    for k in rng.permutation(len(pairs)).tolist():
        a, b, d = pairs[k]
        if root(a) == root(b):
            closing.append(pairs[k])
        elif rng.random() < share:
            tree[root(a)] = root(b)
            touch(a, b, d)
    assert len(closing) >= circles
    for a, b, d in closing[:circles]:
        touch(a, b, d)
    holes = []
    for a, (i, j) in enumerate(sites):
        ring = []
        for d, e in enumerate(ahead):
            side = np.array([e[1], -e[0]])
            end = ends.get((a, d))
            ring += [2 * e + side, 2 * e - side] if end == "edge" else [2 * e if end else e]
        holes.append(np.array(ring[::-1]) + [4 * i, 4 * j])
    return shape(box(-2, -2, 4 * width - 2, 4 * height - 2), *holes)


def lattice_of_holes(k):
    """A square with k * k square holes, all gaps alike."""
    side = 2 * k + 1
    holes = [box(2 * i + 1, 2 * j + 1, 2 * i + 2, 2 * j + 2)[::-1] for i in range(k) for j in range(k)]
    return shape(box(0, 0, side, side), *holes)


def koch(depth):
    """A Koch snowflake: necks at every scale."""
    points = np.exp(2j * np.pi * np.arange(4) / -3)
    for _ in range(depth):
        step = np.diff(points)
        points = np.append(
            (points[:-1, None] + step[:, None] * [0, 1 / 3, 0.5 + np.sqrt(3) / 6 * 1j, 2 / 3]).ravel(),
            points[-1],
        )
    return shape(np.column_stack((points.real, points.imag))[:-1])


def spiral(turns, per_turn=24):
    """A corridor wound up: its dual tree is about as deep as it is long."""
    angle = np.linspace(2.0, 2.0 + 2 * np.pi * turns, turns * per_turn)
    outer = np.column_stack((np.cos(angle), np.sin(angle))) * (angle + 1.8)[:, None]
    inner = np.column_stack((np.cos(angle), np.sin(angle))) * (angle - 1.2)[:, None]
    return shape(np.concatenate((outer, inner[::-1])))


def comb(teeth):
    """A bar with teeth."""
    points = [(0, 0), (4 * teeth, 0)]
    for k in range(teeth - 1, -1, -1):
        points += [(4 * k + 3, 2), (4 * k + 3, 12), (4 * k + 2, 12), (4 * k + 2, 2)]
    return shape(points + [(0, 2)])


# ---------------------------------------------------------------- the same polygon, told otherwise


def restarted(s, by):
    """Every ring started elsewhere."""
    return shape(*(np.roll(ring, -by % len(ring), axis=0) for ring in s.rings))


def reversed_rings(s):
    return shape(*(ring[::-1] for ring in s.rings))


def reordered_holes(s, seed):
    order = np.random.default_rng(seed).permutation(np.arange(1, len(s.rings)))
    return shape(s.rings[0], *(s.rings[k] for k in order))


def numbered(s):
    """Third and fourth ordinates that tell the rows apart; every fifth is NaN."""
    number = np.arange(len(s.coords), dtype=float)
    z = np.where(number % 5 == 4, np.nan, number)
    return s._replace(coords=np.column_stack((s.coords[:, :2], z, -number)))


def with_duplicates(s, seed):
    """Some rows repeated, up to twice, as they are."""
    rng = np.random.default_rng(seed)
    return shape(*(np.repeat(ring, rng.integers(1, 4, len(ring)), axis=0) for ring in s.rings))

"""The triangulation engines against each other, on hostile polygons: no QGIS, nothing of the solver.

    ./run python tests/fuzz/engines.py [--polygons 5000] [--seed 1] [FILE.geojson ...]

Each engine triangulates each polygon in a process that may crash, and that ends itself if a call hangs. A
triangulation must consist of triangles that turn left, and of ring edges on their own and others in pairs (so it
tiles the polygon), and be Delaunay: all exactly, in rational numbers (but for GEOS, which rounds its circles).
Input that is no valid polygon goes to CDT alone, as Triangle crashes on it; there, an answer may be wrong in what
the solver checks itself: numbers and edges.
"""

import argparse
import collections
import json
import signal
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import shapely

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

import conftest  # noqa: E402, F401 it makes the package isthmus
import hostile  # noqa: E402

from isthmus.core.partition import engines  # noqa: E402
from isthmus.core.predicates import orientations  # noqa: E402

SECONDS = 20  # for one call


def graph(rings):
    """Distinct vertices and directed segments of rings, the inside on the left; None if there are none."""
    rings = [ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)] + 0.0 for ring in rings if len(ring)]
    if not rings or min(map(len, rings)) < 3 or not np.isfinite(np.concatenate(rings)).all():
        return None
    largest = np.abs(np.concatenate(rings)).max()
    if not 1e-50 < largest < 1e50:  # as the solver does
        rings = [np.ldexp(ring, -int(np.frexp(largest)[1])) for ring in rings]
    rings = [
        ring if shapely.is_ccw(shapely.linearrings(ring)) == (k == 0) else ring[::-1]
        for k, ring in enumerate(rings)
    ]
    xy, number = np.unique(np.concatenate(rings), axis=0, return_inverse=True)
    ends, start = [], 0
    for ring in rings:
        vertex = number.ravel()[start : start + len(ring)]
        start += len(ring)
        ends.append(np.column_stack((vertex, np.roll(vertex, -1))))
    ends = np.concatenate(ends)
    return rings, xy, _split(xy, ends) if len(xy) < 200 else ends


def _split(xy, ends):
    """Segments split where another vertex lies on them."""
    a, b = (np.repeat(xy[ends[:, k]], len(xy), axis=0) for k in (0, 1))
    p = np.tile(xy, (len(ends), 1))
    on = (orientations(a, b, p) == 0) & (p != a).any(axis=1) & (p != b).any(axis=1)
    on &= (np.minimum(a, b) <= p).all(axis=1) & (p <= np.maximum(a, b)).all(axis=1)
    on = on.reshape(len(ends), len(xy))
    if not on.any():
        return ends
    result = []
    for (u, v), vertices in zip(ends.tolist(), on):
        middle = np.flatnonzero(vertices)
        walk = [u, *middle[np.argsort(np.abs(xy[middle] - xy[u]).sum(axis=1))].tolist(), v]
        result += zip(walk[:-1], walk[1:])
    return np.array(result)


def problem(xy, segments, triangles, tolerance):
    """What is wrong with a triangulation, or ''."""
    if triangles.min() < 0 or triangles.max() >= len(xy):
        return "vertices of its own"
    if (orientations(*(xy[triangles[:, k]] for k in range(3))) <= 0).any():
        return "turned over"
    opposite = {}
    for corners in triangles.tolist():
        for k in range(3):
            opposite[corners[k], corners[k - 2]] = corners[k - 1]
    if len(opposite) != 3 * len(triangles):
        return "overlaps"
    if {edge for edge in opposite if edge[::-1] not in opposite} != set(map(tuple, segments.tolist())):
        return "other rings"
    points = [tuple(map(Fraction, point)) for point in xy.tolist()]
    for (u, v), w in opposite.items():
        if u < v and (v, u) in opposite:
            if inside_circle(*(points[k] for k in (u, v, w, opposite[v, u])), tolerance):
                return "not Delaunay"
    return ""


def inside_circle(a, b, c, d, tolerance):
    """Whether d is inside the circle through a, b, c, which turn left."""
    (ax, ay), (bx, by), (cx, cy) = ((x - d[0], y - d[1]) for x, y in (a, b, c))
    terms = (
        (ax * ax + ay * ay) * (bx * cy), (ax * ax + ay * ay) * (-cx * by),
        (bx * bx + by * by) * (cx * ay), (bx * bx + by * by) * (-ax * cy),
        (cx * cx + cy * cy) * (ax * by), (cx * cx + cy * cy) * (-bx * ay),
    )  # fmt: skip
    return sum(terms) > tolerance * sum(map(abs, terms))


def drawn(seed):
    """Polygons by a number: most are left whole."""
    rng = np.random.default_rng([7, seed])
    kind = rng.choice(list(hostile.KINDS))
    polygons = [[np.array(ring, dtype=float) for ring in p] for p in hostile.KINDS[kind](rng)]
    for _ in range(int(rng.choice([0, 1, 3], p=[0.6, 0.3, 0.1]))):
        polygons = hostile.MUTATIONS[rng.choice(list(hostile.MUTATIONS))](polygons, rng)
    return hostile.PLACES[rng.choice(list(hostile.PLACES))](polygons, rng)


def read(path):
    for feature in json.loads(Path(path).read_text())["features"]:
        shape = feature["geometry"] or {"type": None}
        many = {"Polygon": [shape.get("coordinates")], "MultiPolygon": shape.get("coordinates")}
        for rings in many.get(shape["type"], []) or []:
            yield [np.array(ring, dtype=float)[:-1, :2] if ring else np.empty((0, 2)) for ring in rings or []]


def work(first, last, paths):
    """In a process of its own: what came of each polygon, one line each, flushed before each call."""
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    from_files = [[polygon] for path in paths for polygon in read(path)]
    for seed in range(first, last):
        for rings in from_files[seed] if paths else drawn(seed):
            found = graph(rings)
            if found is None:
                continue
            rings, xy, segments = found
            try:
                valid = bool(shapely.is_valid(shapely.Polygon(rings[0], rings[1:])))
            except shapely.errors.GEOSException:
                valid = False
            for engine in engines.engine_names():
                if engine != "pythoncdt" and not valid:
                    continue  # these are known to crash
                print(json.dumps([seed, engine, valid, "died"]), flush=True)
                signal.alarm(SECONDS)
                triangles = engines.triangulate(engine, xy, [0, len(xy)], segments, [0, len(segments)])[0]
                signal.alarm(0)
                result = "no answer"
                if len(triangles):
                    tolerance = Fraction(1, 10**13) if engine == "shapely" else 0
                    result = problem(xy, segments, triangles, tolerance) or "right"
                print(json.dumps([seed, engine, valid, result]), flush=True)
    print("end", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--polygons", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", type=int, nargs=2, help=argparse.SUPPRESS)
    parser.add_argument("files", nargs="*")
    options = parser.parse_args()
    if options.work:
        return work(*options.work, options.files)
    first = 0 if options.files else options.seed * 10**6
    last = first + (sum(len(list(read(path))) for path in options.files) or options.polygons)
    counts, failed = collections.Counter(), []
    while first < last:
        command = [sys.executable, __file__, "--work", str(first), str(last), *options.files]
        process = subprocess.run(command, stdout=subprocess.PIPE, text=True)
        lines = process.stdout.splitlines()
        ended = lines[-1:] == ["end"]
        results = [json.loads(line) for line in lines[: len(lines) - ended]]
        for seed, engine, valid, result in results:
            if result != "died" or [seed, engine, valid, result] == results[-1]:
                counts[engine, "valid" if valid else "invalid", result] += 1
                checked = () if valid else ("other rings", "overlaps", "not Delaunay")
                if result not in ("right", "no answer", *checked):
                    failed.append((seed, engine, valid, result))
        if ended:
            break
        print(f"a process ended with {process.returncode} at {results[-1:]}")
        first = results[-1][0] + 1 if results else last
    for key, count in sorted(counts.items()):
        print(f"{count:8,}  {', '.join(key)}")
    print("\n".join(map(str, failed[:40])))
    return len(failed)


if __name__ == "__main__":
    sys.exit(main())

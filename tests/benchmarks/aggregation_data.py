"""Maps for the aggregation experiments, read without QGIS.

They lie in the folder that ISTHMUS_DATA names, or in ``shared/data`` beside the checkout or one
folder higher; where there is none, the experiments say so and end.
"""

import importlib.util
import os
import sqlite3
import sys
from pathlib import Path

import numpy as np
import shapely

ROOT = Path(__file__).resolve().parents[2]

if "isthmus" not in sys.modules:
    spec = importlib.util.spec_from_file_location(
        "isthmus", ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
    )
    sys.modules["isthmus"] = importlib.util.module_from_spec(spec)

from isthmus.core import metric  # noqa: E402
from isthmus.core.aggregation import coverage, instance  # noqa: E402
from isthmus.core.partition.solve import partition  # noqa: E402

# weights and thresholds of the published instance, see the issue on area aggregation
WEIGHTS = {"change": 1.0, "boundary": 45.0, "centre": 1.4e-4}
NOTES = {"change": 1.0, "boundary": 45.0, "centre": 1e-4}  # with the distance of centroids
LEAST, LESS, EXCLUDED = 400_000.0, {5112: 130_648.0, 3103: 44_121.0}, {2112}


def folder():
    """Return the folder of the maps, or end."""
    places = (
        [Path(os.environ["ISTHMUS_DATA"])]
        if "ISTHMUS_DATA" in os.environ
        else [ROOT.parent / "shared" / "data", ROOT.parents[1] / "shared" / "data"]
    )
    for place in places:
        if (place / "aggregation").is_dir():
            return place / "aggregation"
    sys.exit(f"Skipped: no folder with the maps at {' or '.join(map(str, places))} (ISTHMUS_DATA).")


def layer(name, table, columns):
    """Return the geometries of a GeoPackage's table and the values of some columns."""
    database = sqlite3.connect(f"file:{folder() / name}?mode=ro&immutable=1", uri=True)
    rows = database.execute(f"select geom, {', '.join(columns)} from {table}").fetchall()
    envelope = [0, 32, 48, 48, 64]
    blobs = [row[0][8 + envelope[(row[0][3] >> 1) & 7] :] for row in rows]
    return shapely.from_wkb(np.array(blobs, dtype=object)), np.array([row[1:] for row in rows])


def rings(shapes):
    """Return rows, ring offsets and the polygon of each ring."""
    lines, owner = shapely.get_rings(shapes, return_index=True)
    xy, ring = shapely.get_coordinates(lines, return_index=True)
    last = np.append(ring[1:] != ring[:-1], True)
    return xy[~last], np.append(0, np.cumsum(np.bincount(ring[~last]))), owner


def pieces(shapes, tau=4.0, smallest=None):
    """Partition polygons; return the parts as shapes and the polygon of each.

    ``smallest``: take natural candidates, and no part below this share of its polygon's area.
    """
    made, owner = [], []
    for number, shape in enumerate(shapes):
        xy, offsets, _ = rings([shape])
        parts = partition(
            xy, offsets, tau, natural=smallest is not None, smallest=(smallest or 0.0) * shape.area
        ).parts
        if len(parts.rings) == 1:
            made.append(shape)
        else:
            made += [shapely.Polygon(xy[r[0]], [xy[h] for h in r[1:]]) for r in parts.rings]
        owner += [number] * len(parts.rings)
    return np.array(made, dtype=object), np.array(owner)


def problem_of(shapes, classes, codes, distance, theta, **weights):
    """Return the instance of a coverage; ``classes`` are codes."""
    cover = coverage.cover(*rings(shapes))
    pairs, length = coverage.shared(cover, metric.planar())
    size, moment = coverage.centroids(cover, cover.coords, len(shapes))
    place = (moment[:, 0] + 1j * moment[:, 1]) / size
    cls = np.searchsorted(codes, classes)
    centre = np.column_stack((place.real, place.imag))
    rows = np.repeat(cover.ring_polygon, np.diff(cover.offsets))
    spread = coverage.spreads(cover, cover.coords - centre[rows], np.arange(len(shapes)))
    return instance.build(size, cls, place, pairs, length, distance, theta, spread=spread, **weights)


def buchholz(**weights):
    """Return shapes, class codes, the published region and class of each area, and a builder."""
    shapes, values = layer("buchholz_atkis.gpkg", "areas_5537", ["class", "hw_region", "hw_class"])
    table = np.genfromtxt(folder() / "buchholz_class_distance_tree6.csv", delimiter=",", skip_header=1)
    codes = table[:, 0].astype(int)
    theta = np.array([np.inf if code in EXCLUDED else LESS.get(code, LEAST) for code in codes.tolist()])

    def build(some, classes, **other):
        chosen = {**WEIGHTS, **weights, **other}
        return problem_of(some, classes, codes, table[:, 1:] / 6.0, theta, **chosen)

    return shapes, values[:, 0], values[:, 1], values[:, 2], build


def by_centroids(problem):
    """The same instance with the measure of Haunert and Wolff: areas as points."""
    return problem._replace(spread=np.zeros(len(problem.size)))


def published(problem, region, classes_kept, codes_of):
    """Return the published solution: its classes, and of each region the best core of that class."""
    best = []
    _, region = np.unique(region, return_inverse=True)
    for r in range(region.max() + 1):
        members = np.flatnonzero(region == r)
        kept = members[codes_of[members] == classes_kept[members]]
        best.append(kept[np.argmin(instance.shares(problem, members, kept).sum(axis=0))])
    return instance.Solution(region, np.array(best))

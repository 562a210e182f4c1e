"""The stages of one polygon, a chunk of one, for tests that look at a single stage."""

import numpy as np
from isthmus.core.errors import Unsolvable
from isthmus.core.partition import triangulation
from isthmus.core.partition.carving import carve, spanning_tree
from isthmus.core.partition.polygon import boundary_components
from isthmus.core.partition.solve import prepare
from isthmus.core.rings import Rings, offsets_of, one_polygon


def prepared(s, **options):
    """One polygon, ready to be solved; its lines, if any, as one array."""
    if "lines" in options:
        options["lines"] = [options["lines"]]
    found = prepare(one_polygon(*s), **options)
    if found.verdict[0]:
        raise Unsolvable(found.verdict[0])
    return found


def diagonals(polygon, conformal=None, engine=None):
    """The diagonals of the triangulation of a polygon."""
    triangles, (problem,), _ = triangulation.triangulate(polygon, conformal=conformal, engine=engine)
    if problem:
        raise Unsolvable(problem)
    return triangulation.diagonals(polygon, triangles)


def carved(polygon, edges, length):
    """T, and the walk around a polygon carved open along it."""
    component = boundary_components(polygon)
    wanted = np.zeros(len(component), dtype=bool)
    wanted[component] = True
    tree, apart = spanning_tree(polygon, component, edges, length, wanted)
    assert not apart.any()
    walk, ambiguous = carve(polygon, component, edges, tree, wanted)
    assert not ambiguous.any()
    return tree, walk


def together(shapes):
    """Several polygons as one chunk."""
    coords, sizes, rings = [], [], []
    for coordinates, offsets in shapes:
        coords.append(np.asarray(coordinates, dtype=float)[:, :2])
        sizes += np.diff(offsets).tolist()
        rings.append(len(offsets) - 1)
    return Rings(np.concatenate(coords), offsets_of(sizes), offsets_of(rings))

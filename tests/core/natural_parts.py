"""The stages of `solve.prepare` with the candidates and lengths of `natural`."""

import numpy as np
import shapely

from isthmus.core import metric
from isthmus.core.partition import solve
from isthmus.core.partition.candidates import counted
from isthmus.core.partition.carving import components, spanning_tree
from isthmus.core.partition.dilation import detours
from isthmus.core.partition.natural import natural
from isthmus.core.partition.polygon import from_rings, without_rings
from isthmus.core.partition.triangulation import diagonals, triangulate


def prepare(rings, smallest, measure=None, polygons=None):
    """(Prepared, Natural, index of the prepared edges among all diagonals, all diagonals).

    ``smallest`` is the area of the smallest part of each input polygon, or a function of the (p,) areas
    of the shells. Holes that are smaller do not count. Every polygon must be good.
    """
    measure = measure or metric.planar()
    if polygons is None:
        polygons, verdict = from_rings(rings)
        assert not any(verdict), verdict
    if callable(smallest):
        smallest = smallest(shell_areas(polygons, measure))
    smallest = np.broadcast_to(np.asarray(smallest, dtype=float), len(polygons.unit))
    component = components(polygons)
    wanted, attachable = counted(polygons, component, measure.equal_area, smallest)
    free = ~wanted[component]
    rest, vertex = without_rings(polygons, free) if free.any() else (polygons, None)
    triangles, verdict = triangulate(rest, conformal=measure.conformal)
    assert not any(verdict), verdict
    edges = diagonals(rest, triangles)
    if vertex is not None:
        edges, triangles = vertex[edges], vertex[triangles]
        lines = shapely.linearrings(polygons.xy[polygons.vertex], indices=polygons.ring_of_corner)
        small = shapely.STRtree(shapely.polygons(lines[free]))
        hit = small.query(shapely.linestrings(polygons.xy[edges]), predicate="intersects")[0]
        edges = np.delete(edges, hit, axis=0)
        edges = edges[attachable[edges].all(axis=1)]
    position = measure.positions(polygons.xy)
    found = natural(polygons, edges, triangles, position, measure, smallest)
    length = measure.length(position, edges[:, 0], edges[:, 1])
    tree, _ = spanning_tree(polygons, component, edges, length, wanted)
    needed = found.kept.copy()
    needed[tree] = True
    index = np.flatnonzero(needed)
    prepared = solve.Prepared(
        polygons=polygons,
        verdict=verdict,
        measure=measure,
        component=component,
        wanted=wanted,
        edges=edges[index],
        owner=polygons.polygon_of_vertex[edges[index, 0]],
        length=length[index],
        detour=detours(polygons, found.edge_length, edges[index], length[index]),
        bounded=found.kept[index],
        edge_length=found.edge_length,
        carved=None,
        lines=None,
        edge_line=None,
    )
    carved, _ = solve._carve(prepared, np.searchsorted(index, tree))
    return prepared._replace(carved=carved), found, index, edges


def shell_areas(polygons, measure):
    """(p,) float: the area of each polygon without its holes."""
    plane = measure.equal_area(polygons.xy)[polygons.vertex]
    lines = shapely.linearrings(plane, indices=polygons.ring_of_corner)
    return shapely.area(shapely.polygons(lines[polygons.polygon_offsets[:-1]]))

"""The whole road of a focus map: lines and a focus in, new positions out."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import shapely

from ..errors import Cancelled, Unsolvable
from ..partition import polygon as polygon_stage
from ..partition.triangulation import triangulate
from ..rings import signed_areas
from .crossings import FLAT, crossing_pairs, cycles, turned
from .deformation import focus_program
from .graph import Graph, build_graph, components, joins, match, unique_pairs
from .measures import Distortion, distortion
from .outline import carry, simplify
from .selection import select
from .untangle import last_good, new_crossings, pair_keys, repair, settle

__all__ = ["FocusMap", "enlarge"]

ATTEMPTS = 4  # to solve, with more detail where lines crossed
MOST = 3000  # vertices of the outline to solve on
POINT = 1e-12  # what is smaller than this share of the map is a point to the solver
SIDES = 64  # a focus without vertices of the map gets about so many on its outline


class FocusMap(NamedTuple):
    """A map with a region enlarged.

    Attributes
    ----------
    rows : (k, 2) float
        The input's points, moved.
    points, moved : (n, 2) float
        All vertices before and after, the focus and the frame with them: what other layers are
        carried by.
    edges : (e, 2) int
        Relevant edges: their ends as places in ``points``.
    kind : (e,) str
        'given' or 'selected', or 'join' between islands.
    scale : float
        That of the focus.
    distortion : Distortion
    crossings : int
        Pairs of segments that cross and did not before.
    problem : str
        Why the map is not all that was asked for, or ''.
    skipped : list of str
        Why some polygons got no relevant edges.
    """

    rows: np.ndarray
    points: np.ndarray
    moved: np.ndarray
    edges: np.ndarray
    kind: np.ndarray
    scale: float
    distortion: Distortion
    crossings: int
    problem: str
    skipped: list


def enlarge(
    rows,
    starts,
    polygons,
    focus,
    scale=2.0,
    edges=None,
    rule="MinSize",
    tau=2.0,
    frame=True,
    most=MOST,
    progress=None,
    cancelled=None,
):
    """Enlarge a region of a map and keep the shape of the rest (section 5.1 of the paper).

    Parameters
    ----------
    rows : (k, 2) float
        The points of all lines and rings one after the other, rings closed. Equal points are one.
    starts : (l + 1,) int
        Line i is ``rows[starts[i]:starts[i + 1]]``.
    polygons : list of list of int
        The lines that are rings of each polygon, its shell first.
    focus : shapely geometry
        The region, polygons.
    scale : float
        More than 0; of each part of the focus.
    edges : (e, 2) int, optional
        Relevant edges as input rows. Default: by the rule.
    rule : str
        One of `selection.RULES`.
    tau : float
        For the rule, and for the edges that join islands.
    frame : bool
        Whether the map's extent is kept. If not, the map grows where it must, and its outermost
        points keep their local scale.
    most : int
        Above this number of vertices, a simplified outline is solved for, and the detail carried
        along.
    progress : callable, optional
        Called with the share done, 0 to 1.
    cancelled : callable, optional
        Asked now and then; true stops the run.

    Returns
    -------
    FocusMap

    Raises
    ------
    Unsolvable
        If there is nothing that could be enlarged; it says why.
    Cancelled

    Notes
    -----
    Least squares and contacts on ``most`` vertices; O(n log n) for the rest, and for each test for
    crossings.
    """

    done = [0.0]

    def stage(lo, hi):
        def check(share=None):
            if cancelled is not None and cancelled():
                raise Cancelled("cancelled")
            if progress is not None and share is not None:
                done[0] = max(done[0], lo + (hi - lo) * share)  # a stage may come again
                progress(done[0])

        return check

    check = stage(0.0, 0.05)
    check(0.0)
    rows = np.asarray(rows, dtype=float)
    starts = np.asarray(starts, dtype=np.int64)
    if not len(rows):
        raise Unsolvable("the input has no coordinates")
    if not (scale > 0.0 and np.isfinite(scale)):
        raise Unsolvable(f"the scale must be a number above 0, and is {scale:g}")
    regions = _regions(focus)
    graph = build_graph(rows, starts)
    graph, group, regions = _groups(graph, rows, starts, polygons, regions)
    low, high = rows.min(axis=0), rows.max(axis=0)
    centre, unit = (low + high) / 2.0, float((high - low).max()) or 1.0
    if not np.isfinite(unit):
        raise Unsolvable(f"the coordinates are too large: they reach from {low} to {high}")
    _refuse_outlier(rows, starts, unit)
    graph, group = _distinct(graph, group, rows, (graph.xy - centre) / unit)
    given = np.empty((0, 2), dtype=np.int64) if edges is None else graph.vertex[edges]
    given = unique_pairs(given, len(graph.xy))
    if scale == 1.0:
        return _unchanged(rows, graph, given)

    xy = (graph.xy - centre) / unit
    box = ((low - centre) / unit, (high - centre) / unit) if frame else None
    origin = np.array([xy[group == g].mean(axis=0) for g in range(len(regions))])
    inside = group >= 0
    if frame:
        _room(xy, group, scale, box, unit)

    # the outline to solve on
    needed = np.zeros(len(xy), dtype=bool)
    needed[given.ravel()] = True
    changes = group[graph.edges[:, 0]] != group[graph.edges[:, 1]]
    needed[graph.edges[changes].ravel()] = True
    for axis in (0, 1):
        needed[[xy[:, axis].argmin(), xy[:, axis].argmax()]] = True
    known = pair_keys(crossing_pairs(xy, graph.edges), len(graph.edges))
    watched = cycles(len(xy), graph.edges)
    steady = inside.copy()
    for axis in (0, 1):
        steady[[xy[:, axis].argmin(), xy[:, axis].argmax()]] |= frame
    for attempt in range(ATTEMPTS):
        outline = simplify(xy, graph.edges, needed, most, check)
        kept = np.zeros(len(xy), dtype=bool)
        kept[outline.kept] = True
        skipped, chosen = [], given
        if edges is None:
            check = stage(0.05, 0.15)
            chosen = _selected(graph, xy, starts, polygons, kept, rule, tau, skipped, check)
        chosen = unique_pairs(chosen, len(xy))
        check = stage(0.15, 0.75)
        if inside.all():
            after, bridges = origin[group] + scale * (xy - origin[group]), given[:0]
            problem = ""
            break
        after, bridges, problem = _solved(
            xy, outline, chosen, group, origin, scale, tau, frame, box, check
        )
        check = stage(0.75, 0.9)
        if problem or not len(outline.rider):
            break
        # what the outline did not know
        after = repair(xy, after, graph.edges, known, watched, steady, box, check)
        crossed = graph.edges[new_crossings(after, graph.edges, known)]
        crossed = np.concatenate((crossed.ravel(), turned(xy, after, watched).ravel()))
        if not len(crossed):
            break
        _refine(xy, outline, crossed, needed)
    turned_over = _turned_over(graph, xy, starts, polygons)
    shapes = _shapes(graph, starts, polygons)
    was_valid = shapely.is_valid(shapes(xy))

    def faulty(positions):
        check()
        if box is not None and np.maximum(box[0] - positions, positions - box[1]).max() > 1e-8:
            return True
        if len(new_crossings(positions, graph.edges, known)) or len(turned(xy, positions, watched)):
            return True
        if turned_over(positions):
            return True
        return bool((was_valid & ~shapely.is_valid(shapes(positions))).any())

    reached = scale
    if problem or faulty(after):
        problem = problem or "lines would cross, shapes turn over, or something leave the frame"
        after, share = last_good(xy, after, faulty)
        reached = 1.0 + share * (scale - 1.0)
    if box is not None:
        after = np.where(inside[:, None], after, np.clip(after, box[0], box[1]))
    check = stage(0.9, 1.0)
    shift = unit * (after - xy)  # what does not move does not change a bit
    check(0.0)
    return FocusMap(
        rows=rows + shift[graph.vertex[:len(rows)]],
        points=graph.xy,
        moved=graph.xy + shift,
        edges=np.concatenate((chosen, bridges)),
        kind=np.array(["selected" if edges is None else "given"] * len(chosen)
                      + ["join"] * len(bridges)),
        scale=float(reached),
        distortion=distortion(xy, after, _triangles(graph, xy, starts, polygons, check)),
        crossings=len(new_crossings(after, graph.edges, known)),
        problem=problem,
        skipped=skipped,
    )


def _solved(xy, outline, chosen, group, origin, scale, tau, frame, box, check):
    """Positions of all vertices, the edges that join islands, and what is wrong, or ''."""
    place = np.full(len(xy), -1)
    place[outline.kept] = np.arange(len(outline.kept))
    solid = np.concatenate((outline.edges, chosen))
    bridges = outline.kept[joins(xy[outline.kept], place[solid], tau)]
    links = unique_pairs(place[np.concatenate((solid, bridges))], len(outline.kept))
    segments = place[solid]  # diagonals too: the parts of the map stay in their places
    start = xy[outline.kept]
    known = pair_keys(crossing_pairs(start, segments), len(segments))
    watched = cycles(len(start), unique_pairs(place[outline.edges], len(start)))
    fixed = _fixed(start, group[outline.kept], origin, scale, frame)
    program = focus_program(start, links, group[outline.kept], origin, scale, fixed)
    solved, s, problem = settle(program, segments, known, watched, box, check)
    after, local = xy.copy(), np.ones(len(xy))
    after[outline.kept], local[outline.kept] = solved, s
    after = carry(outline, xy, after, local)
    is_kept = place >= 0
    for g in range(len(origin)):  # exact, to the last digit
        mine = np.flatnonzero(group == g)
        anchor = mine[np.argmax(is_kept[mine])]
        after[mine] = after[anchor] + scale * (xy[mine] - xy[anchor])
    return after, bridges, problem


def _refine(xy, outline, crossed, needed):
    """Keep more detail of the outline around vertices of what crosses."""
    from scipy.spatial import cKDTree

    near = cKDTree(xy[outline.rider]).query_ball_point(xy[np.unique(crossed)], 0.005)
    needed[outline.rider[np.unique(np.concatenate(near).astype(np.int64))]] = True


def _regions(focus):
    """The parts of the focus; those that touch each other are one, as they have to move together."""
    if focus is None or shapely.is_empty(focus):
        raise Unsolvable("the focus is empty")
    parts = shapely.get_parts(shapely.union_all(shapely.get_parts(shapely.make_valid(focus))))
    parts = parts[shapely.area(parts) > 0.0]
    if not len(parts):
        raise Unsolvable("the focus has no area")
    touching = np.stack(shapely.STRtree(parts).query(parts, predicate="intersects"), axis=1)
    whole = components(len(parts), touching)
    return [shapely.multipolygons(parts[whole == k]) for k in range(whole.max() + 1)]


def _groups(graph, rows, starts, polygons, regions):
    """The graph, the region of each vertex (-1: none), and the regions that touch the map.

    A region without vertices gives its own outline to the graph, to push the rest away.
    """
    low, high = rows.min(axis=0), rows.max(axis=0)
    extent = shapely.box(*low, *high)
    used, outlines = [], []
    for region in regions:
        if _inside(region, graph.xy).any():
            used.append(region)
        elif _meets(region, rows, starts, polygons):
            used.append(region)
            seen = shapely.get_parts(shapely.intersection(region, extent))
            for part in seen[shapely.area(seen) > 0.0]:
                step = shapely.length(part) / SIDES
                ring = shapely.get_coordinates(shapely.segmentize(part, step).exterior)
                outlines.append((len(used) - 1, ring))
    if not used:
        raise Unsolvable(
            "the focus touches nothing: no vertex, line or polygon of the input lies in it. "
            "Are the CRS of both layers right?"
        )
    if outlines:
        lengths = [len(ring) for _, ring in outlines]
        graph = build_graph(
            np.concatenate([rows] + [ring for _, ring in outlines]),
            np.append(starts, starts[-1] + np.cumsum(lengths)),
        )
    group = np.full(len(graph.xy), -1)
    for g, region in enumerate(used):
        group[_inside(region, graph.xy)] = g
    place = len(rows)
    for g, ring in outlines:
        group[graph.vertex[place:place + len(ring)]] = g
        place += len(ring)
    return graph, group, used


def _refuse_outlier(rows, starts, unit):
    """Complain if the map is so wide that most of its lines are no longer than a point in it."""
    begin = starts[:-1][np.diff(starts) > 0]
    length = (np.maximum.reduceat(rows, begin) - np.minimum.reduceat(rows, begin)).max(axis=1)
    long = length[length > 0.0] / unit
    if len(long) and np.count_nonzero(long < POINT) * 2 >= len(long):
        _complain_of_outlier(rows, "most of its lines are no longer than a point")


def _complain_of_outlier(rows, what):
    x, y = rows[np.argmax(np.abs(rows).max(axis=1))]
    raise Unsolvable(
        f"the map reaches as far as ({x:g} {y:g}), and compared with that, {what}. Is this coordinate "
        "right?"
    )


def _distinct(graph, group, rows, xy):
    """The graph, and the groups, with one vertex for points that the solver could not tell apart."""
    from scipy.spatial import cKDTree

    near = cKDTree(xy).query_pairs(POINT, output_type="ndarray")
    if not len(near):
        return graph, group
    same = components(len(xy), near)
    first = np.sort(np.unique(same, return_index=True)[1])  # vertices stay in their order
    place = np.empty(len(first), dtype=np.int64)
    place[same[first]] = np.arange(len(first))
    vertex = place[same]
    merged = np.full(len(first), -1)
    np.maximum.at(merged, vertex, group)
    if len(np.unique(merged)) < len(np.unique(group)):
        _complain_of_outlier(rows, "parts of the focus are one point")
    edges = unique_pairs(vertex[graph.edges], len(first))
    return Graph(graph.xy[first], vertex[graph.vertex], edges), merged


def _inside(region, xy):
    """Whether points lie in a region or on its outline.

    Not by `shapely.intersects_xy`: with shapely's wheel inside QGIS, which has a GEOS of its own, that
    crashes (shapely 2.1.2, QGIS 3.22).
    """
    shapely.prepare(region)
    low_x, low_y, high_x, high_y = shapely.bounds(region)
    x, y = xy.T
    inside = (x >= low_x) & (x <= high_x) & (y >= low_y) & (y <= high_y)
    inside[inside] = shapely.covers(region, shapely.points(xy[inside]))
    return inside


def _meets(region, rows, starts, polygons):
    """Whether a region without vertices of the map lies on a line or in a polygon."""
    long = np.flatnonzero(np.diff(starts) > 1)
    if not len(long):
        return False
    taken = np.concatenate([np.arange(starts[k], starts[k + 1]) for k in long])
    lines = shapely.linestrings(rows[taken], indices=np.repeat(
        np.arange(len(long)), np.diff(starts)[long]))
    if shapely.intersects(region, lines).any():
        return True
    for point in shapely.get_coordinates(shapely.point_on_surface(shapely.get_parts(region))):
        for rings in polygons:
            odd = False
            for ring in rings:
                x, y = (rows[starts[ring]:starts[ring + 1]] - point).T
                over = (y[:-1] > 0.0) != (y[1:] > 0.0)
                a, b = np.flatnonzero(over), np.flatnonzero(over) + 1
                cut = x[a] - y[a] * (x[b] - x[a]) / (y[b] - y[a])
                odd ^= bool(np.count_nonzero(cut > 0.0) % 2)
            if odd:
                return True
    return False


def _unchanged(rows, graph, given):
    """The map at scale 1."""
    return FocusMap(
        rows=rows.copy(), points=graph.xy, moved=graph.xy, edges=given,
        kind=np.array(["given"] * len(given)), scale=1.0, distortion=Distortion(0.0, 0.0, 0.0),
        crossings=0, problem="", skipped=[],
    )  # fmt: skip


def _room(xy, group, scale, box, unit):
    """Complain if the focus cannot fit in the frame."""
    if (group >= 0).all() and len(np.unique(group)) == 1:
        raise Unsolvable(
            "the focus covers all of the input, so nothing can make room for it. Choose a smaller "
            "focus, or let the map grow (switch the frame off)"
        )
    for g in np.unique(group[group >= 0]):
        size = np.ptp(xy[group == g], axis=0)
        room = box[1] - box[0]
        # across a map that is flat, nothing needs room
        largest = np.min(np.divide(room, size, out=np.full(2, np.inf), where=size > 0.0))
        if scale > max(largest, 1.0) * (1.0 + 1e-9):
            raise Unsolvable(
                f"enlarged {scale:.10g} times, the focus is larger than the frame, which leaves room "
                f"for a scale of {math.floor(largest * 1000.0) / 1000.0:g}. Choose a smaller scale, or "
                "let the map grow (switch the frame off)"
            )


def _fixed(xy, group, origin, scale, frame):
    """Coordinates and scales that are fixed; see `deformation.focus_program`."""
    region = np.flatnonzero(group >= 0)
    fixed = []
    if not frame:
        # the first region stays where it is, and the outermost points keep their size
        v = region[group[region] == group[region].min()][0]
        at = (scale - 1.0) * (xy[v] - origin[group[v]])
        fixed += [(axis, v, at[axis]) for axis in (0, 1)]
    for axis in (0, 1):
        first = np.flatnonzero(xy[:, axis] <= xy[:, axis].min() + 1e-12).tolist()
        last = np.flatnonzero(xy[:, axis] >= xy[:, axis].max() - 1e-12).tolist()
        if not frame:
            fixed += [(2, v, 0.0) for v in first + last if group[v] < 0]
            continue
        both = set(group[first].tolist()) & set(group[last].tolist()) - {-1}
        for v in first + last:
            # a region that reaches from side to side, and shrinks, leaves both
            g = group[v]
            middle = (scale - 1.0) * (xy[v, axis] - origin[g, axis])
            fixed.append((axis, v, middle if g in both else 0.0))
    return fixed


def _rings(graph, starts, lines, kept=None):
    """Vertices of closed lines, none repeated at the end, and where each ring starts."""
    rings = []
    for line in lines:
        ring = graph.vertex[starts[line]:starts[line + 1]]
        ring = ring[:-1] if len(ring) > 1 and ring[0] == ring[-1] else ring
        rings.append(ring if kept is None else ring[kept[ring]])
    rings = rings[:1] + [ring for ring in rings[1:] if len(ring) > 2]
    return np.concatenate(rings), np.append(0, np.cumsum([len(ring) for ring in rings]))


def _selected(graph, xy, starts, polygons, kept, rule, tau, skipped, check):
    """Relevant edges of all polygons, and of the faces between lines."""
    if rule == "None":
        return np.empty((0, 2), dtype=np.int64)
    extent = float(np.hypot(*np.ptp(xy, axis=0)))
    chosen = [np.empty((0, 2), dtype=np.int64)]

    def add(vertices, offsets, name):
        if offsets[1] < 4:
            return
        try:
            found = select(rule, xy[vertices], offsets, tau, extent, check)
            chosen.append(vertices[found])
        except Unsolvable as reason:
            skipped.append(f"{name}: {reason}")

    for number, lines in enumerate(polygons):
        check(number / len(polygons))
        add(*_rings(graph, starts, lines, kept), f"polygon {number + 1}")
    is_line = np.ones(len(starts) - 1, dtype=bool)
    is_line[[line for lines in polygons for line in lines]] = False
    pairs = []
    for line in np.flatnonzero(is_line):
        way = graph.vertex[starts[line]:starts[line + 1]]
        way = way[kept[way]]
        pairs.append(np.column_stack((way[:-1], way[1:])))
    if pairs:
        pairs = unique_pairs(np.concatenate(pairs), len(xy))
        faces = shapely.get_parts(shapely.polygonize(shapely.linestrings(xy[pairs])))
        for number, face in enumerate(faces):
            check()
            rings = [shapely.get_coordinates(ring)[:-1] for ring in shapely.get_rings(face)]
            offsets = np.append(0, np.cumsum([len(ring) for ring in rings]))
            add(match(xy, np.concatenate(rings)), offsets, f"face {number + 1} between the lines")
    return np.concatenate(chosen)


def _turned_over(graph, xy, starts, polygons):
    """A function that tells of positions whether a ring has turned over; no edges need cross for that."""
    lines = [k for polygon in polygons for k in polygon if starts[k + 1] > starts[k]]
    if not lines:
        return lambda positions: False
    rows = np.concatenate([graph.vertex[starts[k]:starts[k + 1]] for k in lines])
    offsets = np.append(0, np.cumsum([starts[k + 1] - starts[k] for k in lines]))
    before = signed_areas(xy[rows], offsets)
    step = np.hypot(*np.diff(xy[rows], axis=0, append=xy[rows[:1]]).T)
    seen = np.abs(before) > FLAT * np.add.reduceat(step, offsets[:-1])

    def turned_over(positions):
        return bool((seen & (signed_areas(positions[rows], offsets) * before < 0.0)).any())

    return turned_over


def _shapes(graph, starts, polygons):
    """A function that makes the polygons of positions, to see whether they are valid."""
    usable = [
        lines for lines in polygons if all(starts[k + 1] - starts[k] >= 4 for k in lines)
    ]
    if not usable:
        return lambda positions: np.empty(0, dtype=object)
    lines = np.array([line for polygon in usable for line in polygon])
    rows = np.concatenate([graph.vertex[starts[k]:starts[k + 1]] for k in lines])
    number = np.repeat(np.arange(len(lines)), (starts[1:] - starts[:-1])[lines])
    bounds = np.append(0, np.cumsum([len(polygon) for polygon in usable])).tolist()

    def shapes(positions):
        rings = shapely.linearrings(positions[rows], indices=number)
        made = shapely.polygons(rings[bounds[:-1]])
        for k, (lo, hi) in enumerate(zip(bounds[:-1], bounds[1:])):
            if hi - lo > 1:
                made[k] = shapely.polygons(rings[lo], rings[lo + 1:hi])
        return made

    return shapes


def _triangles(graph, xy, starts, polygons, check):
    """The triangles of all polygons, as vertices."""
    found = [np.empty((0, 3), dtype=np.int64)]
    for number, lines in enumerate(polygons):
        check(number / len(polygons))
        vertices, offsets = _rings(graph, starts, lines)
        if offsets[1] < 3:
            continue
        try:
            polygon = polygon_stage.one(xy[vertices], offsets)
            corner = np.empty(len(polygon.xy), dtype=np.int64)
            corner[polygon.vertex] = polygon.rows[polygon.row_start[:-1]]
            found.append(vertices[corner[triangulate(polygon)[0]]])
        except Unsolvable:
            continue
    return np.concatenate(found)

"""The whole road of a focus map: lines and a focus in, new positions out."""

from __future__ import annotations

import math
from typing import Callable, NamedTuple, Sequence

import numpy as np
import shapely

from ..errors import Cancelled, Sentence, Unsolvable
from .convex import stay_convex
from .deformation import relax, unbounded
from .graph import Graph, build_graph, components, joins, match, unique_pairs
from .hierarchy import coarsen, reinsert
from .measures import Distortion, distortion
from .mesh import cross, crossed, frame_triangles, node, others, turned
from .selection import select

__all__ = ["FocusMap", "enlarge"]

MOST = 3000  # vertices outside the focus to solve for
POINT = 1e-12  # what is smaller than this share of the map is a point to the solver
SIDES = 64  # a focus gets about so many vertices on its outline where the map has none
GRID = 32  # free vertices along the longer side of the frame, where there is no polygon
DILATATION = 1.4  # of the ring around the focus, if the frame may grow as it should
LAND = 10.0  # how much stiffer polygons are than what is between them
PAD = 0.05  # what a frame gets beyond a side that the focus leaves, or that a flat map lacks
ATTEMPTS = 3  # to carry the detail, with more of it solved for where a triangle turned
GAPS = (0.0, 1e-6, 1e-4)  # of the map's width: what is narrower is not solved for; the first that arrives
WHOLE = 20_000  # vertices that are solved for at last, if need be


class NoRoom(Unsolvable):
    """The scale was not reached, or not without a fold."""


class FocusMap(NamedTuple):
    """A map with a region enlarged.

    Attributes
    ----------
    rows : (k, 2) float
        The input's points, moved.
    points, moved : (n, 2) float
        The vertices of the triangulation before and after.
    triangles : (t, 3) int
        All of the frame, counter-clockwise before and after: what other layers are carried by.
    splits : (s, 3) float
        Input rows that a vertex has to be put in after, as other lines meet the edge there, or are so near
        that there was no room with a gap: the row, the place in ``points``, and the share of the way to the
        next row.
    edges : (e, 2) int
        Relevant edges: their ends as places in ``points``.
    kind : (e,) str
        'given' or 'selected', or 'join' between islands.
    scale : float
        That of the focus.
    growth : (2,) float
        How many times as wide and high the frame is.
    distortion : Distortion
    skipped : list of str
        Why some polygons got no relevant edges.
    dented : int
        Corners at which squares, or other polygons of points on a circle with nothing in them, are no longer
        convex. Nothing crosses or folds there (see `mesh`).
    """

    rows: np.ndarray
    points: np.ndarray
    moved: np.ndarray
    triangles: np.ndarray
    splits: np.ndarray
    edges: np.ndarray
    kind: np.ndarray
    scale: float
    growth: np.ndarray
    distortion: Distortion
    skipped: list
    dented: int

    @property
    def put_in(self) -> np.ndarray:
        """(s, 4) float: the splits as `carrying.placed` takes them."""
        row, vertex, share = self.splits.T
        return np.column_stack((row, self.moved[vertex.astype(np.int64)], share))


def enlarge(
    rows: np.ndarray,
    starts: np.ndarray,
    polygons: Sequence[Sequence[int]],
    focus: shapely.Geometry,
    scale: float = 2.0,
    *,
    edges: np.ndarray | None = None,
    rule: str | Callable = "MinSize",
    tau: float = 2.0,
    frame: bool = True,
    growth: float = 0.0,
    aspect: float = 1.0,
    most: int = MOST,
    progress: Callable | None = None,
    cancelled: Callable | None = None,
) -> FocusMap:
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
        Whether the map's extent is kept, but for ``growth``. If not, the map grows as it likes.
    growth : float
        By what share the frame may grow, at least 0.
    aspect : float
        How long a unit of x is on the ground, in units of y: the cosine of the middle latitude for a
        map in degrees.
    most : int
        Above this number of vertices outside the focus, a simplified map is solved for, and the
        detail carried along.
    progress : callable, optional
        Called with the share done, 0 to 1.
    cancelled : callable, optional
        Asked now and then; true stops the run.

    Returns
    -------
    FocusMap
        The focus is scaled exactly, and no triangle of the frame is turned.

    Raises
    ------
    Unsolvable
        If there is nothing that could be enlarged, or no room for it; it says why.
    Cancelled, MissingEngine

    Notes
    -----
    Newton steps on ``most`` vertices and the outline of the focus; O(n log n) for the rest.

    Examples
    --------
    A lake of 2 by 2 in a country of 10 by 10: it becomes twice as wide, and the country stays as it is.

    >>> import shapely
    >>> country = [(0, 0), (10, 0), (10, 10), (0, 10), (0, 0)]
    >>> lake = [(4, 4), (4, 6), (6, 6), (6, 4), (4, 4)]
    >>> rows, starts = np.array(country + lake, dtype=float), np.array([0, 5, 10])
    >>> found = enlarge(rows, starts, [[0, 1]], shapely.box(3.5, 3.5, 6.5, 6.5), scale=2.0)
    >>> np.ptp(found.rows[5:], axis=0).round(6).tolist()
    [4.0, 4.0]
    >>> np.ptp(found.rows[:5], axis=0).round(6).tolist()
    [10.0, 10.0]
    """
    stage = _stages(progress, cancelled)
    check = stage(0.0, 0.05)
    check(0.0)
    rows, starts = np.asarray(rows, dtype=float), np.asarray(starts, dtype=np.int64)
    if not len(rows):
        raise Unsolvable(Sentence("the input has no coordinates"))
    if not (scale > 0.0 and np.isfinite(scale)):
        raise Unsolvable(Sentence("the scale must be a number above 0, and is {:g}", scale))
    regions = _regions(focus)
    graph = build_graph(rows, starts)
    centre, unit = _units(rows, starts, aspect)

    def local(xy):
        return (xy - centre) / unit

    box = local(rows.min(axis=0)), local(rows.max(axis=0))

    def at_sides(xy):  # what is at a side but for rounding is on it
        for corner in box:
            xy = np.where(np.abs(xy - corner) < 1e-9, corner, xy)
        return xy

    group, regions = _groups(graph, rows, starts, polygons, regions)
    graph, group = _distinct(graph, group, rows, at_sides(local(graph.xy)))
    given = np.empty((0, 2), dtype=np.int64) if edges is None else graph.vertex[edges]
    given = unique_pairs(given, len(graph.xy))
    xy = at_sides(local(graph.xy))
    regions = [shapely.transform(region, local) for region in regions]
    land = _land(local(rows), starts, polygons)
    asked = _Asked(scale, tau, frame, growth, most)

    def choose(coarse, xy, check):
        skipped.clear()  # an attempt may come again
        return _selected(coarse, graph, xy, starts, polygons, rule, tau, skipped, check)

    skipped: list = []
    refused: list[NoRoom] = []
    for gap in GAPS:
        check = stage(0.0, 0.05)
        check(0.4)
        noded = node(xy, graph.edges, check, gap)
        check(0.6)
        mesh = _mesh(noded, group, regions, land, box, frame, scale, check)
        points = np.concatenate((graph.xy, centre + unit * mesh.xy[len(graph.xy) :]))
        try:
            if scale == 1.0:
                found = _Moved(np.zeros_like(mesh.xy), given, given[:0], np.ones(2), 0)
            else:
                found = _moved(
                    mesh, land, points, unit, given, choose if edges is None else None, gap, asked, stage
                )
            break
        except NoRoom as problem:  # slivers may be what stops it
            refused.append(problem)
    else:
        raise refused[0]
    check = stage(0.95, 1.0)
    moved = unit * found.shift  # what does not move does not change a bit
    if not np.isfinite(moved).all():
        raise Unsolvable(Sentence("the map could not be solved: some positions are not finite numbers"))
    inside = _covered(mesh, land, check)
    check(1.0)
    own = "selected" if edges is None else "given"
    return FocusMap(
        rows=rows + moved[graph.vertex],
        points=points,
        moved=points + moved,
        triangles=mesh.triangles,
        splits=_row_splits(noded, graph, starts),
        edges=np.concatenate((found.chosen, found.bridges)),
        kind=np.repeat([own, "join"], (len(found.chosen), len(found.bridges))),
        scale=float(scale),
        growth=found.growth,
        distortion=distortion(mesh.xy, mesh.xy + found.shift, mesh.triangles[inside]),
        skipped=skipped,
        dented=found.dented,
    )


def _stages(progress, cancelled):
    """What makes the check of a stage, which tells of progress from one share to another, and may cancel."""
    done = [0.0]

    def stage(lo, hi):
        def check(share=None):
            if cancelled is not None and cancelled():
                raise Cancelled("cancelled")
            if progress is not None and share is not None:
                done[0] = max(done[0], lo + (hi - lo) * share)  # a stage may come again
                progress(done[0])

        return check

    return stage


def _units(rows, starts, aspect):
    """The middle of the map, and its width along each axis: in these it is solved."""
    low, high = rows.min(axis=0), rows.max(axis=0)
    stretch = np.array([aspect, 1.0])
    unit = float(((high - low) * stretch).max()) or 1.0
    if not np.isfinite(unit):
        raise Unsolvable(Sentence("the coordinates are too large: they reach from {} to {}", low, high))
    _refuse_outlier(rows, starts, unit)
    return (low + high) / 2.0, unit / stretch


class _Asked(NamedTuple):
    """What `enlarge` is asked for."""

    scale: float
    tau: float
    frame: bool
    growth: float
    most: int


class _Moved(NamedTuple):
    """A solution: how vertices move, and what held them together."""

    shift: np.ndarray
    chosen: np.ndarray
    bridges: np.ndarray  # edges that join islands
    growth: np.ndarray
    dented: int


def _moved(mesh, land, points, unit, given, choose, gap, asked, stage):
    """The map solved for, its detail carried along: without a turned triangle, and as few dents as may be.

    What is narrower than a gap is detail. Where the detail turns a triangle, or dents a square, more is
    solved for, at last all of a map that is not too large: while it is solved for, no triangle turns whose
    corners are all there.
    """
    needed = np.zeros(len(mesh.xy), dtype=bool)
    needed[given.ravel()] = True
    best = None
    for attempt in range(1, ATTEMPTS + 1):
        if attempt == ATTEMPTS > 1 and not gap and np.count_nonzero(mesh.removable) <= WHOLE:
            needed[:] = True
        try:
            made = _attempt(mesh, land, needed, given, choose, gap, asked, stage)
        except NoRoom:
            if best is None:
                raise
            break
        bad, dents = _damage(mesh, points, points + unit * made.shift)
        if not bad.any():
            made = made._replace(dented=len(np.unique(dents[:, 1])))
            best = made if best is None else min(best, made, key=lambda one: one.dented)
            if not made.dented:
                break
        needed[mesh.triangles[bad]] = True
        needed |= _around(mesh, dents, attempt)
    if best is None:
        x, y = points[mesh.triangles[bad].min()]
        near = Sentence(
            "lines of the map are too close to each other to be moved without a fold, near ({:g} {:g})",
            x,
            y,
        )
        raise NoRoom(near)
    return best


def _attempt(mesh, land, needed, given, choose, gap, asked, stage):
    """The map solved for on what is needed and some more, and all of the rest put back."""
    xy = mesh.xy
    coarse = coarsen(
        xy, mesh.triangles, mesh.edges, mesh.removable & ~needed, mesh.rigid, asked.most,
        stage(0.05, 0.2), gap=gap, side=mesh.side_bits,
    )  # fmt: skip
    chosen = given if choose is None else choose(coarse, xy, stage(0.2, 0.3))
    chosen = unique_pairs(chosen, len(xy))
    solid = np.concatenate((coarse.edges, chosen))
    shift, bridges, growth = _solved(mesh, coarse, land, solid, asked, stage(0.3, 0.85))
    check = stage(0.85, 0.95)
    _scale_exactly(mesh, shift, asked.scale, asked.frame)
    shift = reinsert(coarse, xy, shift, mesh.rigid, check)
    for k, side in enumerate(mesh.side):  # what went along it is on it to the last digit
        gone = coarse.into[side] != side
        shift[side[gone], k // 2] = shift[side[~gone][0], k // 2]
    free = mesh.group < 0
    free[np.concatenate(mesh.side)] = False
    shift = stay_convex(xy, shift, mesh.triangles, mesh.spare, free, check)
    return _Moved(shift, chosen, bridges, growth, 0)


def _damage(mesh, before, after):
    """Which triangles are turned where they will be, rounded, and which of other triangulations."""
    bad = turned(before, after, mesh.triangles) | crossed(before, after, mesh.triangles, mesh.edges)
    return bad, mesh.spare[turned(before, after, mesh.spare)]


def _around(mesh, dents, rings):
    """Which vertices are dented, or near: so many rings, or the dent goes next door."""
    near = np.zeros(len(mesh.xy), dtype=bool)
    near[dents] = True
    for _ in range(rings):
        near[mesh.triangles[near[mesh.triangles].any(axis=1)]] = True
    return near


def _scale_exactly(mesh, shift, scale, frame):
    """Put the focus, in place, where it is scaled to the last digit."""
    xy, group = mesh.xy, mesh.group
    for g in np.unique(group[group >= 0]):
        mine = np.flatnonzero(group == g)
        anchor = mine[np.argmax(~mesh.rigid[mine])]
        shift[mine] = shift[anchor] + (scale - 1.0) * (xy[mine] - xy[anchor])
    if not frame:  # the first region stays where it is
        mine = np.flatnonzero(group == 0)
        own = mine[mesh.map_vertex[mine]] if mesh.map_vertex[mine].any() else mine
        middle = xy[own].mean(axis=0)
        shift -= shift[mine[0]] - (scale - 1.0) * (xy[mine[0]] - middle)


class _Mesh(NamedTuple):
    """The triangulation of the frame, and what its vertices are."""

    xy: np.ndarray
    triangles: np.ndarray
    map_vertex: np.ndarray
    group: np.ndarray  # the region in focus, -1 for none
    side: tuple  # vertices on the left, right, lower, upper side
    side_bits: np.ndarray  # the same for each vertex: 1, 2, 4, 8, or sums at corners
    padded: np.ndarray  # (2,): what the frame gives back on both sides along each axis
    removable: np.ndarray
    rigid: np.ndarray
    edges: np.ndarray  # of the map
    spare: np.ndarray  # triangles of other triangulations, see `others`


def _mesh(noded, group, regions, land, box, frame, scale, check):
    """Triangulate the frame: the map, and free vertices where there is no polygon."""
    n = len(noded.xy)
    group = np.concatenate((group, np.full(n - len(group), -1)))
    for g, region in enumerate(regions):
        new = np.flatnonzero(group < 0)
        group[new[_inside(region, noded.xy[new])]] = g
    low, high, padded = _padded(noded.xy, group, box, frame and scale < 1.0)
    known = {
        tuple(point) for point in noded.xy[((noded.xy == low) | (noded.xy == high)).all(axis=1)].tolist()
    }
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
    corners = np.array([p for p in corners.tolist() if tuple(p) not in known]).reshape(-1, 2)
    extra, own = _free_vertices(noded, group, regions, land, low, high)
    xy = np.concatenate((noded.xy, corners, extra))
    group = np.concatenate((group, np.full(len(corners), -1), own))
    side, rim = [], []
    for axis in (0, 1):
        for value in (low[axis], high[axis]):
            on = np.flatnonzero(xy[:, axis] == value)
            side.append(on)
            on = on[np.argsort(xy[on, 1 - axis])]
            rim.append(np.column_stack((on[:-1], on[1:])))
    check()
    triangles = frame_triangles(xy, unique_pairs(np.concatenate([noded.edges] + rim), len(xy)))
    own = group[triangles]
    mixed = (own.min(axis=1) != own.max(axis=1)) | (own[:, 0] < 0)
    rigid = group >= 0
    rigid[triangles[mixed]] = False
    of_map = np.arange(len(xy)) < n
    bits = sum((1 << k) * np.isin(np.arange(len(xy)), on) for k, on in enumerate(side))
    rigid &= of_map & (bits == 0)
    removable = of_map & (rigid | (group < 0))
    spare = others(xy, triangles, noded.edges)
    return _Mesh(
        xy, triangles, of_map, group, tuple(side), bits, padded, removable, rigid, noded.edges, spare
    )


def _padded(xy, group, box, shrinks):
    """The lower left and upper right corner of the frame, and how much of it is given back at the end."""
    low, high = (corner.copy() for corner in box)
    size, padded = high - low, np.zeros(2)
    for axis in (0, 1):
        flat = size[axis] < 1e-3 * size.max() or size.max() == 0.0
        x = xy[:, axis]
        spans = set(group[x <= low[axis]].tolist()) & set(group[x >= high[axis]].tolist()) - {-1}
        pad = 0.5 if flat else PAD if spans and shrinks else 0.0
        low[axis] -= pad
        high[axis] += pad
        padded[axis] = 0.0 if flat else pad
    return low, high, padded


def _free_vertices(noded, group, regions, land, low, high):
    """Vertices where the map has none: on a grid, and on the outlines of regions; and their regions."""
    cell = (high - low).max() / GRID
    grid, own = _grid(regions, land, low, high, cell)
    extra, own, gap = [grid], [own], [np.full(len(grid), 0.3 * cell)]
    for g, region in enumerate(regions):
        mine = group == g
        for ring, step in _outlines(region, noded.xy[mine], land, low, high):
            extra.append(ring)
            own.append(np.full(len(ring), g))
            gap.append(np.full(len(ring), 0.2 * min(step, cell) if mine.any() else 1e-6))
    extra, own = np.concatenate(extra), np.concatenate(own)
    kept = np.flatnonzero(_roomy(extra, noded, np.concatenate(gap)))
    kept = kept[_apart(extra[kept], 0.1 * cell, own[kept])]
    for g in range(len(regions)):
        if not (group == g).any() and not (own[kept] == g).any():
            raise Unsolvable(
                Sentence("the focus lies between lines that leave no room in it. Choose a larger region")
            )
    return extra[kept], own[kept]


def _grid(regions, land, low, high, cell):
    """Points of a grid, on the sides of the frame and where there is no polygon, and their regions."""
    along = [
        np.linspace(low[axis], high[axis], max(round((high - low)[axis] / cell), 1) + 1) for axis in (0, 1)
    ]
    grid = np.stack(np.meshgrid(*along, indexing="ij"), axis=-1).reshape(-1, 2)
    grid = grid[~((grid == low) | (grid == high)).all(axis=1)]
    on_side = ((grid == low) | (grid == high)).any(axis=1)
    kept = on_side | ~_on_land(land, grid)
    grid, on_side = grid[kept], on_side[kept]
    own = np.full(len(grid), -1)
    for g, region in enumerate(regions):
        own[_inside(region, grid) & ~on_side] = g
    return grid, own


def _outlines(region, vertices, land, low, high):
    """Points on the outlines of a region in the frame, and how far apart they are, for each of its parts."""
    seen = shapely.get_parts(shapely.intersection(region, shapely.box(*low, *high)))
    # where the map's own vertices tell the region well, its polygons get no others
    hull = shapely.area(shapely.convex_hull(shapely.multipoints(vertices)))
    told = hull > shapely.area(seen).sum() / 4.0
    for part in seen[shapely.area(seen) > 0.0]:
        step = shapely.length(part) / SIDES
        ring = np.unique(shapely.get_coordinates(shapely.segmentize(part, step)), axis=0)
        # not on one line, or the triangles between them would be flat
        ring += np.random.default_rng(1).uniform(-0.05, 0.05, ring.shape) * step
        ring = ring[((ring > low + 1e-9) & (ring < high - 1e-9)).all(axis=1)]
        yield ring[~_on_land(land, ring)] if told else ring, step


def _on_land(land, points):
    """Which points lie in a polygon."""
    found = np.zeros(len(points), dtype=bool)
    # the tree is of the points: what is asked for is what shapely prepares, and polygons are the larger
    found[shapely.STRtree(shapely.points(points)).query(land, predicate="intersects")[1]] = True
    return found


def _roomy(points, noded, least):
    """Which points are far enough from the map."""
    from scipy.spatial import cKDTree

    free = cKDTree(noded.xy).query(points)[0] > least
    if len(noded.edges):
        lines = shapely.STRtree(shapely.linestrings(noded.xy[noded.edges]))
        near = np.flatnonzero(free)
        hit = lines.query(shapely.points(points[near]), predicate="dwithin", distance=least[near])[0]
        free[near[hit]] = False
    return free


def _apart(points, least, group):
    """Of points, those of the focus, and others that are not close to these."""
    from scipy.spatial import cKDTree

    focus = group >= 0
    if not focus.any() or focus.all():
        return np.arange(len(points))
    far = cKDTree(points[focus]).query(points)[0] > least
    return np.flatnonzero(focus | far)


def _land(rows, starts, polygons):
    """The polygons of the map, mended where they are not valid."""
    made = []
    for lines in polygons:
        rings = [_ring(rows, starts, k) for k in lines if starts[k + 1] - starts[k] >= 4]
        if rings:
            made.append(shapely.polygons(rings[0], np.array(rings[1:], dtype=object) if rings[1:] else None))
    made = np.array(made, dtype=object)
    wrong = ~shapely.is_valid(made)
    made[wrong] = shapely.make_valid(made[wrong])
    return made


def _ring(rows, starts, k):
    return shapely.linearrings(rows[starts[k] : starts[k + 1]])


def _covered(mesh, land, check):
    """Which triangles lie in a polygon of the map."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    t, n = len(mesh.triangles), len(mesh.xy)
    if not len(land):
        return np.zeros(t, dtype=bool)
    ends = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    key = ends[:, 0] * n + ends[:, 1]
    order = np.argsort(key, kind="stable")
    twin = np.flatnonzero(key[order][1:] == key[order][:-1])
    twin = twin[~np.isin(key[order][twin], mesh.edges @ (n, 1))]
    one, other = order[twin] // 3, order[twin + 1] // 3
    check()
    face = connected_components(coo_matrix((np.ones(len(one)), (one, other)), (t, t)), directed=False)[1]
    a, b, c = mesh.xy[mesh.triangles].transpose(1, 0, 2)
    by_size = np.argsort(cross(b - a, c - a))
    largest = np.empty(face.max() + 1, dtype=np.int64)
    largest[face[by_size]] = by_size
    middle = mesh.xy[mesh.triangles[largest]].mean(axis=1)
    return _on_land(land, middle)[face]


def _row_splits(noded, graph, starts):
    """Where rows have a vertex put in after them: the row, the vertex, the share of the way."""
    nothing = np.empty((0, 3))
    if not len(noded.splits):
        return nothing
    n = len(noded.xy)
    inside = np.ones(len(graph.vertex), dtype=bool)
    inside[starts[1:][starts[1:] > 0] - 1] = False
    row = np.flatnonzero(inside)
    u, v = graph.vertex[row], graph.vertex[row + 1]
    key = np.minimum(u, v) * n + np.maximum(u, v)
    wanted = noded.splits[:, 0] * n + noded.splits[:, 1]
    order = np.argsort(wanted, kind="stable")
    lo = np.searchsorted(wanted, key, side="left", sorter=order)
    hi = np.searchsorted(wanted, key, side="right", sorter=order)
    count = hi - lo
    row, u, v, lo = row[count > 0], u[count > 0], v[count > 0], lo[count > 0]
    count = count[count > 0]
    which = np.repeat(np.arange(len(row)), count)
    place = np.repeat(lo, count) + np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    vertex = noded.splits[order[place], 2]
    start, along = noded.xy[u[which]], noded.xy[v[which]] - noded.xy[u[which]]
    t = ((noded.xy[vertex] - start) * along).sum(axis=1) / (along * along).sum(axis=1)
    result = np.column_stack((row[which], vertex, t))
    return result[np.lexsort((t, row[which]))]


def _solved(mesh, coarse, land, solid, asked, check):
    """The shift of the coarse vertices, the edges that join islands, and the growth of the frame."""
    n = len(mesh.xy)
    kept, inverse = np.unique(coarse.triangles, return_inverse=True)
    place = np.full(n, -1)
    place[kept] = np.arange(len(kept))
    spare = place[mesh.spare]
    # where no corner went, the triangles around are what they were, and so are the others there
    triangles = np.concatenate((inverse.reshape(-1, 3), spare[(spare >= 0).all(axis=1)]))
    xy, group = mesh.xy[kept], mesh.group[kept]
    lines = place[solid]
    used = np.unique(lines)
    used = np.union1d(used, place[np.flatnonzero(mesh.map_vertex & (place >= 0))])
    back = np.full(len(kept), -1)
    back[used] = np.arange(len(used))
    bridges = used[joins(xy[used], back[lines], asked.tau)]
    links = unique_pairs(np.concatenate((lines, bridges)), len(kept))
    origin = np.array(
        [xy[group == g].mean(axis=0) if (group == g).any() else (0.0, 0.0) for g in range(group.max() + 1)]
    )
    side = [place[one] for one in mesh.side]
    side = [one[one >= 0] for one in side]
    size = _frame(mesh, xy, links, group, origin, asked.scale, asked.frame, asked.growth)
    fixed = []
    for axis in (0, 1):
        width = np.ptp(xy[:, axis])
        more = (size[axis] - 1.0) * (width - 2.0 * mesh.padded[axis]) / 2.0 - mesh.padded[axis]
        fixed += [(axis, side[2 * axis], -more), (axis, side[2 * axis + 1], more)]
    stiff = np.where(_on_land(land, xy[triangles].mean(axis=1)), LAND, 1.0)
    moved, reached = relax(xy, triangles, links, group, origin, asked.scale, fixed, check, stiff=stiff)
    if reached < 1.0:
        room = 1.0 + reached * (asked.scale - 1.0)
        tight = Sentence(
            "there is no room for a scale of {:.10g}: it ends at {:g}. "
            "Choose a smaller scale, a larger map around the region, or let the map grow",
            asked.scale, math.floor(room * 100) / 100,
        )  # fmt: skip
        raise NoRoom(tight)
    shift = np.zeros((n, 2))
    shift[kept] = moved
    return shift, kept[bridges], size


def _regions(focus):
    """The parts of the focus; those that touch each other are one, as they have to move together."""
    if focus is None or shapely.is_empty(focus):
        raise Unsolvable(Sentence("the focus is empty"))
    parts = shapely.get_parts(shapely.union_all(shapely.get_parts(shapely.make_valid(focus))))
    parts = parts[shapely.area(parts) > 0.0]
    if not len(parts):
        raise Unsolvable(Sentence("the focus has no area"))
    touching = np.stack(shapely.STRtree(parts).query(parts, predicate="intersects"), axis=1)
    whole = components(len(parts), touching)
    return [shapely.multipolygons(parts[whole == k]) for k in range(whole.max() + 1)]


def _refuse_outlier(rows, starts, unit):
    """Complain if the map is so wide that most of its lines are no longer than a point in it."""
    begin = starts[:-1][np.diff(starts) > 0]
    length = (np.maximum.reduceat(rows, begin) - np.minimum.reduceat(rows, begin)).max(axis=1)
    long = length[length > 0.0] / unit
    if len(long) and np.count_nonzero(long < POINT) * 2 >= len(long):
        _complain_of_outlier(rows, Sentence("most of its lines are no longer than a point"))


def _complain_of_outlier(rows, what):
    x, y = rows[np.argmax(np.abs(rows).max(axis=1))]
    far = Sentence(
        "the map reaches as far as ({:g} {:g}), and compared with that, {}. Is this coordinate right?",
        x,
        y,
        what,
    )
    raise Unsolvable(far)


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
        _complain_of_outlier(rows, Sentence("parts of the focus are one point"))
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
    lines = shapely.linestrings(rows[taken], indices=np.repeat(np.arange(len(long)), np.diff(starts)[long]))
    if shapely.intersects(region, lines).any():
        return True
    for point in shapely.get_coordinates(shapely.point_on_surface(shapely.get_parts(region))):
        for rings in polygons:
            odd = False
            for ring in rings:
                x, y = (rows[starts[ring] : starts[ring + 1]] - point).T
                over = (y[:-1] > 0.0) != (y[1:] > 0.0)
                a, b = np.flatnonzero(over), np.flatnonzero(over) + 1
                cut = x[a] - y[a] * (x[b] - x[a]) / (y[b] - y[a])
                odd ^= bool(np.count_nonzero(cut > 0.0) % 2)
            if odd:
                return True
    return False


def _groups(graph, rows, starts, polygons, regions):
    """The region of each vertex (-1: none), and the regions that touch the map."""
    used, group = [], np.full(len(graph.xy), -1)
    for region in regions:
        mine = _inside(region, graph.xy)
        if mine.any() or _meets(region, rows, starts, polygons):
            group[mine] = len(used)
            used.append(region)
    if not used:
        nothing = Sentence(
            "the focus touches nothing: no vertex, line or polygon of the input lies in it. "
            "Are the CRS of both layers right?"
        )
        raise Unsolvable(nothing)
    return group, used


def _frame(mesh, xy, links, group, origin, scale, frame, growth):
    """How many times as wide and high the frame becomes."""
    width = np.ptp(xy, axis=0) - 2.0 * mesh.padded
    place = np.flatnonzero(np.bincount(links.ravel(), minlength=len(xy)) > 0)
    wanted = np.ones(2)
    if frame:
        # a ring of radii f and 1 goes to one of f scale and g: its modulus, ln(1 / f), becomes
        # ln(g / (f scale)), and no map of rings bends less than the quotient (Groetzsch)
        wanted *= scale * _share(xy, group, width) ** (1.0 - 1.0 / DILATATION)
    elif len(place):
        # as wide as it would like to be if its outermost points kept their scale
        ends = np.concatenate(
            [[place[xy[place, axis].argmin()], place[xy[place, axis].argmax()]] for axis in (0, 1)]
        )
        first = np.flatnonzero(group >= 0)[0]
        fixed = [(axis, np.array([first]), 0.0) for axis in (0, 1)]
        free = xy + unbounded(xy, links, group, origin, scale, fixed, ends)
        before, after = np.ptp(xy[place], axis=0), np.ptp(free[place], axis=0)
        wanted = np.divide(after, before, out=np.ones(2), where=before > 1e-9)
    wanted = np.where(np.isfinite(wanted), wanted, 1.0)
    least = np.ones(2)
    for g in np.unique(group[group >= 0]):
        mine = group == g
        for axis in (0, 1):
            share = scale * np.ptp(xy[mine, axis]) / width[axis]
            touches = [mine[side].any() for side in _sides(xy, axis)]
            least[axis] = max(least[axis], share if all(touches) else share * 1.02)
            if all(touches):
                wanted[axis] = max(share, 1.0) if frame else share
    limit = np.full(2, 1.0 + growth if frame else np.inf)
    if frame:
        wanted = np.clip(wanted, 1.0, limit)
    # a flat map, or a frame beside the region, has room
    wanted = np.maximum(wanted, np.where(least > 1.0, least, 0.0))
    if (wanted > limit * (1.0 + 1e-9)).any():
        largest = math.floor((scale * limit / wanted).min() * 1000.0) / 1000.0
        if (group[place] >= 0).all() and group.max() == 0:
            whole = Sentence(
                "the focus covers all of the input, so nothing can make room for it. Choose a smaller "
                "focus, or let the map grow"
            )
            raise Unsolvable(whole)
        large = Sentence(
            "enlarged {:.10g} times, the focus is larger than the frame, which leaves room for a "
            "scale of {:g}. Choose a smaller scale, or let the map grow",
            scale, largest,
        )  # fmt: skip
        raise Unsolvable(large)
    return wanted


def _share(xy, group, width):
    """How much of the width, or of the height, is in focus: the larger of both."""
    inside = group >= 0
    number = group[inside]
    shares = []
    for axis in (0, 1):
        low, high = np.full(number.max() + 1, np.inf), np.full(number.max() + 1, -np.inf)
        np.minimum.at(low, number, xy[inside, axis])
        np.maximum.at(high, number, xy[inside, axis])
        order = np.argsort(low)
        low, high = low[order], np.maximum.accumulate(high[order])
        covered = np.append(high[0], high[:-1])  # regions beside each other count once
        shares.append(np.maximum(high - np.maximum(low, covered), 0.0)[1:].sum() + high[0] - low[0])
    return float((np.array(shares) / width).max())


def _sides(xy, axis):
    """Vertices on the first and the last side."""
    return (np.flatnonzero(xy[:, axis] == end(xy[:, axis])) for end in (np.min, np.max))


def _selected(coarse, graph, xy, starts, polygons, rule, tau, skipped, check):
    """Relevant edges of all polygons, and of the faces between lines, of what is left of them."""
    if rule == "None":
        return np.empty((0, 2), dtype=np.int64)
    extent = float(np.hypot(*np.ptp(xy, axis=0)))
    chosen = [np.empty((0, 2), dtype=np.int64)]
    vertex = coarse.into[graph.vertex]
    there = np.unique(vertex)

    def add(vertices, offsets, name):
        if offsets[1] < 4:
            return
        try:
            found = select(rule, xy[vertices], offsets, tau, extent, check)
            chosen.append(vertices[found])
        except Unsolvable as reason:
            skipped.append(Sentence("{}: {}", name, reason.sentence))

    def add_shape(shape, name):
        rings = [shapely.get_coordinates(ring)[:-1] for ring in shapely.get_rings(shape)]
        offsets = np.append(0, np.cumsum([len(ring) for ring in rings]))
        place = match(xy[there], np.concatenate(rings))
        if (place >= 0).all():
            add(there[place], offsets, name)

    first = np.append(True, vertex[1:] != vertex[:-1])
    first[starts[:-1][np.diff(starts) > 0]] = True
    left = np.append(0, np.cumsum(first))[starts]
    short = vertex[first]
    for number, lines in enumerate(polygons):
        check(number / len(polygons))
        rings = [short[left[k] : left[k + 1]][:-1] for k in lines]
        if len(rings[0]) < 4:
            continue
        rings = rings[:1] + [ring for ring in rings[1:] if len(ring) > 2]
        vertices = np.concatenate(rings)
        name = Sentence("polygon {}", number + 1)
        if len(np.unique(vertices)) == len(vertices):
            add(vertices, np.append(0, np.cumsum([len(ring) for ring in rings])), name)
            continue
        closed = np.concatenate([np.append(ring, ring[0]) for ring in rings])
        ends = np.append(0, np.cumsum([len(ring) + 1 for ring in rings]))
        shape = _land(xy[closed], ends, [list(range(len(rings)))])[0]
        for part in shapely.get_parts(shapely.get_parts(shape)):
            if shapely.get_type_id(part) == 3:
                add_shape(part, name)
    is_line = np.ones(len(starts) - 1, dtype=bool)
    is_line[[line for lines in polygons for line in lines]] = False
    if is_line.any():
        of_line = np.repeat(is_line, np.diff(left))
        inner = np.ones(len(short) - 1, dtype=bool)
        inner[left[1:-1][(left[1:-1] > 0) & (left[1:-1] < len(short))] - 1] = False
        pairs = np.column_stack((short[:-1], short[1:]))[inner & of_line[:-1]]
        pairs = unique_pairs(pairs, len(xy))
        faces = shapely.get_parts(shapely.polygonize(shapely.linestrings(xy[pairs])))
        for number, face in enumerate(faces):
            check()
            add_shape(face, Sentence("face {} between the lines", number + 1))
    return np.concatenate(chosen)

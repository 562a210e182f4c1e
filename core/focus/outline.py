"""A simplified outline to solve on, and how the detail rides along.

The scale and the place of a coast are smooth along it; its detail need not be solved for. An
*arc* runs between two vertices that must stay; simplified, it keeps some of its vertices, and a
vertex between two of these is carried with the places and scales of both.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from .crossings import crossing_pairs
from .graph import unique_pairs

__all__ = ["Outline", "carry", "simplify"]


class Outline(NamedTuple):
    """What stays of a graph.

    Attributes
    ----------
    kept : (k,) int
        Its vertices, ascending.
    edges : (e, 2) int
        Edges between them.
    rider : (r,) int
        The other vertices.
    ends : (r, 2) int
        The kept vertices before and after each.
    share : (r,) float
        Its place between them along the line, 0 to 1.
    """

    kept: np.ndarray
    edges: np.ndarray
    rider: np.ndarray
    ends: np.ndarray
    share: np.ndarray


def simplify(xy, edges, needed, most, check):
    """Simplify the lines of a graph (Douglas and Peucker) so that none cross that did not before.

    Parameters
    ----------
    xy : (n, 2) float
        Of about size 1.
    edges : (m, 2) int
    needed : (n,) bool
        Vertices that must stay, besides those where lines meet or end.
    most : int
        The number of vertices to aim at, not counting those that stay anyway.
    check : callable
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    Outline
    """
    n = len(xy)
    if n <= most:
        nothing = np.empty(0, dtype=np.int64)
        return Outline(np.arange(n), edges, nothing, nothing.reshape(0, 2), np.empty(0))
    chain, start = _chains(n, edges, needed, xy)
    most += len(np.unique(chain[np.append(start[:-1], start[1:] - 1)]))  # those stay anyway
    tolerance = 1e-4
    while True:
        check()
        place = _simplified(xy, chain, start, tolerance)
        if len(np.unique(chain[place])) <= most or tolerance > 0.01:
            break
        tolerance *= 1.5
    while True:
        # where straight lines cross that did not before, halve them
        check()
        first = place[_pieces(place, start)]
        last = place[_pieces(place, start) + 1]
        coarse = last - first > 1
        pairs = crossing_pairs(xy, np.column_stack((chain[first], chain[last])))
        bad = np.unique(pairs[coarse[pairs].any(axis=1)])
        bad = bad[coarse[bad]]
        if not len(bad):
            break
        place = np.union1d(place, (first[bad] + last[bad]) // 2)
    is_kept = np.zeros(len(chain), dtype=bool)
    is_kept[place] = True
    rider = np.flatnonzero(~is_kept)
    after = np.searchsorted(place, rider)
    before, after = place[after - 1], place[after]
    step = np.hypot(*np.diff(xy[chain], axis=0, prepend=xy[chain[:1]]).T)
    along = np.cumsum(step)
    share = (along[rider] - along[before]) / np.maximum(along[after] - along[before], 1e-300)
    piece = _pieces(place, start)
    lines = np.column_stack((chain[place[piece]], chain[place[piece + 1]]))
    return Outline(
        kept=np.unique(chain[place]),
        edges=unique_pairs(lines, n),
        rider=chain[rider],
        ends=np.column_stack((chain[before], chain[after])),
        share=share,
    )


def carry(outline, before, after, s):
    """Return all vertices, the detail carried along.

    Without rotation, as everything here: x' = m' + s (x - m), where m is the place on the straight
    line between the kept vertices around x, m' the place on that line after, and s the local scale
    there.

    Parameters
    ----------
    outline : Outline
    before : (n, 2) float
        All vertices.
    after : (n, 2) float
        Those that are kept count.
    s : (n,) float
        Likewise.

    Returns
    -------
    (n, 2) float
    """
    after = after.copy()
    a, b = outline.ends.T
    share = outline.share[:, None]
    m = before[a] + share * (before[b] - before[a])
    m_after = after[a] + share * (after[b] - after[a])
    scale = s[a] + outline.share * (s[b] - s[a])
    after[outline.rider] = m_after + scale[:, None] * (before[outline.rider] - m)
    return after


def _chains(n, edges, needed, xy):
    """Vertices of all arcs one after the other, and where each starts."""
    degree = np.bincount(edges.ravel(), minlength=n)
    stop = needed | (degree != 2)
    # neighbours of each vertex, one after the other
    ends = np.concatenate((edges, edges[:, ::-1]))
    ends = ends[np.argsort(ends[:, 0], kind="stable")]
    first = np.searchsorted(ends[:, 0], np.arange(n + 1)).tolist()
    beside = ends[:, 1].tolist()
    stops = stop.tolist()
    seen = np.zeros(n, dtype=bool).tolist()
    chains = []

    def walk(u, v):
        chain = [u, v]
        while not stops[v]:
            seen[v] = True
            a, b = beside[first[v]], beside[first[v] + 1]
            u, v = v, (b if a == u else a)
            chain.append(v)
        return chain

    for u in np.flatnonzero(stop).tolist():
        for v in beside[first[u]:first[u + 1]]:
            if stops[v]:
                if u < v:
                    chains.append([u, v])
            elif not seen[v]:
                chains.append(walk(u, v))
    for u in range(n):  # rings that meet nothing: two arcs
        if not seen[u] and not stops[u]:
            stops[u] = True
            ring = walk(u, beside[first[u]])
            far = int(np.argmax(np.hypot(*(xy[ring] - xy[u]).T)))
            seen[u] = True
            chains += [ring[:far + 1], ring[far:]]
    sizes = [len(chain) for chain in chains]
    return np.concatenate(chains), np.append(0, np.cumsum(sizes))


def _pieces(place, start):
    """Which places have their next one on the same arc."""
    return np.flatnonzero(np.diff(np.searchsorted(start, place, side="right")) == 0)


def _simplified(xy, chain, start, tolerance):
    """Places in ``chain`` that stay, ascending."""
    number = np.repeat(np.arange(len(start) - 1), np.diff(start))
    lines = shapely.linestrings(xy[chain], indices=number)
    lines = shapely.simplify(lines, tolerance, preserve_topology=False)
    points, which = shapely.get_coordinates(lines, return_index=True)
    # the vertices that stay, in order: match them one by one
    key = np.ascontiguousarray(xy[chain]).view(np.complex128).ravel()
    stay = np.ascontiguousarray(points).view(np.complex128).ravel()
    vertex, inverse = np.unique(key, return_inverse=True)
    code = inverse.ravel() + number * len(vertex)
    wanted = np.searchsorted(vertex, stay) + which * len(vertex)
    keep = np.isin(code, wanted)
    keep[start[:-1]] = keep[start[1:] - 1] = True
    return np.flatnonzero(keep)

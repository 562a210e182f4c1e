"""From the map of least distortion to one without crossings, inside its frame."""

from __future__ import annotations

import numpy as np

from .crossings import crossing_pairs, separations, turned, upright
from .deformation import NO_BOUNDS, Bounds, repair_program

__all__ = ["last_good", "new_crossings", "repair", "settle"]

STEPS = 80  # contacts to resolve one after the other, before giving up
ROUNDS = 15  # of repairs; a more detailed outline is the next thing to try
FEW = 200  # bounds, and pairs, of a repair
AT_ONCE = 20  # bounds; most of the others are kept as well then
GAP = 0.1  # of the way between two lines at their contact, what must stay
NEAR = 3e-9  # what counts as kept: a little more than the precision of the program
MANY = 3000  # bounds, before giving up
INSET = 1e-6  # how far inside the frame a vertex is put that left it


def new_crossings(xy, edges, known, moved=None):
    """Return the pairs of edges that meet and are not among the ``known`` keys; see `pair_keys`."""
    pairs = crossing_pairs(xy, edges, moved)
    return pairs[~np.isin(pair_keys(pairs, len(edges)), known)]


def pair_keys(pairs, m):
    """Return a number for each pair of m edges."""
    return pairs[:, 0] * m + pairs[:, 1]


def settle(program, edges, known, triangles, box, check):
    """Add bounds to a program until no edges cross, no triangle is turned, and all is in the box.

    From the input to the map with crossings the vertices go straight ahead. Where the first edges
    meet on this way they are kept apart, and what then is the least distortion is aimed at anew,
    from just before the contact.

    Parameters
    ----------
    program : Program
        Without bounds; its start has no crossings but the known ones.
    edges : (m, 2) int
        The edges that must not cross.
    known : (k,) int
        Keys of the pairs that cross in the input.
    triangles : (t, 3) int
        Those that must not turn over; see `crossings.cycles`.
    box : ((2,) float, (2,) float) or None
    check : callable
        Called with the share done; may raise `Cancelled`.

    Returns
    -------
    xy, s : (n, 2) float, (n,) float
        Positions and local scales.
    problem : str
        Why this is not without crossings and in the box, or ''.

    Notes
    -----
    Each bound is one solution with the factorised matrix, each contact a few tests for crossings.
    """
    good = program.start
    waiting, used = NO_BOUNDS, np.zeros(0, dtype=bool)
    for step in range(STEPS):
        check(step / STEPS)
        while True:
            xy = program.xy
            more = _outside(xy, box)
            excess = waiting.excess(xy)
            broken = np.flatnonzero((excess < -NEAR) & ~used)
            broken = broken[np.argsort(excess[broken], kind="stable")][:AT_ONCE]
            used[broken] = True
            more = more.joined(waiting.where(broken))
            if not len(more.p):
                break
            check()
            if len(program.bounds.p) > MANY or not program.add(more):
                return program.xy, program.s, "there is not enough room"
        pairs, flips = new_crossings(xy, edges, known), turned(program.start, xy, triangles)
        if not len(pairs) and not len(flips):
            return xy, program.s, ""
        clear, blocked = 0.0, 1.0
        for halving in range(8):
            if halving >= 2 and clear > 0.0:
                break
            middle = (clear + blocked) / 2.0
            between = good + middle * (xy - good)
            found = new_crossings(between, edges, known), turned(program.start, between, triangles)
            if len(found[0]) or len(found[1]):
                blocked, (pairs, flips) = middle, found
            else:
                clear = middle
        good = good + clear * (xy - good)
        more = separations(good, edges, pairs, GAP).joined(upright(good, flips, GAP))
        waiting = waiting.joined(more)
        used = np.append(used, np.zeros(len(more.p), dtype=bool))
    return program.xy, program.s, f"lines still meet after {STEPS} contacts were resolved"


def repair(xy, carried, edges, known, triangles, fixed, box, check):
    """Move the detail of a map a little where it crosses, turns over or leaves the box.

    Parameters
    ----------
    xy : (n, 2) float
        Positions in the input.
    carried : (n, 2) float
        Positions after, with few crossings.
    edges, known, triangles, box, check
        See `settle`.
    fixed : (n,) bool
        Vertices that stay.

    Returns
    -------
    (n, 2) float
    """
    from scipy.spatial import cKDTree

    tree = None
    radius, pairs, kept = 0.005, np.empty((0, 2), dtype=np.int64), triangles[:0]
    found, flips = new_crossings(carried, edges, known), turned(xy, carried, triangles)
    for step in range(ROUNDS):
        check(step / ROUNDS)
        outside = np.empty(0, dtype=np.int64)
        if box is not None:
            out = np.maximum(box[0] - carried, carried - box[1]).max(axis=1)
            outside = np.flatnonzero(out > NEAR)
        if not len(found) and not len(flips) and not len(outside):
            break
        tree = tree or cKDTree(xy)
        pairs = np.unique(np.concatenate((pairs, found)), axis=0)
        kept = np.unique(np.concatenate((kept, flips)), axis=0)
        if len(pairs) + len(kept) > FEW:
            break
        centres = np.unique(np.concatenate((edges[pairs].ravel(), kept.ravel(), outside)))
        zone = np.zeros(len(xy), dtype=bool)
        for near in tree.query_ball_point(xy[centres], radius):
            zone[near] = True
        zone &= ~fixed
        moving = zone[edges].any(axis=1)
        if not moving.any():
            break
        vertex, local = np.unique(edges[moving], return_inverse=True)
        place = np.full(len(xy), -1)
        place[vertex] = np.arange(len(vertex))
        program = repair_program(
            xy[vertex], carried[vertex], local.reshape(-1, 2), ~zone[vertex]
        )
        bounds = separations(xy, edges, pairs, GAP / 2.0).joined(upright(xy, kept, GAP / 2.0))
        known_here = (place[bounds.p] >= 0) & (place[bounds.q] >= 0)
        bounds = bounds.where(known_here & (zone[bounds.p] | zone[bounds.q]))
        bounds = bounds._replace(p=place[bounds.p], q=place[bounds.q])
        used = np.zeros(len(bounds.p), dtype=bool)
        solved = True
        while solved:
            check()
            excess = bounds.excess(program.xy)
            broken = np.flatnonzero((excess < -NEAR) & ~used)
            broken = broken[np.argsort(excess[broken], kind="stable")][:5 * AT_ONCE]
            used[broken] = True
            more = _outside(program.xy, box, zone[vertex]).joined(bounds.where(broken))
            if not len(more.p):
                break
            solved = len(program.bounds.p) < FEW and program.add(more)
        if solved:
            carried = carried.copy()
            carried[vertex] = program.xy
            at_rest = ~moving[found].any(axis=1)
            found = np.concatenate((found[at_rest], new_crossings(carried, edges, known, moving)))
            flips = turned(xy, carried, triangles)
        radius *= 1.2 if solved else 2.0
        if radius > 2.0:
            break
    return carried


def last_good(xy, after, faulty):
    """Return the last map without faults on the straight way from the input, and the share of it.

    Parameters
    ----------
    xy, after : (n, 2) float
    faulty : callable
        Whether positions have a fault.
    """
    clear, blocked = 0.0, 1.0
    for _ in range(10):
        middle = (clear + blocked) / 2.0
        if faulty(xy + middle * (after - xy)):
            blocked = middle
        else:
            clear = middle
    return xy + clear * (after - xy), clear


def _outside(xy, box, movable=True):
    """A bound for the vertex farthest outside, on each side of the box."""
    more = NO_BOUNDS
    if box is None:
        return more
    for axis in (0, 1):
        for sign, limit in ((1.0, box[0][axis]), (-1.0, box[1][axis])):
            over = np.where(movable, sign * (limit - xy[:, axis]), -np.inf)
            worst = int(np.argmax(over))
            if over[worst] > NEAR:
                normal = np.zeros((1, 2))
                normal[0, axis] = sign
                least = np.array([sign * limit + INSET])
                more = more.joined(Bounds(np.array([worst]), np.array([-1]), normal, least))
    return more

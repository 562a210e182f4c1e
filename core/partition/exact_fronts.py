"""MinWeight on trees as deep as long (corridors, spirals), exactly, one node at a time.

The same Pareto fronts as in `pareto`, with the same sums in the same order, so also the same cuts to the
last tie; but in lists, where a node with short fronts takes microseconds and a level of the tree nothing.
"""

from __future__ import annotations

from array import array
from math import inf
from typing import Callable

import numpy as np

from .min_size import SLACK

__all__ = ["cheapest_by_node"]

MANY = 2000  # pairs of points from which on numpy adds them up faster
NODES = 1 << 16  # nodes between two checks where each takes about a microsecond
STEPS = 20_000  # pairs of points, or so, between two checks


def cheapest_by_node(
    count: np.ndarray,
    trees: int,
    length: np.ndarray,
    base: np.ndarray,
    weight: np.ndarray,
    limit: np.ndarray,
    room: int,
    check: Callable,
) -> tuple[np.ndarray, np.ndarray]:
    """Cheapest assignments of trees whose fronts have at most `room` points.

    Parameters
    ----------
    count : (n,) int
        Number of children of each node. Nodes stand in level order, siblings in the order of their
        parents; the first `trees` nodes are the roots.
    trees : int
    length, base, weight, limit : (n,) float
        Length, summed length of the polygon edges just below, weight, longest path allowed.
    room : int
    check : callable
        Called now and then, mostly with the share done; may raise.

    Returns
    -------
    cost : (trees,) float
        inf for a tree with a longer front.
    cut : (n,) bool
        False in these trees and for the roots.

    Notes
    -----
    MinWeight of section 4.4 of the paper, for any weights, with Pareto fronts. O(n) calls of a loop that
    takes 10 microseconds for a node with few points.

    Examples
    --------
    A root with one diagonal below it, of length 1 and weight 3. Around it, it is 10: too far if 2 is allowed.

    >>> count, weight = np.array([1, 0]), np.array([0.0, 3.0])
    >>> length, base = np.array([9.0, 1.0]), np.array([30.0, 10.0])
    >>> for most in (2.0, 20.0):
    ...     limit = np.array([90.0, most])
    ...     cost, cut = cheapest_by_node(count, 1, length, base, weight, limit, 100, lambda share=0.0: None)
    ...     print(cost.tolist(), cut.tolist())
    [3.0] [False, True]
    [0.0] [False, False]
    """
    outside = _shortest_outside(count, trees, length, base, check)
    columns = [x.tolist() for x in (count, length, base, weight, limit, outside)]
    cost, (paths, begin, self_at) = _fronts(columns, trees, room, check)
    cut = _trace(columns[0], cost, paths, begin, self_at, check)
    return np.array(cost), cut


def _shortest_outside(count, trees, length, base, check):
    """As in `min_weight`, one node at a time."""
    n = len(count)
    count, length, face = count.tolist(), length.tolist(), base.tolist()
    offer, outside = [0.0] * n, [inf] * n
    end = n
    for e in range(n - 1, -1, -1):
        if e % NODES == 0:
            check()
        total = 0.0  # not by sum(): it rounds in another way from Python 3.12 on
        for c in range(end - count[e], end):
            total += offer[c]
        end -= count[e]
        face[e] += total
        offer[e] = min(length[e], face[e])
    end = trees
    for e in range(n):
        if e % NODES == 0:
            check()
        beyond = min(length[e], outside[e])
        for c in range(end, end + count[e]):
            outside[c] = face[e] - offer[c] + beyond
        end += count[e]
    return np.array(outside) * (1 - SLACK)


def _fronts(columns, trees, room, check):
    """Costs of the roots, and the way back.

    The way back: for every point of every node, the points of its children, one after the other; where
    those of a node begin; and which of its points is SELF (-1 if none).
    """
    count, length, base, weight, limit, outside = columns
    end = n = len(count)
    fronts = [None] * n
    paths, begin, self_at = array("i"), [0] * n, [-1] * n
    steps = 0
    for e in range(n - 1, -1, -1):
        end -= count[e]
        below = fronts[end : end + count[e]]
        if None in below:
            continue  # a front was too long
        for child in range(end, end + count[e]):
            fronts[child] = None
        steps += 10 + max(map(_size, below), default=0)
        if steps > STEPS:
            steps = 0
            check(1.0 - e / n)
        sums = _add_children(below, base[e], weight[e], limit[e], min(length[e], outside[e]), room)
        if sums is None:
            continue
        begin[e] = len(paths)
        offer, demand, self_at[e], sources = _close(
            *sums[:2], length[e], weight[e], limit[e], outside[e], e < trees
        )
        paths.extend(_points_below(sources, count[e], sums[2]))
        if len(offer) <= room and len(demand) <= room:
            fronts[e] = offer, demand
    cost = [inf if front is None else front[0][0][0] for front in fronts[:trees]]
    return cost, (paths, begin, self_at)


def _points_below(sources, count, ways):
    """The points of the children below each of some sums, one after the other."""
    if count == 1:
        return [point[2] for point in sources]
    if count == 2:
        return [k for point in sources for k in point[2:]]
    if not count:
        return ()
    left, right = ways
    return [k for point in sources for k in left[point[2]] + right[point[3]]]


def _size(front):
    return len(front[0]) + len(front[1])


def _add_children(fronts, base, weight, limit, reach, room):
    """Useful sums over the children, in rounds of pairs: offers, demands, and where more than two
    children were added up, the points of the children below the last left and right points.

    Each sum is (weight, value, left point, right point). None if a front on the way is too long.
    """
    if not fronts:
        return [(0.0, base, 0, 0)], [], None
    if len(fronts) == 1:  # most nodes of deep trees
        return _only_child(*fronts[0], base, weight, limit, reach)
    ways = [[(k,) for k in range(_size(front))] for front in fronts] if len(fronts) > 2 else None
    while len(fronts) > 2:
        halved = _in_pairs(fronts, ways, base, reach, room)
        if halved is None:
            return None
        (fronts, ways), base = halved, 0.0
    left, right = fronts
    least = left[0][0][0] + right[0][0][0]
    offer, demand = _add(*left, *right, base, least, least + weight, limit, reach)
    return offer, demand, ways


def _only_child(offer, demand, base, weight, limit, reach):
    """The useful points of the front of an only child, as sums."""
    least = offer[0][0]
    return (
        _front([
            (w, v + base, i, 0)
            for i, (w, v) in enumerate(offer)
            if not i or w < least + weight and v + base <= limit
        ]),
        _front([
            (w, v + base, i, 0)
            for i, (w, v) in enumerate(demand, len(offer))
            if w < least and v + base <= -reach
        ]),
        None,
    )  # fmt: skip


def _in_pairs(fronts, ways, base, reach, room):
    """Half as many fronts, each of two added up, and the points below; None if one is too long.

    The first pair has the base.
    """
    joined, joined_ways = [], []
    for k in range(0, len(fronts) - 1, 2):
        offer, demand = _add(*fronts[k], *fronts[k + 1], base, inf, inf, inf, reach)
        if len(offer) > room or len(demand) > room:
            return None
        left, right = ways[k : k + 2]
        joined.append(([p[:2] for p in offer], [p[:2] for p in demand]))
        joined_ways.append([left[i] + right[j] for _, _, i, j in offer + demand])
        base = 0.0
    odd = len(fronts) & ~1
    return joined + fronts[odd:], joined_ways + ways[odd:]


def _add(left_offer, left_demand, right_offer, right_demand, base, least, dear, limit, reach):
    """Pareto fronts of the sums of the points of two edges; see `min_weight._Pass._product`.

    Offers are useful below the weight `dear` and within the limit, the cheapest always; demands below
    the weight `least`, if what they allow covers the reach.
    """
    offer = _sums(left_offer, right_offer, 0, 0, base, dear, limit)
    if not offer or offer[0][2:] != (0, 0):
        (left_weight, left_value), (weight, value) = left_offer[0], right_offer[0]
        offer.insert(0, (left_weight + weight, left_value + base + value, 0, 0))
    demand = []
    if right_demand:
        demand += _sums(left_offer, right_demand, 0, len(right_offer), base, least, -reach)
    if left_demand:
        demand += _sums(left_demand, right_offer, len(left_offer), 0, base, least, -reach)
    return _front(offer), _front(demand)


def _sums(left, right, i, j, base, weight_cap, value_cap):
    """Sums (weight, value, left point, right point) below the caps, by their points."""
    if len(left) * len(right) > MANY:
        return _many_sums(left, right, i, j, base, weight_cap, value_cap)
    sums = []
    for at, (left_weight, left_value) in enumerate(left, i):
        left_value += base
        for partner, (weight, value) in enumerate(right, j):
            weight += left_weight
            if weight >= weight_cap:
                break  # so do all that follow
            value += left_value
            if value <= value_cap:
                sums.append((weight, value, at, partner))
    return sums


def _many_sums(left, right, i, j, base, weight_cap, value_cap):
    """The same without dominated ones, still by their points."""
    left_weight, left_value = np.array(left).T
    right_weight, right_value = np.array(right).T
    weight = left_weight[:, None] + right_weight
    value = (left_value + base)[:, None] + right_value
    at, partner = np.nonzero((weight < weight_cap) & (value <= value_cap))
    weight, value = weight[at, partner], value[at, partner]
    order = np.lexsort((value, weight))
    best = np.minimum.accumulate(value[order])
    order = np.sort(order[np.diff(best, prepend=inf) < 0])
    columns = weight[order], value[order], at[order] + i, partner[order] + j
    return list(zip(*(x.tolist() for x in columns)))


def _front(sums):
    """The sums that no other dominates; of equal ones the first."""
    if len(sums) < 2:
        return sums
    sums.sort()
    best, front = inf, []
    for point in sums:
        if point[1] < best:
            best = point[1]
            front.append(point)
    return front


def _close(offer, demand, length, weight, limit, outside, root):
    """Fronts of a node from the sums below; see `min_weight._Pass._close`.

    Returns its offers, its demands, which of them is SELF, and the sums below all of them.
    """
    below = _below_self(offer, demand, length)
    own = below[0] + weight
    if root:
        return [(own, length)], [], 0, [below]

    sources = [point for point in offer if point[1] <= limit and point[0] < own]
    offers = [point[:2] for point in sources]
    cap = min(offers[0][0], own) if offers else own
    self_at = -1
    if not offers or offers[-1][1] > length:
        self_at = len(offers)
        offers.append((own, length))
        sources.append(below)

    demands = _demands(demand, offer[0], cap, limit, outside, sources)
    return offers, demands, self_at, sources


def _below_self(offer, demand, length):
    """The cheapest sum below a node that is SELF: an offer, or a demand that its length serves."""
    cheapest = offer[0]
    for point in demand:
        if point[1] <= -length:
            return point if point[0] < cheapest[0] else cheapest
    return cheapest


def _demands(demand, cheapest, cap, limit, outside, sources):
    """The demands of a node that cost less than the cap; adds the sums below them to the sources."""
    demands, most = [], 0.0
    for point in demand:
        if point[0] >= cap:
            break
        if point[1] <= -outside:
            value = max(point[1], -limit)
            if not demands or value < most:
                demands.append((point[0], value))
                sources.append(point)
                most = value
    if cheapest[0] < cap and most > -limit and limit >= outside:
        demands.append((cheapest[0], -limit))
        sources.append(cheapest)
    return demands


def _trace(count, cost, paths, begin, self_at, check):
    """Selected edges of the cheapest assignment of each root."""
    n, trees = len(count), len(cost)
    point = [0 if c < inf else -1 for c in cost] + [-1] * (n - trees)
    cut = np.zeros(n, bool)
    end = trees
    for e in range(n):
        if e % NODES == 0:
            check()
        if point[e] >= 0:
            cut[e] = point[e] == self_at[e]
            at = begin[e] + point[e] * count[e]
            point[end : end + count[e]] = paths[at : at + count[e]]
        end += count[e]
    cut[:trees] = False
    return cut

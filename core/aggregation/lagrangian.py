"""A lower bound by Lagrangian relaxation: every core by itself, as a minimum cut.

That each area has exactly one core is priced: area v pays back ``lam[v]``. Then the cores are independent.
The best region of a core is a set of areas that contains it: what they cost, less what they pay back, and
half of the boundary, as both sides of a boundary pay for it. Without further conditions that is a minimum
cut. That the region is large enough has a price for each core, too, and so has its contiguity: where the
cut gives a core areas that are apart from it, these pay what they gain to the areas that would connect them
(the cuts of Oehrlein and Haunert 2017, by dual ascent).

All prices are improved together. Those of the areas follow the subgradient, in steps of Polyak; those of a
core are raised a few times in each round, and kept a little smaller for the next one, so that what is out
of date fades. Any prices give a bound that holds.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .instance import connected_parts, enough

if TYPE_CHECKING:
    from .exact import _Part

__all__ = ["Bound", "facing", "lagrangian"]

UNITS = 4e8  # capacities are whole numbers of 32 bits; all of them together are so many
STEPS = 3  # cuts for each core and round
FADE = 0.97  # what is left of a core's prices in the next round
PATIENCE, SHORTER = 8, 0.8  # rounds without a better bound until the steps get shorter, and how much
LEAST_GAIN = 1e-5  # of the cost, by which a bound is better
FIRST_STEP, LAST_STEP = 0.4, 0.02  # length of the steps, as shares of Polyak's
MOMENTUM = 0.6
LAST_CUTS = 12  # for each core in the end, to see which are in no better solution


class Bound(NamedTuple):
    """What the relaxation tells.

    Attributes
    ----------
    value : float
        No solution costs less.
    far : (k,) bool
        Cores that are in no solution cheaper than the one known.
    rounds : int
    """

    value: float
    far: np.ndarray
    rounds: int


class _Prices(NamedTuple):
    """Prices of one core: what its areas pay for contiguity, and of a missing square metre."""

    paid: np.ndarray
    lack: float


def facing(adjacent: list[list[int]], u: int, around: set[int]) -> set[int]:
    """Those of all areas around a part that are reached from u: who is in the part comes through them.

    They separate it from u, which is none of them, as in the cuts of Oehrlein and Haunert (2017).

    Examples
    --------
    Five areas in a row: who is in the part {3} and comes from the first one comes through the third.

    >>> facing([[1], [0, 2], [1, 3], [2, 4], [3]], 0, around={2, 4})
    {2}
    """
    reached, stack, found = {u}, [u], set()
    while stack:
        for s in adjacent[stack.pop()]:
            if s in around:
                found.add(s)
            elif s not in reached:
                reached.add(s)
                stack.append(s)
    return found


def lagrangian(part: _Part, until: float, check: Callable) -> Bound:
    """Return a lower bound for a part of a map, where the boundary between all regions costs.

    Parameters
    ----------
    part : _Part
        Its solution ``chosen`` tells how far the prices have to go.
    until : float
        By `time.perf_counter`.
    check : callable
        Called with None now and then; may raise to stop.

    Returns
    -------
    Bound

    Notes
    -----
    Prices of contiguity stand for the cuts of Oehrlein and Haunert (2017).

    A round is a few minimum cuts for each core, about a millisecond each for 150 areas. After 100 to 200
    rounds the bound hardly rises any more.

    Examples
    --------
    Two areas of 3 and two small ones between them, in a row; a region needs a size of 4. The solution
    known costs 3, the best one 1: where the bound ends.

    >>> from isthmus.core.aggregation.exact import _Part, require_highs
    >>> from isthmus.core.aggregation.greedy import greedy
    >>> from isthmus.core.aggregation.instance import build
    >>> row = [[0, 1], [1, 2], [2, 3]]
    >>> problem = build([3, 1, 1, 3], [0, 0, 0, 1], range(4), row, np.ones(3), 1 - np.eye(2), [4.0, 4.0])
    >>> none, tools = np.zeros(4, dtype=bool), require_highs()
    >>> part = _Part(problem, np.arange(4), none, greedy(problem), tools)
    >>> bound = lagrangian(part, perf_counter() + 9.0, lambda share: None)
    >>> round(float(bound.value), 1)
    1.0
    """
    network = _Network(part)
    n, k, free = len(part.areas), len(part.own), part.own < part.free
    most, best = int(part._most()), part._cost_of(part.chosen)
    fair = _fair(part, network)
    # an area that costs nothing now must be able to move its price, too
    scale = np.maximum(fair, 0.2 * best / part.size.sum() * part.size)
    lam, step, along, fails, rounds = 0.8 * fair, FIRST_STEP, np.zeros(n), 0, 0
    prices = [_Prices(np.zeros(n), 0.0) for _ in range(k)]
    value, kept = -np.inf, (lam, prices)
    least, region = np.zeros(k), np.zeros((k, n))
    while step > LAST_STEP and value < best * (1.0 - 1e-9):
        for j in range(k):
            if perf_counter() > until:
                return Bound(value, np.zeros(k, dtype=bool), rounds)
            faded = _Prices(FADE * prices[j].paid, FADE * prices[j].lack)
            least[j], region[j], prices[j] = network.ascend(j, lam, faded, STEPS, 0.0)
        check(None)
        rounds += 1
        chosen = _chosen(least, free, most)
        now = float(lam.sum() + least[chosen].sum())
        fails = 0 if now > value + LEAST_GAIN * best else fails + 1
        if now > value:
            value, kept = now, (lam, list(prices))
        if fails == PATIENCE:
            step, fails, (lam, prices) = step * SHORTER, 0, (kept[0], list(kept[1]))
        surplus = 1.0 - region[chosen].sum(axis=0)
        along = MOMENTUM * along + surplus
        length = step * (best - now) / max(float(surplus**2 @ scale), 1e-300)
        lam = lam + min(length, 0.3) * scale * along
    lam, prices = kept
    for j in range(k):
        if perf_counter() > until:
            return Bound(value, np.zeros(k, dtype=bool), rounds)
        least[j] = network.ascend(j, lam, prices[j], LAST_CUTS, best - value)[0]
    chosen = _chosen(least, free, most)
    now = float(lam.sum() + least[chosen].sum())
    # with a core that was not chosen there is room for one less of the others
    room = least[chosen & free].max(initial=-np.inf) if (chosen & free).sum() == most else 0.0
    far = free & ~chosen & (now - min(room, 0.0) + least > best * (1.0 + 1e-7))
    return Bound(max(value, now), far, rounds)


def _chosen(least, free, most):
    """Fixed cores, and those that save something, as many as there is room for: (k,) bool."""
    chosen = ~free
    order = np.argsort(np.where(free, least, np.inf), kind="stable")[:most]
    chosen[order[(least[order] < 0.0) & free[order]]] = True
    return chosen


def _fair(part, network):
    """What each area costs in the solution known, with half of the boundaries between regions."""
    n, chosen = len(part.areas), part.chosen
    price = np.where(np.arange(n) < part.free, part.cost[np.arange(n), chosen], 0.0)
    apart = chosen[part.a] != chosen[part.b]
    for end in (part.a, part.b):
        np.add.at(price, end[apart], network.half[apart])
    return price


class _Network:
    """The graph of the minimum cuts: areas, a source (what is in the region) and a sink.

    Its arcs are always the same, and sorted once.
    """

    def __init__(self, part):
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import breadth_first_order, maximum_flow

        self.part, self.tools = part, (csr_matrix, maximum_flow, breadth_first_order)
        self.n, self.half = len(part.areas), 0.5 * part.price
        n, v = self.n, np.arange(self.n)
        source, sink = np.full(n, n), np.full(n, n + 1)
        tail = np.concatenate((part.a, part.b, source, v, v, sink))
        head = np.concatenate((part.b, part.a, v, sink, source, v))
        order = np.lexsort((head, tail))
        self.place = np.argsort(order)
        self.indices = head[order].astype(np.int32)
        self.indptr = np.searchsorted(tail[order], np.arange(n + 3)).astype(np.int32)

    def cut(self, weight, inside, outside):
        """The set of least weight and half boundary: its areas, and a lower bound of what it costs."""
        csr_matrix, maximum_flow, breadth_first_order = self.tools
        n, m = self.n, len(self.half)
        open_ = ~(inside | outside)
        unit = UNITS / max(np.abs(weight[open_]).sum() + 2.0 * self.half.sum(), 1e-290)  # finite, too
        # rounded down, so that the flow is a lower bound
        edge = np.floor(self.half * unit)
        gain = np.where(open_, np.floor(np.maximum(-weight, 0.0) * unit), np.where(inside, UNITS, 0.0))
        loss = np.where(open_, np.floor(np.maximum(weight, 0.0) * unit), np.where(outside, UNITS, 0.0))
        capacity = np.zeros(len(self.place), dtype=np.int32)
        capacity[self.place[: 2 * m + 2 * n]] = np.concatenate((edge, edge, gain, loss))
        graph = csr_matrix((capacity, self.indices, self.indptr), shape=(n + 2, n + 2))
        found = maximum_flow(graph, n, n + 1)
        rest = graph - (found.flow if hasattr(found, "flow") else found.residual)  # scipy 1.9: residual
        rest.eliminate_zeros()
        chosen = np.zeros(n + 2, dtype=bool)
        chosen[breadth_first_order(rest, n, return_predecessors=False)] = True
        least = np.minimum(weight[open_], 0.0).sum() + weight[inside].sum() + found.flow_value / unit
        return chosen[:n], float(least)

    def ascend(self, j, lam, prices, steps, enough_above):
        """Raise the prices of a core; return a lower bound of its region, the areas, and the prices.

        Ends after so many cuts, or where the bound is above ``enough_above``.
        """
        part, n = self.part, self.n
        u = int(part.own[j])
        weight = np.where(np.arange(n) < part.free, part.cost[:, j], 0.0) - lam
        lack = part.theta[j] - part.size[u]
        if enough(part.size[u], part.theta[j]):
            lack = 0.0
        give = np.minimum(part.size, lack)  # no area gives more than all that the core lacks
        give[u] = 0.0
        typical = float(np.median(np.abs(weight) / part.size)) if lack else 0.0
        inside, outside = np.zeros(n, dtype=bool), np.arange(n) >= part.free
        inside[u], outside[u] = True, False
        best, state, step = -np.inf, None, 1.0
        for _ in range(steps):
            paid, per_lack = prices
            now = weight + paid - per_lack * give
            areas, least = self.cut(now, inside, outside)
            least += per_lack * lack * (1.0 - 1e-11)
            if least > best:
                best, state, step = least, (prices, now, areas), min(1.0, 1.5 * step)
            else:
                step *= 0.5
            if best > enough_above:
                break
            prices, now, areas = state
            prices, changed = self._raised(u, now, areas, prices, give, lack, typical, step)
            if not changed:
                break
        return best, state[2], state[0]

    def _raised(self, u, weight, areas, prices, give, lack, typical, step):
        """Prices that are worse for a set of areas, if it is no region, and whether there are some."""
        adjacent, paid, per_lack = self.part.adjacent, prices.paid.copy(), prices.lack
        changed = False
        for group in connected_parts(adjacent, np.flatnonzero(areas).tolist()):
            if u in group:
                continue
            gain = self._gain(weight, group)
            if gain <= 0.0:
                continue
            group = np.array(group)
            around = {s for v in group.tolist() for s in adjacent[v]} - set(group.tolist())
            share = np.maximum(-weight[group], 0.0)
            paid[group] += share / share.sum() * gain * step
            paid[list(facing(adjacent, u, around))] -= gain * step
            changed = True
        given = float(give @ areas) - lack
        if given < -1e-9 * lack:
            per_lack += max(0.3 * per_lack, 0.2 * typical) * step
            changed = True
        elif per_lack > 0.0 and given > 1e-9 * lack:
            per_lack *= 1.0 - 0.3 * step
            changed = True
        return _Prices(paid, per_lack), changed

    def _gain(self, weight, group):
        """What a component of a set saves."""
        inner = np.zeros(self.n, dtype=bool)
        inner[group] = True
        border = inner[self.part.a] != inner[self.part.b]
        return -float(weight[group].sum() + self.half[border].sum())

"""The mixed-integer programme of Haunert and Wolff, solved by HiGHS, with contiguity cuts.

``x[v, u]`` is 1 where area v belongs to the region with core u. A boundary costs where two
neighbours differ: ``d >= x[v, u] - x[w, u]``, in one direction only, as both sum up to 1. Contiguity is
cuts ``x[v, u] <= sum of x[s, u] over a separator of u and v`` (Oehrlein and Haunert 2017), added
where a solution violates them.

First prices of areas, by which every core is a problem of its own (see `lagrangian`): in half a minute they
bound a part of 150 areas within some percent, and tell cores that are in no better solution. Then
the relaxation, by column generation: most pairs of an area and a far core are left out,
and come in where the dual prices ask for them. Contiguity cuts are separated in the relaxation.
Its bound, and a good solution to start from, tell which pairs are in no better solution; what is
left is solved in integers. Every bound holds: pairs that are left out with a negative reduced
cost are charged to it (each area has one core only, and there is not room for many cores).
"""

from __future__ import annotations

from time import perf_counter
from types import ModuleType
from typing import Callable, NamedTuple

import numpy as np

from ..errors import MissingEngine, Sentence
from ..progress import ignore
from .annealing import annealing
from .greedy import greedy, helpless
from .instance import (
    Instance,
    Solution,
    build,
    components,
    connected_parts,
    costs,
    each_share,
    enough,
    problems,
    shares,
    solution,
)
from .lagrangian import facing, lagrangian

__all__ = ["FEW", "Exact", "exact", "exact_where_small", "require_highs"]

LARGEST_PROGRAMME = 100_000  # pairs of an area and a core; a part with more gets no bound
ALL_PAIRS = 1_500  # so many pairs are in the relaxation from the beginning
NEAREST, BALL = 16, 48  # otherwise: the cheapest cores of an area, and the areas around a core
MORE = 12  # pairs an area that come in at once
LARGEST_INTEGER = 6_000  # pairs left that are worth a programme in integers
FEW, EACH = 20, 10.0  # areas of a part that is solved beside annealing, and how many seconds it may take
FEW_AREAS = 40  # to so many the programme is quicker than the prices of areas, and mostly proves
LEVELS = (1e-6, 0.1, 0.25, 0.5, 0.75)  # where the support of a fractional solution is looked at


class Exact(NamedTuple):
    """Result of the exact method.

    Attributes
    ----------
    found : Solution
    bound : float
        No solution costs less (with ``decompose``: none in which every area that is large enough by
        itself is the core of its region).
    proven : bool
        Whether ``found`` is the best one.
    rounds, parts : int
        How many programmes were solved, relaxed ones included, and for how many independent parts.
    large : int
        How many of the parts are too large for a programme: they are as in the solution begun with, and the
        bound knows nothing of their boundaries.
    """

    found: Solution
    bound: float
    proven: bool
    rounds: int
    parts: int
    large: int


def require_highs() -> tuple[Callable, Callable, type, ModuleType]:
    """Return scipy's ``linprog``, ``milp``, ``LinearConstraint`` and ``sparse``.

    Raises
    ------
    MissingEngine
        If scipy is missing or older than 1.9; it says what to install.

    Examples
    --------
    >>> [tool.__name__ for tool in require_highs()]
    ['linprog', 'milp', 'LinearConstraint', 'scipy.sparse']
    """
    try:
        from scipy import sparse
        from scipy.optimize import LinearConstraint, linprog, milp
    except ImportError:
        needed = Sentence(
            "the exact method needs the solver HiGHS from the Python package scipy, 1.9 or newer"
        )
        raise MissingEngine(needed) from None
    return linprog, milp, LinearConstraint, sparse


def exact(
    problem: Instance,
    *,
    seconds: float = 60.0,
    decompose: bool = True,
    begin: Solution | None = None,
    check: Callable | None = None,
) -> Exact:
    """Aggregate at least cost.

    Parameters
    ----------
    problem : Instance
    seconds : float
        Time for all parts together.
    decompose : bool
        Whether an area that is large enough by itself is always the core of a region: the map
        then falls into parts that are solved one by one.
    begin : Solution, optional
        A good one makes the proof short; it is returned where the time is over and nothing better was
        found. Default: annealed, 1,000 steps an area.
    check : callable, optional
        Called now and then with the share done; may raise to stop.

    Returns
    -------
    Exact

    Raises
    ------
    MissingEngine

    Notes
    -----
    The integer programme of Haunert and Wolff (2010), with the cuts of Oehrlein and Haunert (2017).

    Exponential. Thirty areas a part take seconds; with some hundred the bound is within ten percent
    after a minute. A part of so many areas that `LARGEST_PROGRAMME` pairs of an area and a core are too few
    stays as it began.

    Examples
    --------
    Two areas of 3 and two small ones between them, in a row; a region needs a size of 4. The best is that
    one area of size 1 changes its class.

    >>> row = [[0, 1], [1, 2], [2, 3]]
    >>> problem = build([3, 1, 1, 3], [0, 0, 0, 1], range(4), row, np.ones(3), 1 - np.eye(2), [4.0, 4.0])
    >>> result = exact(problem)
    >>> result.found.region.tolist(), costs(problem, result.found).total
    ([0, 0, 1, 1], 1.0)
    >>> bool(result.proven), round(float(result.bound), 6)
    (True, 1.0)
    """
    tools = require_highs()
    check = check or ignore
    until = perf_counter() + seconds
    if begin is None:
        begin = annealing(problem, iterations=1000 * len(problem.size))
    n = len(problem.size)
    lost = helpless(problem)
    own = problem.theta[problem.cls]
    big = ~lost & enough(problem.size, own) if decompose else np.zeros(n, dtype=bool)
    label = np.where(lost, 2, big.astype(np.int64))
    pieces = components(problem, label)
    groups = [np.flatnonzero(pieces == k) for k in np.unique(pieces[label == 0])]

    core_of = np.full(n, -1)
    core_of[big] = np.flatnonzero(big)
    if lost.any():
        alike = components(problem, np.where(lost, problem.cls, -1))
        for k in np.unique(alike[lost]):
            areas = np.flatnonzero(alike == k)
            core_of[areas] = areas[0]
    bound, proven, rounds, large = 0.0, True, 0, 0
    for k, group in enumerate(sorted(groups, key=len)):
        check(k / len(groups))
        left = max(0.1, (until - perf_counter()) / (len(groups) - k))
        part = _Part(problem, group, big, begin, tools)
        best, at_least, solved, tried = part.solve(perf_counter() + left, check)
        core_of[group] = best
        bound += at_least
        proven &= solved
        rounds += tried
        large += part.too_large and not solved
    found = _numbered(problem, core_of)
    bound += _constant(problem, big, core_of, lost)
    worse = not proven and costs(problem, begin).total < costs(problem, found).total
    if worse or problems_of(problem, found, lost):
        found = begin
    return Exact(found, bound, proven, rounds, len(groups), large)


def exact_where_small(
    problem: Instance, begin: Solution, check: Callable | None = None
) -> tuple[Solution, int]:
    """Exchange what a solution has on islands of at most `FEW` areas for what costs least there.

    There it may take several areas at once to found a region, which annealing now and then misses, while
    the programme is solved in no more time.

    Parameters
    ----------
    problem : Instance
    begin : Solution
        Feasible.
    check : callable, optional
        Called with None now and then; may raise to stop.

    Returns
    -------
    found : Solution
        Not more expensive than ``begin``.
    islands : int
        For how many it is proven that nothing costs less.

    Raises
    ------
    MissingEngine

    Examples
    --------
    Two areas of 3 and two small ones between them, in a row; a region needs a size of 4. The best is that
    one area of size 1 changes its class, and not the last one.

    >>> row = [[0, 1], [1, 2], [2, 3]]
    >>> problem = build([3, 1, 1, 3], [0, 0, 0, 1], range(4), row, np.ones(3), 1 - np.eye(2), [4.0, 4.0])
    >>> found, islands = exact_where_small(problem, greedy(problem))
    >>> found.region.tolist(), islands
    ([0, 0, 1, 1], 1)
    """
    tools, island, lost = require_highs(), components(problem), helpless(problem)
    core_of, none, proven = begin.core[begin.region], np.zeros(len(island), dtype=bool), 0
    order = np.argsort(island, kind="stable")
    for group in np.split(order, np.cumsum(np.bincount(island))[:-1]):
        if not 1 < len(group) <= FEW or lost[group[0]]:
            continue
        part = _Part(problem, group, none, begin, tools)
        core_of[group], _, solved, _ = part.solve(perf_counter() + EACH, check or ignore)
        proven += solved
    found = _numbered(problem, core_of) if proven else begin
    return min((begin, found), key=lambda one: costs(problem, one).total), proven


def problems_of(problem: Instance, found: Solution, lost: np.ndarray) -> list[tuple[int, Sentence]]:
    """Faults of a solution apart from those that nothing can help."""
    return [fault for fault in problems(problem, found) if not lost[found.core[fault[0]]]]


def _numbered(problem, core_of):
    """Solution from the core of each area, with cheaper cores where there are some."""
    _, first, region = np.unique(core_of, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    core = np.empty(len(first), dtype=np.int64)
    core[rank] = core_of[first]
    mine = Solution(rank[region.ravel()], core)
    other = solution(problem, mine.region)
    worse = costs(problem, other).total >= costs(problem, mine).total
    return mine if worse else other


def _constant(problem, big, core_of, lost):
    """Cost that no choice changes: of areas fixed beforehand, and between them."""
    fixed, own = big | lost, np.flatnonzero(big)
    total = float(each_share(problem, own, own).sum())
    if lost.any():
        for u in np.unique(core_of[lost]):
            members = np.flatnonzero((core_of == u) & lost)
            total += shares(problem, members, members).sum(axis=0).min()
    owner, other = problem.owner, problem.neighbour
    both = (owner < other) & fixed[owner] & fixed[other] & (core_of[owner] != core_of[other])
    if problem.by_class:
        both &= problem.cls[core_of[owner]] != problem.cls[core_of[other]]
    return total + problem.boundary * float(problem.length[both].sum())


class _Programme(NamedTuple):
    """A programme of some pairs of an area and a core; its columns are the pairs, then the differences.

    Attributes
    ----------
    cost : (c,) float
    rows : (r, c) sparse
        Differences, links of pairs to cores, thresholds, cuts, and the number of cores.
    high : (r,) float
        What each row is at most.
    one : (n, c) sparse
        Each area has one core.
    ends : (4,) int
        Where the rows of a kind end, but for the last.
    place : (n, k) int
        Column of each pair, -1 where it is left out.
    area, core : (x,) int
        The pairs.
    link : (x,) bool
        Those that have a row.
    edge, kind : (d,) int
        What each difference is about.
    """

    cost: np.ndarray
    rows: object
    high: np.ndarray
    one: object
    ends: np.ndarray
    place: np.ndarray
    area: np.ndarray
    core: np.ndarray
    link: np.ndarray
    edge: np.ndarray
    kind: np.ndarray


class _Part:
    """The programme of one part: free areas, and the large ones around them that are cores.

    Areas and cores have numbers of their own here: ``areas[i]``, ``cores[j]``, and core j is the area
    ``own[j]``. ``fixed`` areas belong to themselves.
    """

    def __init__(self, problem, group, big, begin, tools):
        self.problem, self.tools = problem, tools
        degree = np.diff(problem.start)[group]
        slot = np.arange(degree.sum()) + np.repeat(problem.start[group] - np.cumsum(degree) + degree, degree)
        tail, head = np.repeat(group, degree), problem.neighbour[slot]
        around = np.unique(head[big[head]])
        self.areas = np.concatenate((group, around))
        self.free = len(group)
        n = len(self.areas)
        number = np.full(len(problem.size), -1)
        number[self.areas] = np.arange(n)
        once = big[head] | (tail < head)
        self.a, self.b = number[tail[once]], number[head[once]]
        self.price = problem.boundary * problem.length[slot[once]]
        self.adjacent = [[] for _ in range(n)]
        for v, w in zip(self.a.tolist(), self.b.tolist()):
            self.adjacent[v].append(w)
            self.adjacent[w].append(v)
        self.size = problem.size[self.areas]
        theta = problem.theta[problem.cls[self.areas]]
        possible = enough(self.size[: self.free].sum(), theta)
        possible[self.free :] = True
        self.own = np.flatnonzero(possible)
        self.cores = self.areas[self.own]
        self.theta = np.where(self.own < self.free, theta[self.own], 0.0)
        self.cost = shares(problem, self.areas, self.cores)
        # who counts as equal: the same core, or a core of the same class
        self.kind = problem.cls[self.cores] if problem.by_class else np.arange(len(self.cores))
        self.kind = np.unique(self.kind, return_inverse=True)[1].ravel()
        # a boundary costs both of its regions, whatever they are
        self.decomposes = not (problem.by_class and problem.boundary)
        self.rounds, self.cuts = 0, {}
        self.too_large = self.free * len(self.cores) > LARGEST_PROGRAMME
        self.chosen = self._start(begin, big)

    # ---- solutions: the core of each area

    def _start(self, begin, big):
        """The cores of the solution to start from, or those of greedy where it does not fit."""
        core = begin.core[begin.region[self.areas]]
        number = np.full(len(self.problem.size), -1)
        number[self.cores] = np.arange(len(self.cores))
        fits = number[core] >= 0
        fits[self.free :] &= core[self.free :] == self.areas[self.free :]
        if not fits.all() or not self._feasible(number[core]):
            core = self._greedy()
        return number[core]

    def _feasible(self, chosen):
        return not self._violated_by(chosen)

    def _cost_of(self, chosen):
        kind = self.kind[chosen]
        total = self.cost[np.arange(self.free), chosen[: self.free]].sum()
        return float(total + self.price[kind[self.a] != kind[self.b]].sum())

    def _violated_by(self, chosen):
        """Cuts that a solution in integers violates."""
        n, x = len(self.areas), np.zeros((len(self.areas), len(self.cores)))
        x[np.arange(n), chosen] = 1.0
        found = self._separate(x, LEVELS[3:4])
        size = np.bincount(chosen, weights=self.size, minlength=len(self.cores))
        used = np.bincount(chosen, minlength=len(self.cores)) > 0
        for j in np.flatnonzero(used & ~enough(size, self.theta)).tolist():
            # within the solver's tolerance: then one more area must come, or the core must go
            found[j, int(self.own[j]), tuple(np.flatnonzero(chosen != j).tolist())] = None
        return found

    # ---- the relaxation

    def solve(self, until, check):
        """Return the core of each free area, a lower bound, whether it is reached, and the rounds."""
        # what is fixed costs the same in all solutions, and is counted elsewhere
        bound = float(self.cost[: self.free].min(axis=1).sum())
        far = np.zeros(len(self.cores), dtype=bool)
        if self.decomposes and self.free > FEW_AREAS and not self.too_large:
            by_prices = lagrangian(self, until, check)
            bound, far = max(bound, by_prices.value), by_prices.far
            self.rounds += by_prices.rounds
        if not self.too_large and bound < self._cost_of(self.chosen) * (1.0 - 1e-9):
            bound = max(bound, self._bound(far, until, check))
        best = self._cost_of(self.chosen)
        proven = bound >= best * (1.0 - 1e-9)
        core = self.cores[self.chosen[: self.free]]
        return core, min(bound, best) if proven else bound, proven, self.rounds

    def _bound(self, far, until, check):
        """Bound of the relaxation, and of the programme; without cores that are known to be far."""
        n, k = len(self.areas), len(self.cores)
        possible = np.ones((n, k), dtype=bool)
        possible[self.free :] = False
        possible[self.own, np.arange(k)] = True
        possible[:, far] = False
        chosen = self._first_pairs() & possible
        bound, last = -np.inf, -np.inf
        while perf_counter() < until:
            check(None)
            answer = self._relaxed(chosen, until)
            if answer is None:
                return bound
            value, x, reduced = answer
            best = self._cost_of(self.chosen)
            reduced[~possible] = np.inf
            least = np.minimum(reduced.min(axis=1), 0.0)
            bound = max(bound, value + self._by_cores(reduced))
            value += least.sum()
            bound = max(bound, value)
            wanted = ~chosen & (reduced < -1e-7 * best)
            if wanted.any():
                rank = np.argsort(np.argsort(np.where(wanted, reduced, np.inf), axis=1), axis=1)
                chosen |= wanted & (rank < MORE)
                continue
            # pairs that cost more than the gap are in no better solution
            far = possible & (value - least[:, None] + reduced > best * (1.0 + 1e-7))
            far[:, far[self.own, np.arange(k)]] = True
            possible &= ~far
            chosen &= possible
            if self._adopt(x):
                best = self._cost_of(self.chosen)
            if bound >= best * (1.0 - 1e-7):
                return best
            before = len(self.cuts)
            self.cuts.update(self._separate(x, LEVELS))
            few = possible.sum() <= LARGEST_INTEGER
            if len(self.cuts) == before or (few and value < last * (1.0 + 2e-4)):
                if few or len(self.cuts) == before:
                    break
            last = value
        if perf_counter() < until:
            return max(bound, self._in_integers(possible, bound, until, check))
        return bound

    def _by_cores(self, reduced):
        """What pairs of negative reduced cost may save at most: only cores have areas.

        Long before all pairs are there this is better than the least of each area.
        """
        negative, j = np.minimum(reduced, 0.0), np.arange(len(self.own))
        others = negative.sum(axis=0) - negative[self.own, j]
        saved = np.minimum(reduced[self.own, j] + others, 0.0)
        free = self.own < self.free
        return float(np.sort(saved[free])[: int(self._most())].sum() + saved[~free].sum())

    def _adopt(self, x):
        """Take a solution of the relaxation if it is one in integers, and costs less."""
        chosen = np.argmax(x, axis=1)
        better = self._cost_of(chosen) < self._cost_of(self.chosen) and self._feasible(chosen)
        if better:
            self.chosen = chosen
        return better

    def _first_pairs(self):
        """The pairs to begin with: cheap ones, areas around each core, and what is known to fit."""
        n, k = self.cost.shape
        if n * k <= ALL_PAIRS:
            return np.ones((n, k), dtype=bool)
        first = np.zeros((n, k), dtype=bool)
        cheap = np.argpartition(self.cost, min(NEAREST, k - 1), axis=1)[:, :NEAREST]
        np.put_along_axis(first, cheap, True, axis=1)
        for j, v in enumerate(self.own.tolist()):
            ball, seen = [v], {v}
            for w in ball:
                for u in self.adjacent[w]:
                    if u not in seen and len(ball) < BALL:
                        seen.add(u)
                        ball.append(u)
            first[ball, j] = True
        first[np.arange(n), self.chosen] = True
        first[self.own, np.arange(k)] = True
        return first

    def _programme(self, chosen):
        """The programme of the chosen pairs, as `_Programme`."""
        sparse, (n, k) = self.tools[3], self.cost.shape
        v, j = np.nonzero(chosen)
        x = len(v)
        place = np.full((n, k), -1)
        place[v, j] = np.arange(x)
        edge, kind = self._differences(v, j)
        total = x + len(edge)
        link = (self.own[j] != v) & (self.own[j] < self.free)  # a fixed core is there anyway
        blocks = [
            self._difference_rows(v, j, edge, kind, total),
            self._link_rows(place, j, link, total),
            sparse.csr_matrix((self._needs()[v, j], (j, np.arange(x))), shape=(k, total)),
            self._cut_rows(place, total),
            self._number_row(place, total),
        ]
        return _Programme(
            cost=np.concatenate((np.where(v < self.free, self.cost[chosen], 0.0), self.price[edge])),
            rows=sparse.vstack(blocks).tocsr(),
            high=np.append(np.zeros(sum(block.shape[0] for block in blocks[:-1])), self._most()),
            one=sparse.csr_matrix((np.ones(x), (v, np.arange(x))), shape=(n, total)),
            ends=np.cumsum([block.shape[0] for block in blocks[:-1]]),
            place=place, area=v, core=j, link=link, edge=edge, kind=kind,
        )  # fmt: skip

    def _differences(self, v, j):
        """The edges and kinds of core that need a variable: may one end be of the kind, and not the other."""
        there = np.zeros((len(self.areas), int(self.kind.max(initial=-1)) + 1), dtype=bool)
        there[v, self.kind[j]] = True
        edge, kind = np.nonzero(there[self.a] | there[self.b])
        return edge[self.price[edge] > 0.0], kind[self.price[edge] > 0.0]

    def _difference_rows(self, v, j, edge, kind, total):
        """How much more of the kind the first end has than the second is at most the difference."""
        sparse, x, d = self.tools[3], len(v), len(edge)
        kinds = int(self.kind.max(initial=-1)) + 1
        of_kind = sparse.csr_matrix(
            (np.ones(x), (v * kinds + self.kind[j], np.arange(x))), shape=(len(self.areas) * kinds, total)
        )
        minus = sparse.csr_matrix((np.ones(d), (np.arange(d), x + np.arange(d))), shape=(d, total))
        return of_kind[self.a[edge] * kinds + kind] - of_kind[self.b[edge] * kinds + kind] - minus

    def _link_rows(self, place, j, link, total):
        """No area has a core that is none."""
        left, right = np.flatnonzero(link), place[self.own[j[link]], j[link]]
        rows = np.arange(len(left))
        return self.tools[3].csr_matrix(
            (np.repeat([1.0, -1.0], len(left)), (np.tile(rows, 2), np.concatenate((left, right)))),
            shape=(len(left), total),
        )

    def _number_row(self, place, total):
        """How many of the free areas are cores."""
        free = place[self.own, np.arange(len(self.own))][self.own < self.free]
        free = free[free >= 0]
        return self.tools[3].csr_matrix(
            (np.ones(len(free)), (np.zeros(len(free), dtype=np.int64), free)), shape=(1, total)
        )

    def _cut_rows(self, place, total):
        """Rows of the cuts; which row each has is remembered."""
        rows, columns, values = [], [], []
        self.row_of_cut = {}
        for j, v, separator in self.cuts:
            if place[v, j] < 0:
                continue
            others = [c for c in place[list(separator), j].tolist() if c >= 0]
            number = len(self.row_of_cut)
            self.row_of_cut[j, v, separator] = number
            rows += [number] * (1 + len(others))
            columns += [int(place[v, j]), *others]
            values += [1.0] + [-1.0] * len(others)
        places = np.array([rows, columns], dtype=np.int64)
        return self.tools[3].csr_matrix(
            (np.array(values), (places[0], places[1])), shape=(len(self.row_of_cut), total)
        )

    def _needs(self):
        """(n, k): what each area adds to the row of each core's threshold."""
        n, k = self.cost.shape
        # of what the core lacks, no area gives more than all
        lack = self.theta - self.size[self.own]
        lack[enough(self.size[self.own], self.theta)] = np.inf
        needs = -np.minimum(self.size[:, None] / lack, 1.0)
        needs[self.own, np.arange(k)] = np.isfinite(lack)
        needs[self.free :] = 0.0
        return needs

    def _most(self):
        """How many cores there is room for among the free areas."""
        free = self.own < self.free
        least = self.theta[free].min(initial=np.inf)
        if not 0.0 < least < np.inf:
            return float(free.sum())
        return float(np.floor(self.size[: self.free].sum() / least * (1.0 + 1e-9)))

    def _relaxed(self, chosen, until):
        """Solve the relaxation for the chosen pairs.

        Returns
        -------
        value : float
            Together with the least reduced cost of each area, where that is negative, a lower bound,
            by the dual prices alone, however well they were computed.
        x : (n, k) float
        reduced : (n, k) float
            Reduced costs of all pairs, those that were left out, too.
        """
        programme = self._programme(chosen)
        self.rounds += 1
        answer, unit = self._optimum(programme, until)
        if answer.status != 0:
            return None
        dual = np.minimum(answer.ineqlin.marginals, 0.0) * unit
        reduced = self._reduced(programme, answer.eqlin.marginals * unit, dual)
        x = np.zeros(self.cost.shape)
        x[chosen] = answer.x[: len(programme.area)]
        # by weak duality; a difference is at most 1
        value = float(answer.eqlin.marginals.sum() * unit + dual[-1] * self._most())
        edge = programme.edge
        value += float(np.minimum(self.price[edge] + dual[: len(edge)], 0.0).sum())
        return value, x, reduced

    def _optimum(self, programme, until):
        """What HiGHS says of the relaxation, and the unit that its costs are in."""
        unit = max(np.abs(programme.cost).max() / 100.0, 1e-300)
        left = max(until - perf_counter(), 0.1)
        for presolve in (True, False):
            answer = self.tools[0](
                programme.cost / unit,
                programme.rows,
                programme.high,
                programme.one,
                np.ones(len(self.areas)),
                bounds=(0.0, None),
                method="highs-ds",
                options={"time_limit": left, "presolve": presolve},
            )
            if answer.status < 2:  # the presolve of HiGHS 1.2 (scipy 1.10) takes some for unbounded
                break
        return answer, unit

    def _reduced(self, programme, of_area, dual):
        """Reduced costs of all pairs, by the dual prices of the areas and of the rows."""
        n, k = self.cost.shape
        of_difference, of_link, of_threshold, of_cut, of_number = np.split(dual, programme.ends)
        reduced = np.where(np.arange(n)[:, None] < self.free, self.cost, 0.0)
        reduced = reduced - of_area[:, None]
        by_kind = np.zeros((n, int(self.kind.max()) + 1))
        np.add.at(by_kind, (self.a[programme.edge], programme.kind), of_difference)
        np.subtract.at(by_kind, (self.b[programme.edge], programme.kind), of_difference)
        reduced -= by_kind[:, self.kind]
        v, j = programme.area[programme.link], programme.core[programme.link]
        np.subtract.at(reduced, (v, j), of_link)
        np.add.at(reduced, (self.own[j], j), of_link)
        reduced -= self._needs() * of_threshold
        for (j, v, separator), number in self.row_of_cut.items():
            reduced[v, j] -= of_cut[number]
            reduced[list(separator), j] += of_cut[number]
        free = np.flatnonzero(self.own < self.free)
        reduced[self.own[free], free] -= of_number[0]
        return reduced

    def _separate(self, x, levels):
        """Contiguity cuts that a solution violates: a dict by core, area and separator."""
        found = {}
        for j in np.flatnonzero(x.max(axis=0) > 1e-6).tolist():
            column, u = x[:, j], int(self.own[j])
            seen = set()
            for level in levels:
                support = {u, *np.flatnonzero(column > level * max(column[u], 1e-3)).tolist()}
                for part in connected_parts(self.adjacent, support):
                    part = frozenset(part)
                    if part in seen:
                        continue
                    seen.add(part)
                    around = {s for v in part for s in self.adjacent[v]} - part
                    if u not in part and u not in around:  # who is in here comes through those
                        ahead, inside = facing(self.adjacent, u, around), part
                    elif u in part and not enough(self.size[list(part)].sum(), self.theta[j]):
                        ahead, inside = around, (u,)  # too small: it goes on somewhere
                    else:
                        continue
                    separator = tuple(sorted(ahead))
                    most = column[list(separator)].sum() + 1e-4
                    for v in inside:
                        if column[v] > most:
                            found[j, v, separator] = None
        return found

    # ---- in integers

    def _in_integers(self, possible, bound, until, check):
        """Solve the programme of all pairs that are left; return the bound."""
        _, milp, constraint, sparse = self.tools
        presolve = True
        while perf_counter() < until:
            check(None)
            cost, rows, high, one, _, place, *_ = self._programme(possible)
            self.rounds += 1
            # HiGHS takes indices of 32 bits; scipy before 1.12 hands on others as they are
            matrix = sparse.vstack((one, rows)).tocsc()
            matrix.indices, matrix.indptr = (
                part.astype(np.int32) for part in (matrix.indices, matrix.indptr)
            )
            low = np.concatenate((np.ones(one.shape[0]), np.full(rows.shape[0], -np.inf)))
            high = np.concatenate((np.ones(one.shape[0]), high))
            unit = max(np.abs(cost).max() / 100.0, 1e-300)
            # the differences are whole, too, if the pairs are: with that said, presolve fails less often
            answer = milp(
                cost / unit,
                integrality=np.ones(len(cost)),
                bounds=(0.0, 1.0),
                constraints=constraint(matrix, low, high),
                options={
                    "time_limit": max(until - perf_counter(), 0.1),
                    "mip_rel_gap": 1e-9,
                    "presolve": presolve,
                },
            )
            best = self._cost_of(self.chosen)
            if answer.status == 2:
                if not presolve:
                    return bound
                # the solution known is in the programme: the presolve of HiGHS 1.2 (scipy 1.10) is wrong
                presolve = False
                continue
            if answer.mip_dual_bound is not None and np.isfinite(answer.mip_dual_bound):
                bound = max(bound, min(best, answer.mip_dual_bound * unit))
            if answer.x is None:
                return bound
            x = np.where(place >= 0, answer.x[place], 0.0)
            chosen = np.argmax(x, axis=1)
            violated = self._violated_by(chosen)
            if not violated and self._cost_of(chosen) < best:
                self.chosen, best = chosen, self._cost_of(chosen)
            if answer.status != 0:
                return bound
            if not violated:  # the bound is its cost, but for the solver's tolerance
                return best
            if not violated.keys() - self.cuts.keys():
                return bound
            self.cuts.update(violated)
        return bound

    def _greedy(self):
        """The greedy solution of this part, in which no two of the large areas join."""
        p, areas = self.problem, self.areas
        part = build(
            self.size,
            p.cls[areas],
            p.place[areas],
            np.column_stack((self.a, self.b)),
            self.price / (p.boundary or 1.0),
            p.distance,
            p.theta,
            change=p.change,
            boundary=p.boundary,
            centre=p.centre,
            by_class=p.by_class,
            spread=p.spread[areas],
        )
        found = greedy(part)
        core = areas[found.core]
        core[found.region[self.free :]] = areas[self.free :]
        return core[found.region]

"""The three methods: always feasible; exact is exact; annealing does not cost more than greedy."""

from itertools import combinations
from time import sleep
from types import SimpleNamespace

import numpy as np
import pytest

from isthmus.core.aggregation import annealing as annealing_stage
from isthmus.core.aggregation import methods
from isthmus.core.aggregation.annealing import Schedule, _cool, _Effort, annealing
from isthmus.core.aggregation.exact import (
    FEW,
    _Part,
    exact,
    exact_where_small,
    problems_of,
    require_highs,
)
from isthmus.core.aggregation.greedy import greedy, helpless, reach_count
from isthmus.core.aggregation.instance import (
    Solution,
    build,
    cheapest_core,
    components,
    costs,
    enough,
    problems,
    shares,
    solution,
)
from isthmus.core.aggregation.moves import (
    Terms,
    every_move,
    gather,
    group_price,
    merge,
    move_core,
    prices,
    split,
)
from isthmus.core.aggregation.regions import Regions
from isthmus.core.aggregation.repair import FREE
from isthmus.core.errors import MissingEngine

from .brute_force import cheapest
from .maps import grid, random_map

SEEDS = range(40)


def has_highs():
    try:
        return bool(require_highs())
    except MissingEngine:
        return False


needs_highs = pytest.mark.skipif(not has_highs(), reason="scipy is missing or older than 1.9")


def by_all_methods(problem):
    """The solutions of all methods; exact where there is its solver."""
    yield greedy(problem)
    yield annealing(problem, iterations=4000)
    if has_highs():
        yield exact(problem).found


def check(problem, found):
    assert not problems_of(problem, found, helpless(problem))
    assert sorted(set(found.region.tolist())) == list(range(len(found.core)))
    assert (found.region[found.core] == np.arange(len(found.core))).all()


@needs_highs
@pytest.mark.parametrize("by_class", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_exact_is_the_cheapest_of_all_partitions(seed, by_class):
    problem = random_map(seed, by_class=by_class)
    lost = helpless(problem)
    if lost.any():
        result = exact(problem)
        check(problem, result.found)
        return
    big = enough(problem.size, problem.theta[problem.cls])
    for decompose in (False, True):
        result = exact(problem, decompose=decompose)
        best = cheapest(problem, big if decompose else None)
        check(problem, result.found)
        assert result.proven
        assert result.bound == pytest.approx(best, rel=1e-6)
        # a core may be exchanged for a cheaper one afterwards
        assert costs(problem, result.found).total <= best * (1 + 1e-9)
        if not decompose:
            assert costs(problem, result.found).total == pytest.approx(best, rel=1e-6)


@needs_highs
@pytest.mark.parametrize("decompose", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_what_exact_begins_with_is_kept_where_nothing_cheaper_is_proven(seed, decompose):
    problem = random_map(seed, n=30)
    begin = annealing(problem, iterations=4000)
    result = exact(problem, seconds=0.0, decompose=decompose, begin=begin)
    check(problem, result.found)
    if not (decompose and result.proven):  # the best of the pieces may cost more than what crosses them
        assert costs(problem, result.found).total <= costs(problem, begin).total * (1 + 1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_what_pairs_may_save_where_only_cores_have_areas(seed):
    """Against all sets of cores; those behind the free ones are there anyway."""
    rng = np.random.default_rng(seed)
    free, fixed, most = (int(k) for k in rng.integers((1, 0, 0), (6, 3, 4)))
    own = np.append(np.sort(rng.permutation(7)[:free]), np.arange(7, 7 + fixed))
    reduced = rng.integers(-5, 6, (7 + fixed, len(own))).astype(float)
    part = SimpleNamespace(own=own, free=7, _most=lambda: most)
    saved = [
        reduced[u, j] + sum(min(cost, 0.0) for v, cost in enumerate(reduced[:, j]) if v != u)
        for j, u in enumerate(own)
    ]
    sets = (s for k in range(most + 1) for s in combinations(saved[:free], k))
    expected = min(sum(s) for s in sets) + sum(min(0.0, s) for s in saved[free:])
    assert _Part._by_cores(part, reduced) == expected


@pytest.mark.parametrize("by_class", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_heuristics_are_feasible_and_not_below_the_optimum(seed, by_class):
    problem = random_map(seed, by_class=by_class)
    first = greedy(problem)
    second = annealing(problem, seed=seed, iterations=4000)
    for found in (first, second):
        check(problem, found)
    assert costs(problem, second).total <= costs(problem, first).total + 1e-9
    if not helpless(problem).any():
        assert costs(problem, second).total >= cheapest(problem) * (1 - 1e-9)


@pytest.mark.parametrize("by_class", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_larger_maps_are_feasible(seed, by_class):
    problem = random_map(seed, n=150, by_class=by_class)
    first = greedy(problem)
    second = annealing(problem, seed=1, iterations=40_000)
    check(problem, first)
    check(problem, second)
    assert costs(problem, second).total < costs(problem, first).total


def test_steps_and_a_time_limit_together_end_with_what_is_over_first():
    problem = random_map(3, n=60)
    found = annealing(problem, iterations=10**12, seconds=0.2)  # the steps alone would take weeks
    check(problem, found)
    by_steps = annealing(problem, iterations=6000)
    assert annealing(problem, iterations=6000, seconds=1e6).region.tolist() == by_steps.region.tolist()


@needs_highs
def test_the_time_of_exact_is_that_of_its_first_solution_too(monkeypatch):
    problem, took, told = random_map(3, n=30), [], []

    def slow(*args, **options):
        told.append(options["seconds"])
        sleep(0.6)
        return annealing(*args, **options)

    def bounded(problem, *, seconds, **options):
        took.append(seconds)
        return exact(problem, seconds=seconds, **options)

    monkeypatch.setattr(methods, "annealing", slow)
    monkeypatch.setattr(methods, "exact", bounded)
    methods.by_method(problem, "exact", seconds=4.0)
    assert told[0] <= 2.0 and 0.0 < took[0] <= 3.4


def islands(seed, by_class, large):
    """Maps as one: an island of so many areas, and others that brute force can solve."""
    maps = [random_map(100 * seed + k, by_class=by_class) for k in range(4)]
    maps = [one._replace(theta=np.full(3, 12.0)) for one in maps]
    one = random_map(seed, n=large, by_class=by_class)._replace(theta=np.full(3, 12.0))
    maps = [one, *(other._replace(distance=one.distance) for other in maps)]
    first = np.cumsum([0, *(len(its.size) for its in maps)])
    pairs = [np.column_stack((its.owner, its.neighbour))[its.owner < its.neighbour] + at
             for its, at in zip(maps, first)]  # fmt: skip
    whole = build(
        *(np.concatenate([getattr(its, name) for its in maps]) for name in ("size", "cls", "place")),
        np.concatenate(pairs),
        np.concatenate([its.length[its.owner < its.neighbour] for its in maps]),
        **{name: getattr(one, name) for name in one._fields[7:]},
        spread=np.concatenate([its.spread for its in maps]),
    )  # fmt: skip
    return whole, maps, first


@needs_highs
@pytest.mark.parametrize("by_class", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_small_islands_are_solved_and_large_ones_left(seed, by_class):
    whole, maps, first = islands(seed, by_class, 60)
    begin = greedy(whole)
    found, proven = exact_where_small(whole, begin)
    check(whole, found)
    areas = np.arange(len(whole.size))
    label = components(whole)
    small = (np.bincount(label) <= FEW)[label]
    assert small[first[1] :].all() and not small.all()
    same = found.region[areas][:, None] == found.region
    assert (same == (begin.region[:, None] == begin.region))[~small].all()
    lost = helpless(whole)
    several = (np.bincount(label) > 1)[label]
    assert proven == len(set(label[small & several & ~lost].tolist()))
    for one, lo, hi in zip(maps[1:], first[1:-1], first[2:]):
        if helpless(one).any():
            continue
        part = solution_of(found, lo, hi)
        assert costs(one, part).total == pytest.approx(cheapest(one), rel=1e-6)


def solution_of(found, lo, hi):
    """The part of a solution with these areas."""
    names, region = np.unique(found.region[lo:hi], return_inverse=True)
    return Solution(region.ravel(), found.core[names] - lo)


@needs_highs
def test_annealing_without_limits_leaves_small_islands_to_exact(monkeypatch):
    problem = islands(0, False, 30)[0]
    asked = []
    monkeypatch.setattr(
        methods, "annealing", lambda problem, **options: asked.append(options) or greedy(problem)
    )
    made = methods.by_method(problem, "annealing")
    assert made.islands >= 4 and made.exact is None
    assert costs(problem, made.found).total < costs(problem, greedy(problem)).total
    for limit in ({"iterations": 100}, {"seconds": 9.0}, {"count": 3}):
        assert methods.by_method(problem, "annealing", **limit).islands == 0

    def missing():
        raise MissingEngine("no scipy")

    monkeypatch.setattr("isthmus.core.aggregation.exact.require_highs", missing)
    made = methods.by_method(problem, "annealing")
    assert made.islands == 0 and costs(problem, made.found) == costs(problem, greedy(problem))
    assert len(asked) == 5


@needs_highs
def test_what_is_too_large_for_a_programme_is_said(monkeypatch):
    problem = islands(1, False, 30)[0]
    monkeypatch.setattr("isthmus.core.aggregation.exact.LARGEST_PROGRAMME", 300)
    result = exact(problem, seconds=9.0, decompose=False, begin=greedy(problem))
    check(problem, result.found)
    assert result.large == 1 and not result.proven
    assert result.bound <= costs(problem, result.found).total


@needs_highs
@pytest.mark.filterwarnings("error")
def test_a_map_on_which_nothing_costs_anything():
    problem = random_map(3, n=60, boundary=0.0, centre=0.0)._replace(change=0.0)
    result = exact(problem, seconds=2.0, decompose=False, begin=greedy(problem))
    check(problem, result.found)
    assert costs(problem, result.found).total == result.bound == 0.0


def test_the_scale_of_prices_is_that_of_moves_that_may_be_made(monkeypatch):
    """Most moves of a map may be impossible: with their price it was infinitely hot."""
    delta = np.array([np.inf, -1.0, 3.0, np.inf, 0.0, 1.0, np.inf, np.inf, 2.0, np.inf])
    monkeypatch.setattr(annealing_stage, "draw", lambda regions, rng, count: ())
    monkeypatch.setattr(annealing_stage, "prices", lambda regions, terms: delta)
    assert annealing_stage._scale(None, None, 0.0) == 2.0
    delta = delta[:2]
    assert annealing_stage._scale(None, None, 0.0) == 1.0


def test_same_seed_same_result_another_seed_another():
    problem = random_map(3, n=150)
    runs = [annealing(problem, seed=s, iterations=20_000).region.tolist() for s in (5, 5, 6)]
    assert runs[0] == runs[1]
    assert runs[0] != runs[2]


@pytest.mark.parametrize("by_class", [False, True])
def test_prices_of_moves_are_the_differences_of_costs(by_class):
    problem = random_map(8, n=60, by_class=by_class)
    begin = greedy(problem)
    regions = Regions(problem, begin)
    before = costs(problem, begin).total
    v, to = every_move(regions)
    delta = prices(regions, v, to, FREE)
    assert np.isfinite(delta).sum() > 20
    for k in np.flatnonzero(np.isfinite(delta)).tolist():
        region = begin.region.copy()
        region[v[k]] = to[k]
        core = begin.core.copy()
        after = costs(problem, begin._replace(region=region, core=core)).total
        assert delta[k] == pytest.approx(after - before, abs=1e-9)


@pytest.mark.parametrize("by_class", [False, True])
def test_prices_of_groups_are_the_differences_of_costs(by_class):
    problem = random_map(8, n=60, by_class=by_class)
    begin = greedy(problem)
    regions = Regions(problem, begin)
    before, tried = costs(problem, begin).total, 0
    for v, to in zip(*(a.tolist() for a in every_move(regions))):
        r = regions.labels[v]
        group = {u for u in (v, *regions.adjacent[v]) if regions.labels[u] == r and u != regions.core[r]}
        if v not in group or len(group) < 2:
            continue
        tried += 1
        region = begin.region.copy()
        region[sorted(group)] = to
        after = costs(problem, begin._replace(region=region)).total
        assert group_price(regions, group, r, to, FREE) == pytest.approx(after - before, abs=1e-9)
    assert tried > 10


def check_invariants(regions):
    problem = regions.problem
    used = np.unique(regions.region)
    assert regions.region.tolist() == regions.labels
    assert len(used) == regions.count
    for r in used.tolist():
        assert regions.members[r] == set(np.flatnonzero(regions.region == r).tolist())
        assert regions.number[r] == len(regions.members[r])
        assert regions.size[r] == pytest.approx(problem.size[regions.region == r].sum())
        assert regions.core[r] in regions.members[r]
    assert sorted(regions.free) == sorted(set(range(len(problem.size))) - set(used.tolist()))
    # contiguous, though perhaps too small
    assert not [p for p in problems(problem, regions.current()) if p[1] == "not contiguous"]


@pytest.mark.parametrize("by_class", [False, True])
@pytest.mark.parametrize("move", [merge, split, move_core, gather])
def test_moves_cost_what_they_are_priced(move, by_class):
    """Each move of several areas, made at any price, against the costs recomputed from scratch."""
    problem = random_map(5, n=80, by_class=by_class)
    begin = reach_count(problem, greedy(problem), 8)
    regions = Regions(problem, begin)
    rng = np.random.default_rng(1)
    asked = []

    class Spy(Terms):
        def accepts(self, delta, rng):
            asked.append(delta)
            return np.isfinite(delta)

    def lacking():
        used = np.unique(regions.region)
        core = regions.core[used]
        size = np.bincount(regions.region, weights=problem.size)[used]
        return np.maximum(regions.theta[core] - size, 0.0).sum()

    def state():
        total = costs(problem, Solution(regions.region, regions.core)).total
        return total + 2.0 * lacking() + 0.7 * regions.count

    made = 0
    for k in range(240):
        if k % 6 == 0:
            regions.load(begin)
        before, seen = state(), len(asked)
        regions.batch += 1
        move(regions, Spy(1.0, 2.0, 0.7), rng)
        if len(asked) > seen and np.isfinite(asked[-1]):
            made += 1
            assert state() - before == pytest.approx(asked[-1], abs=1e-6)
            check_invariants(regions)
    assert made > 20


@pytest.mark.parametrize("by_class", [False, True])
@pytest.mark.parametrize("count", [None, 12])
def test_the_regions_stay_true(by_class, count):
    problem = random_map(5, n=120, by_class=by_class)
    regions = Regions(problem, greedy(problem))
    before = regions.region.copy()
    rng = np.random.default_rng(7)
    _cool(regions, rng, _Effort(30_000, None), Schedule(), count, 0.0, lambda share: None)
    assert (regions.region != before).sum() > 30
    check_invariants(regions)


@pytest.mark.parametrize("wanted", [3, 8, 15, 25])
def test_a_fixed_number_of_regions(wanted):
    problem = random_map(2, n=150)._replace(theta=np.full(3, 25.0))
    for found in (
        reach_count(problem, greedy(problem), wanted),
        annealing(problem, seed=0, iterations=20_000, count=wanted),
    ):
        check(problem, found)
        assert len(found.core) == wanted


def test_an_island_that_is_too_small_is_left_as_it_is():
    # two areas of one class and one of another on an island, beside a mainland
    size = [10.0, 10.0, 1.0, 1.0, 1.0]
    problem = build(
        size, [0, 1, 0, 0, 1], np.arange(5.0), [(0, 1), (2, 3), (3, 4)], np.ones(3),
        1.0 - np.eye(2), np.full(2, 15.0), boundary=0.1,
    )  # fmt: skip
    assert helpless(problem).tolist() == [False, False, True, True, True]
    for found in by_all_methods(problem):
        assert found.region.tolist() == [0, 0, 1, 1, 2]
        assert [r for r, _ in problems(problem, found)] == [1, 2]


def test_an_excluded_class_does_not_appear():
    n = 16
    cls = np.arange(n) % 2
    problem = build(
        np.full(n, 30.0), cls, np.arange(n) * (1 + 0j), grid(4, 4), np.ones(24), 1.0 - np.eye(2),
        [20.0, np.inf], boundary=1.0,
    )  # fmt: skip
    for found in by_all_methods(problem):
        check(problem, found)
        assert (problem.cls[found.core] == 0).all()


def test_a_threshold_larger_than_the_map_changes_nothing():
    problem = random_map(1, n=30)._replace(theta=np.full(3, 1e9))
    for found in by_all_methods(problem):
        assert (problem.cls[found.core][found.region] == problem.cls).all()
    assert helpless(problem).all()


def test_best_cores_are_the_cheapest_by_hand():
    # three areas in a row; the middle one is the best centre
    problem = build(
        [1.0, 1.0, 1.0], [0, 0, 0], [0, 1, 2], [(0, 1), (1, 2)], [1, 1], np.zeros((1, 1)), [0.0],
        centre=1.0,
    )  # fmt: skip
    found = solution(problem, np.zeros(3))
    assert found.core.tolist() == [1]
    assert costs(problem, found).centre == 2.0
    assert costs(problem, found).centre_distance == pytest.approx(2 / 3)


def test_the_centre_distance_is_the_root_mean_square():
    # two areas: the core bills its own spread, the other the way to it and its spread
    problem = build(
        [2.0, 3.0], [0, 1], [0, 4], [(0, 1)], [1], 1.0 - np.eye(2), [0.0, 0.0], centre=0.5,
        spread=[9.0, 9.0],
    )  # fmt: skip
    found = Solution(np.array([0, 0]), np.array([0]))
    assert costs(problem, found).centre == pytest.approx(0.5 * (2 * 3.0 + 3 * 5.0))
    assert costs(problem, found).centre_distance == pytest.approx(21 / 5)


@pytest.mark.parametrize("seed", range(20))
def test_the_cheapest_core_is_that_of_all(seed):
    """Most cores are not tried, because of a bound."""
    rng = np.random.default_rng(seed)
    problem = random_map(seed, n=90, centre=float(rng.choice([0.0, 0.05, 1.0])))
    members = rng.permutation(90)[: int(rng.integers(40, 90))]
    extra = rng.random(len(members)) * 20.0
    extra[rng.random(len(members)) < 0.2] = np.inf
    best, cost = cheapest_core(problem, members, extra)
    everything = shares(problem, members, members).sum(axis=0) + extra
    assert cost == pytest.approx(everything.min())
    assert everything[best] == pytest.approx(everything.min())


def test_greedy_joins_what_costs_least_by_hand():
    """A row of four; the two small ones choose by class change, then by boundary."""
    problem = build(
        [9.0, 1.0, 2.0, 9.0], [0, 1, 1, 2], [0, 1, 2, 3], [(0, 1), (1, 2), (2, 3)], [1, 1, 5],
        [[0, 1, 1], [1, 0, 1], [1, 1, 0]], [4.0, 4.0, 4.0], boundary=0.1,
    )  # fmt: skip
    # the smallest joins its own class first; both together go where more boundary is saved
    assert greedy(problem).region.tolist() == [0, 1, 1, 1]


@needs_highs
@pytest.mark.parametrize("by_class", [False, True])
def test_greedy_passes_over_no_core_that_is_cheaper(by_class, monkeypatch):
    """It compares cores only where a bound on the cost of the other one does not tell."""
    maps = [random_map(seed, n=40, by_class=by_class, centre=2.0 / (1 + seed % 4)) for seed in range(40)]
    maps = [problem._replace(spread=30.0 * problem.spread) for problem in maps]  # as wide as they are far
    quick = [greedy(problem) for problem in maps]
    monkeypatch.setattr("isthmus.core.aggregation.greedy.NEARLY", np.inf)
    for problem, found in zip(maps, quick):
        other = greedy(problem)
        assert found.region.tolist() == other.region.tolist()
        assert found.core.tolist() == other.core.tolist()


@needs_highs
@pytest.mark.parametrize("seed", [2, 5, 7, 12])
def test_pairs_that_are_left_out_at_first_come_in_where_they_are_needed(seed, monkeypatch):
    problem = random_map(seed, n=26, boundary=2.0)._replace(theta=np.full(3, 15.0))
    results = [exact(problem, seconds=60.0, decompose=False, begin=greedy(problem))]
    for name, value in {"ALL_PAIRS": 50, "NEAREST": 3, "BALL": 3, "MORE": 2}.items():
        monkeypatch.setattr(f"isthmus.core.aggregation.exact.{name}", value)
    results.append(exact(problem, seconds=60.0, decompose=False, begin=greedy(problem)))
    assert results[1].rounds > results[0].rounds
    total = costs(problem, results[0].found).total
    for result in results:
        check(problem, result.found)
        assert result.proven
        assert result.bound == pytest.approx(total) == costs(problem, result.found).total


@needs_highs
def test_a_time_limit_keeps_a_feasible_map_and_a_bound_below_it():
    problem = random_map(4, n=60)._replace(theta=np.full(3, 60.0))
    result = exact(problem, seconds=1.0, decompose=False)
    check(problem, result.found)
    assert result.bound <= costs(problem, result.found).total * (1 + 1e-9)

"""The bound by prices: below every solution, near the best one, and cores ruled out are in none."""

from time import perf_counter

import numpy as np
import pytest

from isthmus.core.aggregation import exact as module
from isthmus.core.aggregation import lagrangian as prices
from isthmus.core.aggregation.annealing import annealing
from isthmus.core.aggregation.exact import exact, require_highs
from isthmus.core.aggregation.greedy import greedy, helpless
from isthmus.core.aggregation.instance import costs, enough, shares
from isthmus.core.aggregation.lagrangian import facing, lagrangian
from isthmus.core.errors import MissingEngine

from .brute_force import cheapest
from .maps import random_map

try:
    TOOLS = require_highs()
except MissingEngine:
    pytest.skip("scipy is missing or older than 1.9", allow_module_level=True)


@pytest.fixture(autouse=True)
def fewer_rounds(monkeypatch):
    """The bound holds however far the prices have come."""
    monkeypatch.setattr(prices, "LAST_STEP", 0.3)


def bounded(problem, begin, big=None, seconds=60.0):
    """The part of all areas, and what the prices tell about it."""
    n = len(problem.size)
    big = np.zeros(n, dtype=bool) if big is None else big
    part = module._Part(problem, np.flatnonzero(~big), big, begin, TOOLS)
    return part, lagrangian(part, perf_counter() + seconds, lambda share: None)


def maps():
    """Small maps where every area can be helped."""
    seed = 0
    while True:
        problem = random_map(seed)
        if not helpless(problem).any():
            yield problem
        seed += 1


def test_below_the_optimum_and_near_it():
    ratios, ruled_out = [], 0
    for _, problem in zip(range(6), maps()):
        best, begin = cheapest(problem), annealing(problem, iterations=2000)
        part, found = bounded(problem, begin)
        assert found.value <= best * (1.0 + 1e-9)
        ratios.append(found.value / best if best else 1.0)
        ruled_out += found.far.sum()
        # the solution known is optimal here, or nearly: its cores must stay
        if costs(problem, begin).total <= best * (1.0 + 1e-9):
            assert not found.far[part.chosen].any()
    assert np.mean(ratios) > 0.9
    assert min(ratios) > 0.4
    assert ruled_out > 2


def test_a_core_that_is_ruled_out_is_in_no_better_solution():
    """From a poor solution: the best one costs less, so that its cores must be left."""
    better = 0
    for _, problem in zip(range(6), maps()):
        begin = greedy(problem)
        part, found = bounded(problem, begin)
        best = exact(problem, decompose=False).found
        if costs(problem, best).total < costs(problem, begin).total * (1.0 - 1e-6):
            better += 1
            assert not found.far[np.isin(part.cores, best.core)].any()
    assert better > 0


def test_large_areas_that_are_cores_beforehand():
    tried = 0
    for _, problem in zip(range(7), maps()):
        big = enough(problem.size, problem.theta[problem.cls])
        if not big.any() or big.all():
            continue
        begin = greedy(problem)
        result = exact(problem, decompose=True)
        # what is left of the map may be several parts: here they are one, as none depends on it
        part, found = bounded(problem, begin, big)
        constant = module._constant(problem, big, result.found.core[result.found.region], ~big & False)
        best = cheapest(problem, big)
        assert found.value + constant <= best * (1.0 + 1e-9)
        tried += 1
    assert tried > 2


@pytest.mark.parametrize("by_class", [False, True])
def test_exact_is_as_exact_with_it(by_class, monkeypatch):
    """Also where only boundaries between classes count, which prices of areas cannot tell apart."""
    monkeypatch.setattr(module, "FEW_AREAS", 0)
    for seed in range(5):
        problem = random_map(seed, by_class=by_class)
        if helpless(problem).any():
            continue
        result = exact(problem, decompose=False)
        assert result.proven
        assert costs(problem, result.found).total == pytest.approx(cheapest(problem), rel=1e-6)


def test_a_middle_sized_map_has_a_bound_that_means_something():
    problem = random_map(4, n=24)._replace(theta=np.full(3, 40.0))
    begin = annealing(problem, seed=1, iterations=20_000)
    _, found = bounded(problem, begin)  # to the end: how far it comes in two seconds is up to the machine
    total = costs(problem, begin).total
    # each area with the core that suits it best, whatever is large enough and contiguous
    alone = shares(problem, np.arange(24), np.arange(24)).min(axis=1).sum()
    assert max(0.75 * total, 2.0 * alone) < found.value <= total * (1.0 + 1e-9)


def test_it_stops_in_time():
    problem = random_map(4, n=120)._replace(theta=np.full(3, 40.0))
    begun = perf_counter()
    part = module._Part(problem, np.arange(120), np.zeros(120, dtype=bool), greedy(problem), TOOLS)
    found = lagrangian(part, begun + 0.5, lambda share: None)
    assert perf_counter() - begun < 5.0
    assert not found.far.any()


def test_who_faces_a_part():
    # 0 - 1 - 2 - 3, and 4 beyond 3: from 0 only 1 faces the part {2}
    adjacent = [[1], [0, 2], [1, 3], [2, 4], [3]]
    assert facing(adjacent, 0, {1, 3}) == {1}
    assert facing(adjacent, 4, {1, 3}) == {3}

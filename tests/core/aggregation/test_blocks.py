"""The best of two solutions, block by block, against all choices of versions."""

from itertools import product

import numpy as np
import pytest

from isthmus.core.aggregation.annealing import annealing
from isthmus.core.aggregation.blocks import _balanced, best_of_both, block_of_areas
from isthmus.core.aggregation.greedy import greedy, helpless
from isthmus.core.aggregation.instance import Solution, costs, problems

from .maps import random_map


def two_solutions(seed, **options):
    """A map with two solutions that differ in several places."""
    problem = random_map(seed, n=150, **options)._replace(theta=np.full(3, 15.0))
    return problem, annealing(problem, 1, 3000), annealing(problem, 2, 3000)


def mixed(one, other, from_other):
    core = np.where(from_other, other.core[other.region], one.core[one.region])
    cores, region = np.unique(core, return_inverse=True)
    return Solution(region.ravel(), cores)


@pytest.mark.parametrize("seed", range(12))
def test_regions_of_both_cover_the_blocks(seed):
    _, one, other = two_solutions(seed)
    block = block_of_areas(one, other)
    assert sorted(set(block.tolist())) == list(range(block.max() + 1))
    for found in (one, other):
        for r in range(len(found.core)):
            assert len(set(block[found.region == r].tolist())) == 1
    # and no finer ones do: each is linked by its regions
    for b in range(block.max() + 1):
        reached = {np.flatnonzero(block == b)[0]}
        while True:
            more = set(reached)
            for found in (one, other):
                more |= set(np.flatnonzero(np.isin(found.region, found.region[list(reached)])).tolist())
            if more == reached:
                break
            reached = more
        assert reached == set(np.flatnonzero(block == b).tolist())


@pytest.mark.parametrize("by_class", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_the_best_choice_of_all(seed, by_class):
    problem, one, other = two_solutions(seed, by_class=by_class)
    found = best_of_both(problem, one, other)
    total = costs(problem, found).total
    assert total <= min(costs(problem, one).total, costs(problem, other).total) + 1e-9
    lost = helpless(problem)
    assert not [p for p in problems(problem, found) if not lost[found.core[p[0]]]]
    assert sorted(set(found.region.tolist())) == list(range(len(found.core)))
    block = block_of_areas(one, other)
    differ = [
        b for b in range(block.max() + 1)
        if (one.core[one.region] != other.core[other.region])[block == b].any()
    ]
    if len(differ) > 10:
        pytest.skip("too many blocks to try all choices")
    best = min(
        costs(problem, mixed(one, other, np.isin(block, np.array(differ)[list(choice)]))).total
        for choice in map(np.flatnonzero, product([False, True], repeat=len(differ)))
    )
    if by_class:  # exchanged one by one
        assert total >= best - 1e-9
    else:
        assert total == pytest.approx(best)


@pytest.mark.parametrize("seed", range(6))
def test_a_wanted_number_of_regions_stays(seed):
    problem, one, other = two_solutions(seed)
    found = best_of_both(problem, one, other, count=len(one.core))
    assert len(found.core) == len(one.core)
    assert costs(problem, found).total <= costs(problem, one).total + 1e-9
    block = block_of_areas(one, other)
    mine = np.bincount(block[one.core]) == np.bincount(block[other.core])
    alone = [
        costs(problem, mixed(one, other, block == b)).total for b in np.flatnonzero(mine).tolist()
    ]
    assert costs(problem, found).total <= min(alone, default=np.inf) + 1e-9


def test_blocks_with_more_and_fewer_regions_go_in_pairs():
    gain, more = np.array([5.0, -2.0, 1.0, 9.0, 4.0]), np.array([1, -1, -1, 2, 0])
    found = _balanced(gain, more)
    assert (found > 0).tolist() == [True, False, True, False, True]
    assert (_balanced(np.array([5.0, -6.0]), np.array([1, -1])) > 0).tolist() == [False, False]


def test_equal_solutions_stay():
    problem = random_map(3, n=60)
    one = greedy(problem)
    found = best_of_both(problem, one, one)
    assert found.region.tolist() == one.region.tolist()
    assert found.core.tolist() == one.core.tolist()

"""The best of two solutions, block by block, against all choices of versions."""

from itertools import product

import numpy as np
import pytest

from isthmus.core.aggregation.annealing import annealing
from isthmus.core.aggregation.blocks import best_of_both, block_of_areas, cheapest_choice
from isthmus.core.aggregation.greedy import greedy, helpless
from isthmus.core.aggregation.instance import Solution, costs, problems

from .maps import random_map


def two_solutions(seed, **options):
    """A map with two solutions that differ in several places."""
    problem = random_map(seed, n=150, **options)._replace(theta=np.full(3, 15.0))
    return problem, annealing(problem, seed=1, iterations=3000), annealing(problem, seed=2, iterations=3000)


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
        b
        for b in range(block.max() + 1)
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
    alone = [costs(problem, mixed(one, other, block == b)).total for b in np.flatnonzero(mine).tolist()]
    assert costs(problem, found).total <= min(alone, default=np.inf) + 1e-9


@pytest.mark.parametrize("seed", range(40))
def test_the_cheapest_choice_of_all_that_reach_a_number(seed):
    rng = np.random.default_rng(seed)
    number = int(rng.integers(0, 11))
    gain, more = rng.normal(size=number), rng.integers(-4, 5, number)
    gain[rng.random(number) < 0.2] = 0.0
    wanted = int(rng.integers(-6, 7))
    choices = np.array(list(product([False, True], repeat=number))).reshape(2**number, number)
    away = np.abs(choices @ more - wanted)
    nearest = choices[away == away.min()]
    found = cheapest_choice(gain, more, wanted)
    assert abs(found @ more - wanted) == away.min()
    assert found @ gain == pytest.approx(max(nearest @ gain))
    assert not (found & (gain == 0.0) & (more == 0)).any()


def test_a_choice_of_many_blocks_stays_near_the_number():
    rng = np.random.default_rng(1)
    gain, more = rng.random(4000), np.repeat([3, -3], 2000)
    assert cheapest_choice(gain, more, 0).all()
    assert cheapest_choice(gain, more, 2) @ more == 3
    assert cheapest_choice(gain, np.ones(4000, dtype=int), 1500).sum() == 1500


@pytest.mark.parametrize("seed", range(8))
def test_no_choice_of_versions_with_as_many_regions_is_cheaper(seed):
    problem, one, other = two_solutions(seed)
    block = block_of_areas(one, other)
    number = block.max() + 1
    more = np.bincount(block[other.core], minlength=number) - np.bincount(block[one.core], minlength=number)
    differ = [
        b for b in range(number) if (one.core[one.region] != other.core[other.region])[block == b].any()
    ]
    if len(differ) > 10:
        pytest.skip("too many blocks to try all choices")
    for wanted in sorted({len(one.core), len(other.core), len(one.core) + 1}):
        best = (np.inf, np.inf)
        for choice in map(np.flatnonzero, product([False, True], repeat=len(differ))):
            blocks = np.array(differ, dtype=int)[list(choice)]
            total = costs(problem, mixed(one, other, np.isin(block, blocks))).total
            best = min(best, (abs(len(one.core) + int(more[blocks].sum()) - wanted), total))
        found = best_of_both(problem, one, other, wanted)
        assert abs(len(found.core) - wanted) == best[0]
        assert costs(problem, found).total == pytest.approx(best[1])


def test_equal_solutions_stay():
    problem = random_map(3, n=60)
    one = greedy(problem)
    found = best_of_both(problem, one, one)
    assert found.region.tolist() == one.region.tolist()
    assert found.core.tolist() == one.core.tolist()

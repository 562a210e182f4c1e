"""The dual problem and the trade-off curve, against all subsets."""

import math

import numpy as np
import pytest
from isthmus.core.partition import tradeoff
from isthmus.core.partition.solve import finish, prepare, select
from isthmus.core.partition.tradeoff import Joint, OverBudget, joint_solver, paying_steps

from .. import brute_force, shapes, stages


def solver_of(*polygons):
    """The solver of polygons that share a budget, and what they are prepared as."""
    prepared = prepare(stages.together(polygons))
    solve = joint_solver(prepared, np.zeros(len(polygons), dtype=int), 1)
    return (lambda tau: solve([tau])[0]), prepared


def run(search, solve):
    """One search by itself."""
    return tradeoff.together([search], lambda tau: [solve(tau[0])])[0]


def smallest_dilation(solve, budget):
    return run(tradeoff.smallest_dilation(budget), solve)


def trade_off(solve, low, high, most=None):
    return run(tradeoff.trade_off(low, high, most), solve)


def ring_and_candidates(prepared):
    return prepared.polygons.xy, prepared.edges


@pytest.mark.parametrize("seed", range(25))
def test_budget_against_all_subsets(seed):
    s = shapes.tour(seed, 11)
    solve, prepared = solver_of(s)
    for budget in range(9):
        joint, proven = smallest_dilation(solve, budget)
        expected = brute_force.smallest_dilation(
            *ring_and_candidates(prepared), np.ones(len(prepared.edges)), budget
        )
        assert proven
        assert joint.dilation == pytest.approx(expected, rel=1e-9), (seed, budget)
        assert joint.cost <= budget


@pytest.mark.parametrize("seed", range(12))
def test_curve_against_all_subsets(seed):
    s = shapes.tour(100 + seed, 10)
    solve, prepared = solver_of(s)
    curve = trade_off(solve, 1.0, math.inf)
    assert curve.complete
    subset, dilation = brute_force.all_subsets(*ring_and_candidates(prepared))
    least = [dilation[subset.sum(axis=1) <= cost].min() for cost in range(len(prepared.edges) + 1)]
    steps = [k for k in range(len(least)) if k == 0 or least[k] < least[k - 1] * (1 - 1e-11)]
    assert [joint.cost for joint in curve.solutions] == steps
    assert [joint.dilation for joint in curve.solutions] == pytest.approx([least[k] for k in steps], rel=1e-9)


def test_curve_and_budget_agree():
    solve, _ = solver_of(shapes.spiral(3))
    curve = trade_off(solve, 2.0, math.inf)
    assert len(curve.solutions) > 5
    for step in curve.solutions[:-1]:  # the last one may go below the bound
        assert smallest_dilation(solve, step.cost)[0].dilation == step.dilation
    short = trade_off(solve, 2.0, math.inf, most=3)
    assert not short.complete
    assert [j.cost for j in short.solutions] == [j.cost for j in curve.solutions[:3]]


def test_several_polygons_share_a_budget():
    """Two dumbbells need a cut each before the dilation of the pair falls."""
    one, _ = solver_of(shapes.DUMBBELL)
    both, _ = solver_of(shapes.DUMBBELL, shapes.DUMBBELL)
    assert smallest_dilation(both, 1)[0].dilation == smallest_dilation(one, 0)[0].dilation
    assert smallest_dilation(both, 2)[0].dilation == smallest_dilation(one, 1)[0].dilation


def test_holes_need_their_edges():
    solve, prepared = solver_of(shapes.TWO_HOLES)
    answer, proven = smallest_dilation(solve, 1)
    assert proven and answer == OverBudget(2.0)
    joint, _ = smallest_dilation(solve, 4)
    assert joint.cost <= 4
    result = finish(prepared, select(prepared, joint.tau))
    assert result.largest_dilation[0] == joint.dilation


def test_searches_side_by_side_find_what_each_finds():
    polygons = [shapes.tour(seed, 12 + seed) for seed in range(8)]
    prepared = prepare(stages.together(polygons))
    solve = joint_solver(prepared, np.arange(8), 8)
    budgets = [0, 1, 2, 3, 4, 5, 6, 7]
    found = tradeoff.together([tradeoff.smallest_dilation(b) for b in budgets], solve)
    for s, budget, (joint, proven) in zip(polygons, budgets, found):
        alone, _ = smallest_dilation(solver_of(s)[0], budget)
        assert proven and joint.dilation == pytest.approx(alone.dilation, rel=1e-12)


@pytest.mark.parametrize("budget", [0, 3, 30, 300])
def test_a_query_costs_at_most_forty_solutions(budget):
    solve, _ = solver_of(shapes.koch(4))
    calls = []

    def counting(tau):
        calls.append(tau)
        return solve(tau)

    smallest_dilation(counting, budget)
    assert len(calls) <= 40


def test_paying_steps():
    # three good steps, each less so, and then a bad buy before another
    tau = [100.0, 40.0, 18.0, 9.0, 8.9, 5.0]
    cost = [0, 1, 2, 3, 4, 5]
    assert paying_steps(tau, cost) == [1, 2, 3, 5]
    assert paying_steps(tau, cost, most=2) == [1, 2]
    assert paying_steps([64.0, 32.0, 16.0], [0, 1, 2]) == [1, 2]
    assert paying_steps([5.0], [0]) == []


@pytest.mark.parametrize("dilation", [2.0, math.inf, math.nan])
def test_a_dilation_that_does_not_fall_is_the_last(dilation):
    """Rounding may give back the dilation asked to be beaten: that must not go on for ever."""

    def solve(tau):
        return Joint(tau, 1.0, 1.0, dilation)

    assert len(trade_off(solve, 1.0, math.inf).solutions) == 1
    assert smallest_dilation(solve, 1.0)[0].cost == 1.0


def test_two_costs_that_differ_by_rounding_are_one_step():
    def solve(tau):
        for least, cost in ((5.0, 1.0), (4.0, 2.0 * (1 + 1e-11)), (3.0, 2.0), (1.0, 9.0)):
            if tau >= least:
                return Joint(tau, cost, cost, least)

    steps = trade_off(solve, 1.0, math.inf).solutions
    assert [(step.cost, step.dilation) for step in steps] == [(1.0, 5.0), (2.0, 3.0), (9.0, 1.0)]

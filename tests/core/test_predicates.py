from fractions import Fraction
from math import atan2

import numpy as np
import pytest

from isthmus.core.predicates import ccw_order, crossing, orientation, orientations, sort_ccw

ULP = 2.0**-53


def exact(ax, ay, bx, by, cx, cy):
    ax, ay, bx, by, cx, cy = map(Fraction, (ax, ay, bx, by, cx, cy))
    turn = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (turn > 0) - (turn < 0)


def test_orientation_where_floats_fail():
    """Shewchuk's example: points next to the line y = x, a few ulps apart."""
    wrong = 0
    for i in range(16):
        for j in range(16):
            points = (0.5 + i * ULP, 0.5 + j * ULP, 12.0, 12.0, 24.0, 24.0)
            ax, ay, bx, by, cx, cy = points
            assert orientation(*points) == exact(*points)
            wrong += np.sign((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) != exact(*points)
    assert wrong > 20, "these points are no challenge"


@pytest.mark.parametrize(
    "points, turn",
    [
        ((0, 0, 1, 0, 1, 1), 1),
        ((0, 0, 1, 0, 1, -1), -1),
        ((0, 0, 1, 0, 7, 0), 0),
        ((1e16, 1e16, 1e16 + 2, 1e16 + 2, 1e16 + 4, 1e16 + 6), 1),
    ],
)
def test_orientation_by_hand(points, turn):
    assert orientation(*map(float, points)) == turn


@pytest.mark.parametrize("seed", range(5))
def test_sort_ccw_is_angular_order(seed):
    rng = np.random.default_rng(seed)
    origin = tuple(rng.random(2))
    targets = [(x, y, k) for k, (x, y) in enumerate(rng.random((50, 2)).tolist())]
    by_angle = sorted(targets, key=lambda p: atan2(p[1] - origin[1], p[0] - origin[0]) % (2 * np.pi))
    assert sort_ccw(origin, targets) == by_angle


def test_sort_ccw_starts_at_positive_x():
    spokes = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
    assert sort_ccw((0, 0), spokes[5:] + spokes[:5]) == spokes


@pytest.mark.parametrize("seed", range(5))
def test_sort_ccw_of_directions_an_ulp_apart(seed):
    rng = np.random.default_rng(seed)
    spokes = [(12.0 + k * 2.0**-49, 12.0 - k * 2.0**-49) for k in range(-20, 20)]
    shuffled = [spokes[k] for k in rng.permutation(len(spokes))]
    order = sort_ccw((0.5, 0.5), shuffled)
    assert order == spokes[::-1]
    assert all(exact(0.5, 0.5, *a, *b) == 1 for a, b in zip(order, order[1:]))


def test_many_turns_at_once():
    rng = np.random.default_rng(5)
    points = rng.integers(-4, 5, (3, 500, 2)) * ULP + 0.5
    expected = [exact(*a, *b, *c) for a, b, c in zip(*points.tolist())]
    assert orientations(*points).tolist() == expected
    assert 0 < expected.count(0) < 500


def test_segments_cross_where_rational_numbers_say_so():
    rng = np.random.default_rng(6)
    one, other = rng.integers(0, 5, (2, 2000, 2, 2)) * ULP + 0.5
    expected = [
        exact(*a, *b, *c) * exact(*a, *b, *d) < 0 and exact(*c, *d, *a) * exact(*c, *d, *b) < 0
        for (a, b), (c, d) in zip(one.tolist(), other.tolist())
    ]
    assert crossing(one, other).tolist() == expected
    assert any(expected) and not all(expected)


@pytest.mark.parametrize("seed", range(5))
def test_ccw_order_is_that_of_each_group_alone(seed):
    """Among easy groups some that floats cannot sort, and directions along the axes."""
    rng = np.random.default_rng([3, seed])
    group = rng.permutation(np.repeat(np.arange(60), rng.integers(1, 30, 60)))
    centre = rng.integers(-9, 9, (60, 2)) * 0.5
    steps = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (3, 1), (-2, 7)]
    target = np.empty((len(group), 2))
    for g in range(60):
        own = np.flatnonzero(group == g)
        if g % 3 == 0:
            k = rng.permutation(2 * len(own))[: len(own)] - len(own)
            target[own] = 12.0 + np.column_stack((k, -k)) * 2.0**-49
            centre[g] = 0.5, 0.5
        elif g % 3 == 1 and len(own) <= len(steps):
            target[own] = centre[g] + np.array(steps)[rng.permutation(len(steps))[: len(own)]] * 2.0**-g
        else:
            target[own] = rng.random((len(own), 2))
    order = ccw_order(group, centre[group], target)
    assert (np.diff(group[order]) >= 0).all()
    for g in range(60):
        own = order[group[order] == g]
        spokes = [(*target[k].tolist(), k) for k in np.flatnonzero(group == g).tolist()]
        assert own.tolist() == [k for *_, k in sort_ccw(centre[g].tolist(), spokes)]


def test_ccw_order_of_nothing():
    nothing = np.empty((0, 2))
    assert len(ccw_order(np.empty(0, dtype=int), nothing, nothing)) == 0

"""Nested cuts: every level is checked by searches of its own."""

import numpy as np
import pytest

from .. import checker, natural_parts, shapes, stages
from isthmus.core.partition import hierarchy as stage
from isthmus.core.partition.hierarchy import hierarchy, levels
from isthmus.core.partition.solve import finish, prepare, select
from isthmus.core.rings import one_polygon


def ordered(shape, tau):
    prepared = prepare(one_polygon(shape.coords, shape.offsets))
    selection = select(prepared, tau)
    return prepared, selection, hierarchy(prepared, selection)


def true_dilations(prepared, selected):
    """Dilations of all candidates in P and some cuts, by searches that know nothing of the tree."""
    polygons = prepared.polygons
    rings = np.split(polygons.vertex, polygons.offsets[1:-1])
    bounded = prepared.edges[prepared.bounded]
    return checker.dilations(polygons.xy, rings, prepared.edges[selected], bounded)


@pytest.mark.parametrize("seed", range(12))
def test_largest_dilation_of_every_level(seed):
    shape = shapes.tour(seed, 40)
    prepared, selection, found = ordered(shape, 1.6)
    assert (np.sort(found.rank) == np.arange(1, len(found.cut) + 1)).all()
    going = np.argsort(-found.rank)
    assert (np.diff(found.persistence[going]) >= 0.0).all()
    for k in range(len(going) + 1):
        left = found.cut[going[k:]]
        worst = true_dilations(prepared, left).max(initial=1.0)
        if k:
            # the cut that went was needed below its persistence, and no dilation is larger than that
            assert worst <= found.persistence[going[k - 1]] * (1 + 1e-9)
        if k < len(going):
            # of those left, none leaves less: the price of each, from scratch
            price = [true_dilations(prepared, np.delete(left, n)).max() for n in range(len(left))]
            assert found.persistence[going[k]] == pytest.approx(max(min(price), worst))


@pytest.mark.parametrize("seed", range(6))
def test_levels_tile_the_polygon(seed):
    shape = shapes.tour(seed, 60)
    prepared, selection, found = ordered(shape, 1.4)
    parts = finish(prepared, selection).parts
    made = levels(found, parts.sides, len(parts.area), 1.4)
    assert (made.from_tau < made.to_tau).all()
    ends = np.append(found.persistence, 1.4)  # of the solver: where the levels begin is to be shown
    for tau in np.unique(np.append(ends, ends + 1e-6)):
        now = np.flatnonzero((made.from_tau <= tau) & (tau < made.to_tau))
        pieces = np.concatenate([made.pieces[k] for k in now])
        assert (np.sort(pieces) == np.arange(len(parts.area))).all()
        # one part more than cuts that are still needed
        assert len(now) == 1 + np.count_nonzero(found.persistence > tau)
    for k in np.flatnonzero(made.parent >= 0):
        assert np.isin(made.pieces[k], made.pieces[made.parent[k]]).all()
        assert made.to_tau[k] == made.from_tau[made.parent[k]]


def test_result_of_one_does_not_depend_on_the_others():
    several = [shapes.tour(seed, 30) for seed in range(4)]
    alone = [ordered(shape, 1.5)[2] for shape in several]
    prepared = prepare(stages.together(several))
    together = hierarchy(prepared, select(prepared, 1.5))
    assert np.allclose(together.persistence, np.concatenate([one.persistence for one in alone]))
    assert (together.rank == np.concatenate([one.rank for one in alone])).all()


def test_with_holes_persistences_are_upper_bounds_and_the_tree_stays():
    shape = shapes.shape(
        shapes.box(0, 0, 30, 12), shapes.box(4, 4, 8, 8), shapes.box(14, 5, 16, 7), shapes.box(22, 4, 26, 9)
    )
    prepared, selection, found = ordered(shape, 1.5)
    in_tree = np.isin(found.cut, selection.carved.tree)
    assert np.isinf(found.persistence[in_tree]).all() and in_tree.sum() == 3
    for tau in np.unique(found.persistence[~in_tree]):
        left = found.cut[found.persistence > tau]
        assert true_dilations(prepared, left).max() <= tau * (1 + 1e-9)


def test_natural_candidates_have_levels_too():
    dumbbell = shapes.shape(shapes.HALLS)
    prepared = natural_parts.prepare(one_polygon(dumbbell.coords, dumbbell.offsets), 1.0)[0]
    found = hierarchy(prepared, select(prepared, 1.0))
    assert len(found.cut) == 2
    # all is 2 wide: from end to end over the bar and the other cut it is 4 + 2 + 4, and once that is
    # gone, around a square of 10 it is 38
    assert found.persistence.tolist() == pytest.approx([19.0, 5.0] if found.rank[0] == 1 else [5.0, 19.0])


@pytest.mark.parametrize(
    "name, tau", [("tour", 1.4), ("spiral", 1.2), ("comb", 2.0), ("holes", 1.3), ("natural", 1.0)]
)
def test_paths_and_array_calls_tell_the_same(monkeypatch, name, tau):
    shape = {
        "tour": shapes.tour(5, 300),
        "spiral": shapes.spiral(12),
        "comb": shapes.comb(40),
        "holes": shapes.mosaic(3, 150),
        "natural": shapes.tour(6, 300),
    }[name]
    found = []
    for steps in (0, 10**9):  # array calls for all but the largest parts; paths only
        monkeypatch.setattr(stage, "STEPS", steps)
        prepared = prepare(one_polygon(shape.coords, shape.offsets), natural=name == "natural")
        found.append(hierarchy(prepared, select(prepared, tau)))
    assert len(found[0].cut) > 2
    assert np.allclose(found[0].persistence, found[1].persistence, rtol=1e-9)
    if (
        name != "comb"
    ):  # all its cuts are needed as little, and which goes first is a matter of the last digit
        assert (found[0].rank == found[1].rank).all()

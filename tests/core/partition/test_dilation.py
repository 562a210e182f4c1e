import numpy as np
import pytest

from .. import checker
from isthmus.core.partition.dilation import (
    boundary_graph, detours, drop_redundant, largest_dilation, true_dilations,
)
from isthmus.core.metric import planar
from isthmus.core.partition.polygon import one

from .. import shapes, stages
from ..verify import assert_close

NONE = np.empty(0, dtype=np.int64)
CASES = {
    **shapes.TOUCHING,
    "dumbbell": shapes.DUMBBELL,
    "annulus": shapes.ANNULUS,
    "two holes": shapes.TWO_HOLES,
    "lattice of holes": shapes.lattice_of_holes(3),
    **{f"mosaic {seed}": shapes.mosaic(seed, 35) for seed in range(12)},
    **{f"lattice mosaic {seed}": shapes.mosaic(seed, 35, size=7) for seed in range(6)},
    **{f"polyomino {seed}": shapes.polyomino(seed, 6, 6, 0.7, 0.5) for seed in range(8)},
}


def nothing(share=None):
    pass


class Case:
    def __init__(self, name):
        self.name = name
        self.polygon = polygon = one(*CASES[name])
        self.edges = stages.diagonals(polygon)
        self.length = planar().length(polygon.xy, *self.edges.T)
        self.edge_length = planar().length(
            polygon.xy, polygon.vertex, polygon.vertex[polygon.next_corner])

    def graph(self, selected):
        return boundary_graph(self.polygon, self.polygon.xy, self.edge_length, self.edges, self.length, selected)

    def dropped(self, selected, bounded, tau, check):
        """What `drop_redundant` keeps of edges, T among them."""
        prepared = stages.prepared(CASES[self.name])
        assert np.array_equal(prepared.edges, self.edges)
        role = np.zeros(len(self.edges), dtype=int)  # all are selected: none has a witness yet
        return drop_redundant(
            self.graph(selected), self.edges, self.length, selected, self.length, bounded,
            np.full(len(self.edges), tau), prepared.carved, role, np.ones(len(self.edges)), check,
        )

    def expected(self, selected):
        offsets = self.polygon.offsets
        rings = [self.polygon.vertex[a:b] for a, b in zip(offsets[:-1], offsets[1:])]
        return checker.dilations(self.polygon.xy, rings, self.edges[selected], self.edges)

    def some(self, seed, share):
        return np.flatnonzero(np.random.default_rng(seed).random(len(self.edges)) < share)


@pytest.mark.parametrize("name", CASES)
def test_detours(name):
    case = Case(name)
    assert_close(detours(case.polygon, case.edge_length, case.edges, case.length),
                 case.expected(NONE))


@pytest.mark.parametrize("share", [0.0, 0.1, 0.4, 1.0])
@pytest.mark.parametrize("name", CASES)
def test_true_dilations(name, share):
    """With any edges selected, whether they make sense or not."""
    case = Case(name)
    selected = case.some(1, share)
    expected = case.expected(selected)
    bound = np.where(np.isin(np.arange(len(case.edges)), selected), 1.0, np.inf)
    asked = case.graph(selected), case.edges, case.length
    assert_close(true_dilations(*asked, bound, nothing), expected)
    owner = np.zeros(len(case.edges), dtype=int)
    assert largest_dilation(*asked, bound, owner, 1, nothing)[0] == pytest.approx(expected.max())
    closer = np.where(bound > 1, expected * 1.5, 1.0)
    assert_close(true_dilations(*asked, closer, nothing), expected)
    assert largest_dilation(*asked, closer, owner, 1, nothing)[0] == pytest.approx(expected.max())


@pytest.mark.parametrize("tau", [1.0, 1.5, 2.0, 4.0])
@pytest.mark.parametrize("name", CASES)
def test_drop_redundant(name, tau):
    """From all edges down to a solution that can spare none; every second edge is bounded."""
    case = Case(name)
    everything = np.arange(len(case.edges))
    bounded = everything % 2 == 0
    kept = case.dropped(everything, bounded, tau, nothing)
    dilation = case.expected(kept)
    assert np.isfinite(dilation).all(), "all rings are still connected"
    assert (dilation[bounded] <= tau * (1 + 1e-9)).all()
    for k in kept:
        without = case.expected(kept[kept != k])
        assert np.isinf(without[k]) or without[bounded].max() > tau * (1 - 1e-9)


def test_check_may_stop_each_search():
    case = Case("lattice of holes")

    class Stop(Exception):
        pass

    def stop(share=None):
        raise Stop

    bound = np.full(len(case.edges), np.inf)
    asked = case.graph(NONE), case.edges, case.length, bound
    with pytest.raises(Stop):
        true_dilations(*asked, stop)
    with pytest.raises(Stop):
        largest_dilation(*asked, np.zeros(len(bound), dtype=int), 1, stop)
    with pytest.raises(Stop):
        case.dropped(np.arange(len(case.edges)), bound > 0, 2.0, stop)

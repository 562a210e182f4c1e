import numpy as np
import pytest

from .. import checker

from isthmus.core.partition import min_size as objective
from isthmus.core.partition.dual_tree import build_tree
from isthmus.core.partition.min_size import LEAF, ROOT, SELF, min_size, network, witness_lengths

from .. import shapes
from ..brute_force import fewest_cuts

TAUS = [1, 1.5, 2, 3, 4, 6]


@pytest.fixture(params=["by level", "by node"])
def way(request, monkeypatch):
    """Both code paths."""
    monkeypatch.setattr(objective, "NARROW", 0 if request.param == "by level" else 10**9)


def network_of(ring, diagonals, root=0):
    """The network of a simple polygon, its walk starting after edge ``root``.

    Also the diagonal of each node but the first.
    """
    m = len(ring)
    diagonals = np.array(diagonals, dtype=np.int64).reshape(-1, 2)
    i, j = np.sort((diagonals - root) % m, axis=1).T
    walk = np.roll(ring, -root, axis=0)
    step = np.hypot(*(walk - np.roll(walk, -1, axis=0)).T)
    length = np.hypot(*(ring[diagonals[:, 0]] - ring[diagonals[:, 1]]).T)
    walk = np.array([0, m])
    tree = build_tree(walk, i, j)
    return network(tree, walk, step, length), diagonals[tree.diagonal]


def size(ring, diagonals, tau, root=0):
    return int((min_size(network_of(ring, diagonals, root)[0], tau) == SELF).sum()) - 1


def general(seed):
    return shapes.tour(seed, 4 + seed % 10).coords


def lattice(seed):
    """At most 13 lattice points, many collinear or cocircular."""
    for again in range(100):
        found = shapes.mosaic(1000 * again + seed, 9 + seed % 6, 0.6, size=5, holes=False).coords
        if 4 <= len(found) <= 13:
            return found


@pytest.mark.parametrize("share", [1.0, 0.5])
@pytest.mark.parametrize("kind", [general, lattice])
@pytest.mark.parametrize("seed", range(60))
def test_as_few_as_brute_force(kind, seed, share, way):
    ring = kind(seed)
    diagonals = shapes.random_diagonals(ring, seed, share)
    assert [size(ring, diagonals, tau) for tau in TAUS] == fewest_cuts(ring, diagonals, TAUS)


@pytest.mark.parametrize("tau", TAUS)
@pytest.mark.parametrize("seed", range(6))
def test_size_does_not_depend_on_the_root_edge(seed, tau, way):
    ring = shapes.tour(seed, 25).coords
    diagonals = shapes.random_diagonals(ring, seed)
    assert len({size(ring, diagonals, tau, root) for root in range(25)}) == 1


@pytest.mark.parametrize("tau", TAUS)
@pytest.mark.parametrize("seed", range(6))
def test_nor_on_lattices_where_ties_are_common(seed, tau, way):
    ring = shapes.mosaic(seed, 40, 0.7, size=7, holes=False).coords * 0.1
    diagonals = shapes.random_diagonals(np.rint(ring * 10), seed)
    assert len({size(ring, diagonals, tau, root) for root in range(len(ring))}) == 1


@pytest.mark.parametrize("tau", TAUS)
@pytest.mark.parametrize("seed", range(10))
def test_each_role_has_its_witness(seed, tau, way):
    net, _ = network_of(
        shapes.tour(seed, 30).coords, shapes.random_diagonals(shapes.tour(seed, 30).coords, seed)
    )
    role = min_size(net, tau)
    below, above = witness_lengths(net, role == SELF)
    allowed = tau * net.length * (1 + 1e-9)
    assert (below[role == LEAF] <= allowed[role == LEAF]).all()
    assert (above[role == ROOT] <= allowed[role == ROOT]).all()


@pytest.mark.parametrize("seed", range(10))
def test_both_ways_assign_the_same_roles(seed, monkeypatch):
    ring = shapes.tour(seed, 60).coords
    net, _ = network_of(ring, shapes.random_diagonals(ring, seed, 0.8))
    roles = []
    for narrow in (0, 10**9):
        monkeypatch.setattr(objective, "NARROW", narrow)
        roles.append([min_size(net, tau) for tau in TAUS])
    assert np.array_equal(*roles)


@pytest.mark.parametrize("seed", range(10))
def test_witness_lengths_are_shortest_paths(seed, way):
    """With any cuts at all, not only good ones."""
    ring = shapes.tour(seed, 20).coords
    net, diagonals = network_of(ring, shapes.random_diagonals(ring, seed, 0.8))
    cut = np.append(True, np.random.default_rng(seed).random(len(diagonals)) < 0.3)
    below, above = witness_lengths(net, cut)
    open_ = ~cut[1:]
    expected = checker.dilations(ring, [np.arange(20)], diagonals[cut[1:]], diagonals[open_])
    actual = (np.minimum(below, above)[1:] / net.length[1:])[open_]
    assert np.allclose(actual, expected, rtol=1e-12)


@pytest.mark.parametrize("tau, cuts", [(1.1 - 1e-9, 1), (1.1, 0), (1.2, 0)])
def test_a_tie_is_allowed(tau, cuts, way):
    """A diagonal of length 10, a path of 12 on one side, and one of 5 + 6 on the root's side."""
    walk = np.array([0, 4])
    tree = build_tree(walk, np.array([1]), np.array([3]))
    net = network(tree, walk, np.array([6.0, 6.0, 6.0, 5.0]), np.array([10.0]))
    assert (min_size(net, tau) == SELF).sum() - 1 == cuts


def test_check_is_called(way):
    """On a corridor, where the tree is deep."""
    m = 140_000
    i = np.arange(m // 2 - 1)
    walk = np.array([0, m])
    net = network(build_tree(walk, i, m - 2 - i), walk, np.ones(m), np.ones(len(i)))

    class Stop(Exception):
        pass

    def check(share=None):
        raise Stop

    with pytest.raises(Stop):
        min_size(net, 2.0, check)
    with pytest.raises(Stop):
        witness_lengths(net, np.ones(len(net.length), dtype=bool), check)

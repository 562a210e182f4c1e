import numpy as np
import pytest

from isthmus.core.partition.dual_tree import build_tree


def random_brackets(seed, m, share):
    """Non-crossing intervals of places 0..m-1, in any order: no sides and not the root edge."""
    rng = np.random.default_rng(seed)
    found = []

    def split(lo, hi):
        if hi - lo < 2:
            return
        if (lo, hi) != (0, m - 1) and rng.random() < share:
            found.append((lo, hi))
        middle = int(rng.integers(lo + 1, hi))
        split(lo, middle)
        split(middle, hi)

    split(0, m - 1)
    return rng.permutation(np.array(found, dtype=np.int64).reshape(-1, 2))


def narrowest(intervals, lo, hi):
    """The smallest interval around lo..hi other than that one itself; None for the root."""
    around = [(b - a, k) for k, (a, b) in enumerate(intervals) if a <= lo and hi <= b and (a, b) != (lo, hi)]
    return min(around)[1] if around else None


@pytest.mark.parametrize("share", [1.0, 0.6, 0.2])
@pytest.mark.parametrize("m, seed", [(m, seed) for m in (3, 4, 5, 9, 30, 100) for seed in range(4)])
def test_nesting_by_definition(m, seed, share):
    intervals = random_brackets(seed, m, share)
    i, j = intervals.T
    tree = build_tree(np.array([0, m]), i, j)
    interval_of = [None] + tree.diagonal.tolist()

    assert sorted(tree.diagonal.tolist()) == list(range(len(intervals)))
    assert tree.parent[0] == -1
    pairs = list(zip(i.tolist(), j.tolist()))
    for node in range(1, len(pairs) + 1):
        assert interval_of[tree.parent[node]] == narrowest(pairs, *pairs[interval_of[node]])
    assert [interval_of[node] for node in tree.edge_face[:-1]] == [
        narrowest(pairs, place, place + 1) for place in range(m - 1)
    ]


@pytest.mark.parametrize("seed", range(4))
def test_levels_run_down_the_tree(seed):
    tree = build_tree(np.array([0, 60]), *random_brackets(seed, 60, 0.8).T)
    depth = np.zeros(len(tree.parent), dtype=int)
    for node in range(1, len(depth)):
        depth[node] = depth[tree.parent[node]] + 1
    assert np.array_equal(np.repeat(np.arange(len(tree.level_start) - 1), np.diff(tree.level_start)), depth)
    assert (np.diff(tree.parent) >= 0).all(), "siblings stand together"


def test_no_diagonals():
    tree = build_tree(np.array([0, 3]), np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64))
    assert tree.parent.tolist() == [-1]
    assert tree.edge_face.tolist() == [0, 0, 0]


def test_deeper_than_a_short_integer():
    m = 70_000 * 2
    i = np.arange(70_000 - 1)
    tree = build_tree(np.array([0, m]), i, m - 2 - i)
    assert np.array_equal(tree.parent, np.arange(-1, len(i)))


@pytest.mark.parametrize("seed", range(20))
def test_a_forest_is_its_trees(seed):
    """Each tree of a forest is the one that its walk alone gives."""
    rng = np.random.default_rng(seed)
    sizes = rng.integers(3, 40, rng.integers(1, 9))
    brackets = [random_brackets(seed + k, int(m), 0.7) for k, m in enumerate(sizes)]
    offsets = np.append(0, np.cumsum(sizes))
    i, j = np.concatenate([one + at for one, at in zip(brackets, offsets)]).T
    forest = build_tree(offsets, i, j)
    first = np.append(0, np.cumsum([len(one) for one in brackets]))
    assert forest.roots == len(sizes) and (np.diff(forest.parent) >= 0).all()
    for k, own in enumerate(brackets):
        tree = build_tree(np.array([0, sizes[k]]), *own.T)
        # nodes by the diagonal that they are, -1 for the root
        name = np.append(np.full(len(sizes), -1), forest.diagonal - first[k])
        mine = np.flatnonzero((name >= 0) & (name < len(own)) & (np.arange(len(name)) >= len(sizes)))
        parents = dict(zip(name[mine].tolist(), name[forest.parent[mine]].tolist()))
        alone = np.append(-1, tree.diagonal)
        assert parents == dict(zip(alone[1:].tolist(), alone[tree.parent[1:]].tolist()))
        faces = forest.edge_face[offsets[k] : offsets[k + 1]]
        assert name[faces].tolist() == alone[tree.edge_face].tolist()
        assert (faces[name[faces] < 0] == k).all()

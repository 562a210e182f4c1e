"""Small maps for the tests."""

import numpy as np
from isthmus.core.aggregation.instance import build


def grid(rows, columns):
    """Pairs of neighbours in a grid."""
    number = np.arange(rows * columns).reshape(rows, columns)
    return np.concatenate(
        (
            np.column_stack((number[:, :-1].ravel(), number[:, 1:].ravel())),
            np.column_stack((number[:-1].ravel(), number[1:].ravel())),
        )
    )


def random_map(seed, n=None, by_class=False, boundary=1.0, centre=0.05, classes=3):
    """A random connected planar-like map: a grid with some of its areas missing."""
    rng = np.random.default_rng(seed)
    n = n or int(rng.integers(2, 9))
    columns = int(np.ceil(np.sqrt(n)))
    pairs = grid((n + columns - 1) // columns, columns)
    pairs = pairs[(pairs < n).all(axis=1)]
    pairs = pairs[rng.random(len(pairs)) < 0.85]
    size = rng.integers(1, 20, n).astype(float)
    distance = rng.integers(1, 5, (classes, classes)).astype(float)
    np.fill_diagonal(distance, 0.0)
    theta = rng.choice([5.0, 12.0, 20.0, np.inf], classes, p=[0.3, 0.3, 0.3, 0.1])
    place = np.arange(n) % columns + 1j * (np.arange(n) // columns) + rng.random(n) * 0.3
    found = build(
        size,
        rng.integers(classes, size=n),
        place * 5.0,
        pairs,
        rng.random(len(pairs)) * 4 + 1,
        distance,
        theta,
        boundary=boundary,
        centre=centre,
        by_class=by_class,
    )
    return found._replace(spread=rng.random(n) * 9.0)

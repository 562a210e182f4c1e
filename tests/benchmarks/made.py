"""Made polygons for benchmarks; rings as the core takes them, the same in every run."""

import numpy as np

__all__ = ["buildings", "cheese", "lakes", "plate_with_holes"]


def cheese(holes, seed=1):
    """A square with round holes of many sizes at random places, as in CG:SHOP's cheeses.

    Returns coordinates and ring offsets; about 4.5 vertices a hole.
    """
    rng = np.random.default_rng([seed, holes])
    side = np.sqrt(holes)
    centre = np.empty((holes, 2))
    radius = np.empty(holes)
    # a grid of cells of the largest reach finds the neighbours of a hole
    cells, placed = {}, 0
    while placed < holes:
        for x, y, r in zip(
            *(rng.random((2, holes)) * side), rng.choice([0.1, 0.2, 0.35, 0.5], holes, p=[0.4, 0.3, 0.2, 0.1])
        ):
            a, b = int(x), int(y)
            near = [k for i in (a - 1, a, a + 1) for j in (b - 1, b, b + 1) for k in cells.get((i, j), ())]
            if not all(np.hypot(*(centre[k] - (x, y))) > radius[k] + r + 0.02 for k in near):
                continue
            centre[placed], radius[placed] = (x, y), r
            cells.setdefault((a, b), []).append(placed)
            placed += 1
            if placed == holes:
                break
    corners = np.where(radius > 0.3, rng.integers(6, 9, holes), rng.integers(3, 6, holes))
    return _plate(np.array([-1.0, -1.0, side + 1.0, side + 1.0]), centre, radius, corners, rng)


def plate_with_holes(count, seed=1):
    """A square plate with octagonal holes on a jittered grid."""
    rng = np.random.default_rng([seed, count])
    side = int(np.ceil(np.sqrt(count)))
    cell = np.arange(count)
    centre = np.column_stack((cell % side, cell // side)) + 0.5 + rng.uniform(-0.15, 0.15, (count, 2))
    radius = rng.uniform(0.1, 0.3, count)
    return _plate(np.array([0.0, 0.0, side, side]), centre, radius, np.full(count, 8), rng)


def _plate(box, centre, radius, corners, rng):
    """A box with clockwise regular holes."""
    hole = np.repeat(np.arange(len(corners)), corners)
    start = np.cumsum(corners) - corners
    turn = (np.arange(len(hole)) - start[hole]) / corners[hole] + rng.random(len(corners))[hole]
    ring = np.column_stack((np.cos(turn * 2 * np.pi), -np.sin(turn * 2 * np.pi)))
    x0, y0, x1, y1 = box
    shell = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    coords = np.concatenate((shell, centre[hole] + radius[hole][:, None] * ring))
    return coords, np.append(0, 4 + np.append(0, np.cumsum(corners)))


def buildings(count, seed=1):
    """Outlines of 4 to 16 vertices, as buildings have them: boxes with wings, bays and annexes."""
    rng = np.random.default_rng([seed, count])
    for number in range(count):
        w, h = rng.uniform(6, 24, 2)
        kind = number % 5
        if kind == 0:
            ring = [(0, 0), (w, 0), (w, h), (0, h)]
        elif kind == 1:
            a, b = rng.uniform(0.2, 0.8, 2)
            ring = [(0, 0), (w, 0), (w, b * h), (a * w, b * h), (a * w, h), (0, h)]
        elif kind == 2:  # two wings joined by a passage
            a, b = rng.uniform(0.05, 0.4, 2)
            ring = [
                (0, 0),
                (w / 3, 0),
                (w / 3, a * h),
                (w * 0.6, a * h),
                (w * 0.6, 0),
                (w, 0),
                (w, h),
                (w * 0.7, h),
                (w * 0.7, h * (1 - b)),
                (w * 0.2, h * (1 - b)),
                (w * 0.2, h),
                (0, h),
            ]
        elif kind == 3:  # a bay and a chimney
            a, b = rng.uniform(0.05, 0.3, 2)
            ring = [
                (0, 0),
                (w * 0.45, 0),
                (w * 0.45, -a),
                (w * 0.5, -a),
                (w * 0.5, 0),
                (w, 0),
                (w, h),
                (w * 0.8, h),
                (w * 0.8, h + b * h),
                (w * 0.6, h + b * h),
                (w * 0.6, h),
                (0, h),
            ]
        else:  # an annex
            a = rng.uniform(0.1, 0.9)
            ring = [(0, 0), (w, 0), (w, a * h), (w * 1.3, a * h), (w * 1.3, h), (0, h)]
        turn = np.exp(1j * rng.uniform(0, 2 * np.pi))
        place = rng.uniform(0, 1e5, 2)
        z = (np.array(ring) @ [1, 1j]) * turn
        yield np.column_stack((z.real, z.imag)) + place, [0, len(ring)]


def lakes(count, seed=1):
    """Wavy outlines of 20 to 200 vertices with bays and necks: a smooth random walk of the radius."""
    rng = np.random.default_rng([seed, count])
    for _ in range(count):
        n = int(rng.integers(20, 201))
        angle = 2 * np.pi * (np.arange(n) + rng.uniform(0.0, 0.9, n)) / n
        radius = np.ones(n)
        for wave in range(2, 9):
            radius += rng.normal(0, 0.9 / wave) * np.cos(wave * angle + rng.uniform(0, 2 * np.pi))
        radius = np.maximum(radius, 0.05) * rng.lognormal(5.0, 1.0)
        stretch = rng.uniform(0.3, 1.0)
        ring = np.column_stack((radius * np.cos(angle), stretch * radius * np.sin(angle)))
        yield ring + rng.uniform(0, 1e6, 2), [0, n]

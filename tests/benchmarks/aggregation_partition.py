"""The paper's experiment: the same annealing, the same steps, with and without partition.

    python tests/benchmarks/aggregation_partition.py [--samples 9] [--skip 0] [--seeds 2] [--first 1]
        [--steps 1000] [--tau 2.5] [--natural 0.01] [--factors 1 0.25] [--whole 4000000]
        [--recorded] [--out build/aggregation]

``--recorded``: instead, what window 4 costs with light compactness, where a schedule that is too cold shows;
fails above 395 ha.

Writes partition.md. Samples are compact groups of about 325 areas; each run has ``steps`` a piece, the
same with and without partition. ``factors`` multiply the weights of boundary and centre distance: the
lower, the more of the cost is class change. ``natural``: cuts where people would cut, and no part below
this share of its area.

Two comparisons: as they are, each solution by the areas it was made of; and on the same ground, the
solution of the whole areas measured on the pieces too, with the best cores there.
"""

import argparse
import sys
from pathlib import Path
from time import process_time

import numpy as np
from aggregation_data import NOTES, ROOT, WEIGHTS, buchholz, by_centroids, pieces

from isthmus.core.aggregation.annealing import annealing
from isthmus.core.aggregation.greedy import adjacency
from isthmus.core.aggregation.instance import costs, solution


def sample(problem, root, count):
    """Areas around one, in the order of a breadth-first search."""
    adjacent, found, seen = adjacency(problem), [root], {root}
    for v in found:
        for u in adjacent[v]:
            if u not in seen and len(found) < count:
                seen.add(u)
                found.append(u)
    return np.array(sorted(found))


def windows(problem, count, areas):
    """Groups of areas around the corners, the middle and the sides of a square."""
    middle = np.median(problem.place.real) + 1j * np.median(problem.place.imag)
    corners = [x + 1j * y for x in (-1, 1) for y in (-1, 1)]
    around = [*corners, 0, -1, 1, -1j, 1j]
    roots = [int(np.argmin(np.abs(problem.place - middle - 8000.0 * c))) for c in around]
    return [sample(problem, root, areas) for root in roots[:count]]


PARTS = (
    lambda cost: cost.total,
    lambda cost: cost.change,
    lambda cost: cost.boundary + cost.centre,
)


def compare(plain, split, owner, seed, steps):
    """Percent that partition changes, as they are and on the same ground; the share of class change."""
    whole = annealing(plain, seed=seed, iterations=steps)
    cut = annealing(split, seed=seed, iterations=steps)
    raw, new = costs(plain, whole), costs(split, cut)
    ground = costs(split, solution(split, whole.region[owner]))
    percent = [100.0 * (share(new) / share(old) - 1.0) for old in (raw, ground) for share in PARTS]
    return percent, 100.0 * ground.change / ground.total


def recorded(seeds, most=395.0):
    """Window 4 at a quarter of the weights of the notes and with their measure, a million steps."""
    shapes, classes, _, _, build = buchholz()
    group = windows(build(shapes, classes), 4, 325)[3]
    light = {"boundary": NOTES["boundary"] / 4, "centre": NOTES["centre"] / 4}
    problem = by_centroids(build(shapes[group], classes[group]))._replace(**light)
    found = [
        costs(problem, annealing(problem, seed=seed, iterations=1_000_000)).total / 1e4 for seed in seeds
    ]
    print("window 4: " + ", ".join(f"{cost:.2f} ha" for cost in found) + f" (to reach: {most:g})")
    return max(found) <= most


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--samples", type=int, default=9)
    parser.add_argument("--skip", type=int, default=0, help="samples that were run before")
    parser.add_argument("--areas", type=int, default=325)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    parser.add_argument("--steps", type=int, default=1000, help="steps a piece, in the samples")
    parser.add_argument("--tau", type=float, default=2.5)
    parser.add_argument("--natural", type=float, help="share of the smallest part")
    parser.add_argument("--factors", type=float, nargs="+", default=[1.0, 0.25])
    parser.add_argument("--whole", type=int, default=4_000_000, help="steps of the whole map; 0: not")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "aggregation")
    parser.add_argument("--recorded", action="store_true")
    options = parser.parse_args()
    if options.recorded:
        sys.exit(not recorded(range(options.first, options.first + options.seeds)))
    options.out.mkdir(parents=True, exist_ok=True)
    shapes, classes, _, _, build = buchholz()
    everything = build(shapes, classes)
    groups = [
        (f"sample {k + 1}", group, None)
        for k, group in enumerate(windows(everything, options.samples, options.areas))
        if k >= options.skip
    ]
    if options.whole:
        groups.append(("whole map", np.arange(len(shapes)), options.whole))
    lines = [
        "| map | areas | pieces | weights | steps | seed | change of total | as they are: total "
        "| class change | non-compactness | same ground: total | class change | non-compactness | CPU s |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|",
        "| paper | 325 | 881 | | 8.81 M | | 57 % | -7.1 % | -3.2 % | -12.2 % | | | | |",
    ]
    print("\n".join(lines), flush=True)
    found = {}
    for name, group, steps in groups:
        parts, owner = pieces(shapes[group], options.tau, options.natural)
        plain, split = build(shapes[group], classes[group]), build(parts, classes[group][owner])
        steps = steps or options.steps * len(parts)
        for factor in options.factors:
            weights = {"boundary": factor * WEIGHTS["boundary"], "centre": factor * WEIGHTS["centre"]}
            for seed in range(options.first, options.first + options.seeds):
                began = process_time()
                percent, share = compare(
                    plain._replace(**weights), split._replace(**weights), owner, seed, steps
                )
                found.setdefault((name != "whole map", factor), []).append([share, *percent])
                lines.append(
                    f"| {name} | {len(group)} | {len(parts)} | x {factor:g} | {steps / 1e6:.2f} M "
                    f"| {seed} | {share:.0f} % "
                    + "".join(f"| {p:+.1f} % " for p in percent)
                    + f"| {process_time() - began:.0f} |"
                )
                print(lines[-1], flush=True)
                (options.out / "partition.md").write_text("\n".join(lines) + "\n")
    for (small, factor), rows in found.items():
        rows = np.array(rows)
        cells = "".join(
            f"| {m:+.1f} % ({lo:+.1f}..{hi:+.1f}) "
            for m, lo, hi in zip(*(f(rows[:, 1:], axis=0) for f in (np.mean, np.min, np.max)))
        )
        lines.append(
            f"| mean (range) of {'the samples' if small else 'the whole map'} | | | x {factor:g} | | "
            f"| {rows[:, 0].mean():.0f} % {cells}| |"
        )
        print(lines[-1], flush=True)
    (options.out / "partition.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()

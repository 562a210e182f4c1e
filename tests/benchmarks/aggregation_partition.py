"""The paper's experiment: the same annealing, the same steps, with and without partition.

    python tests/benchmarks/aggregation_partition.py [--samples 4] [--seeds 3] [--steps 10000]
        [--whole 20000000] [--out build/aggregation]

Writes partition.md. Samples are compact groups of about 325 areas; each run has ``steps`` a piece.

The centre distance of an area in one piece is that of its centroid; cut in pieces, the same area in
the same region costs more. So the costs with and without partition are compared twice: as they are,
and with the solution of the whole areas measured on the pieces, too ("same ground").
"""

import argparse
from pathlib import Path
from time import perf_counter

import numpy as np
from aggregation_data import ROOT, buchholz, pieces

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


PARTS = (
    lambda cost: cost.total,
    lambda cost: cost.change,
    lambda cost: cost.boundary + cost.centre,
    lambda cost: cost.boundary,
)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--samples", type=int, default=3)
    parser.add_argument("--areas", type=int, default=325)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--steps", type=int, default=10_000, help="steps a piece, in the samples")
    parser.add_argument("--whole", type=int, default=20_000_000, help="steps of the whole map; 0: not")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "aggregation")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    shapes, classes, _, _, build = buchholz()
    everything = build(shapes, classes)
    middle = np.median(everything.place.real) + 1j * np.median(everything.place.imag)
    reach = 8000.0
    corners = [reach * (x + 1j * y) for x in (-1, 1) for y in (-1, 1)]
    roots = [int(np.argmin(np.abs(everything.place - middle - c))) for c in [*corners, 0]]
    groups = [
        (f"sample {k + 1}", sample(everything, root, options.areas), None)
        for k, root in enumerate(roots[:options.samples])
    ]
    if options.whole:
        groups.append(("whole map", np.arange(len(shapes)), options.whole))
    lines = [
        "| map | areas | pieces | steps | seed | as they are: total | class change | non-compactness "
        "| same ground: total | class change | non-compactness | boundary | seconds without, with |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|",
        "| paper | 325 | 881 | 8.81 M | | -7.1 % | -3.2 % | -12.2 % | | | | | |",
    ]
    print("\n".join(lines), flush=True)
    change = {}
    for name, group, steps in groups:
        parts, owner = pieces(shapes[group])
        plain = build(shapes[group], classes[group])
        split = build(parts, classes[group][owner])
        steps = steps or options.steps * len(parts)
        for seed in range(1, options.seeds + 1):
            found, times = [], []
            for problem in (plain, split):
                began = perf_counter()
                found.append(annealing(problem, seed=seed, iterations=steps))
                times.append(perf_counter() - began)
            raw, ground, new = (
                costs(problem, one)
                for problem, one in (
                    (plain, found[0]),
                    (split, solution(split, found[0].region[owner])),
                    (split, found[1]),
                )
            )
            percent = [
                100.0 * (share(new) / share(old) - 1.0)
                for old, parts_of in ((raw, PARTS[:3]), (ground, PARTS))
                for share in parts_of
            ]
            change.setdefault(name != "whole map", []).append(percent)
            lines.append(
                f"| {name} | {len(group)} | {len(parts)} | {steps / 1e6:.2f} M | {seed} "
                + "".join(f"| {p:+.1f} % " for p in percent)
                + f"| {times[0]:.0f}, {times[1]:.0f} |"
            )
            print(lines[-1], flush=True)
            (options.out / "partition.md").write_text("\n".join(lines) + "\n")
    for small, percents in change.items():
        mean, spread = np.mean(percents, axis=0), np.std(percents, axis=0)
        lines.append(
            f"| mean of {'the samples' if small else 'the whole map'} (standard deviation) | | | | "
            + "".join(f"| {m:+.1f} % ({s:.1f}) " for m, s in zip(mean, spread)) + "| |"
        )
        print(lines[-1], flush=True)
    (options.out / "partition.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()

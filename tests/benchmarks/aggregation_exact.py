"""Exact against annealing and greedy on small instances cut from the published map.

    python tests/benchmarks/aggregation_exact.py [--seconds 60] [--out build/aggregation]

Writes exact.md.
"""

import argparse
from pathlib import Path
from time import process_time

import numpy as np
from aggregation_data import ROOT, buchholz
from aggregation_partition import sample

from isthmus.core.aggregation.annealing import annealing
from isthmus.core.aggregation.exact import exact
from isthmus.core.aggregation.greedy import greedy, helpless
from isthmus.core.aggregation.instance import costs


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--instances", type=int, default=12, help="for each number of areas")
    parser.add_argument("--sizes", type=int, nargs="+", default=[12, 16, 20])
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "aggregation")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    shapes, classes, _, _, build = buchholz()
    everything = build(shapes, classes)
    random = np.random.default_rng(0)
    lines = [
        "| areas | regions | exact | lower bound | proven | annealing | greedy | seconds exact, annealing |",
        "|---|---|---|---|---|---|---|---|",
    ]
    print("\n".join(lines), flush=True)
    gaps, bounds = [], []
    for count in options.sizes:
        done = 0
        while done < options.instances:
            group = sample(everything, int(random.integers(len(shapes))), count)
            problem = build(shapes[group], classes[group])
            if len(group) < count or helpless(problem).any():
                continue
            done += 1
            began = process_time()
            second = annealing(problem, seed=1)
            middle = process_time()
            result = exact(problem, seconds=options.seconds, decompose=False, begin=second)
            end = process_time()
            best, low = costs(problem, result.found).total, result.bound
            bounds.append(low / best)
            others = [costs(problem, found).total for found in (second, greedy(problem))]
            percent = [100 * (value / low - 1) for value in (best, *others)]
            if result.proven:
                gaps.append(percent)
            lines.append(
                f"| {count} | {len(result.found.core)} | {best:.0f} | {low:.0f} "
                f"| {'yes' if result.proven else f'gap {percent[0]:.2f} %'} "
                f"| {percent[1]:+.3f} % | {percent[2]:+.2f} % | {end - middle:.1f}, {middle - began:.1f} |"
            )
            print(lines[-1], flush=True)
    gaps = np.array(gaps).reshape(-1, 3)
    lines.append(f"\n{len(gaps)} proven; the bounds are {100 * min(bounds):.1f} % of the cost or more.")
    if len(gaps):
        lines.append(
            f"Above the optimum: annealing {gaps[:, 1].mean():.3f} % on average "
            f"(most {gaps[:, 1].max():.3f} %, optimal in {(gaps[:, 1] < 1e-4).sum()}), greedy "
            f"{gaps[:, 2].mean():.2f} % (most {gaps[:, 2].max():.2f} %, optimal in "
            f"{(gaps[:, 2] < 1e-4).sum()})."
        )
    print(lines[-1])
    (options.out / "exact.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()

"""How good and how fast MinLength and budgets are, beside what others would do.

    ./run python tests/benchmarks/weighted.py [--quick] [--note]

Western Europe (committed) and Eurasia of GSHHG (see gshhg.py for the packages to install). Seconds
are those of the processor, on one core. For each tau:

* proven: cost, gap to the proven lower bound, seconds;
* MinSize: its number of cuts, and how much longer they are;
* greedy: van Dijk et al. (2013) add the diagonal of largest dilation until all are within tau;
* rounding: the paper's scheme (section 4.4) takes sum w(e)^2 steps for lengths rounded to integers
  w(e). At a generous 10^8 steps a second, this is the length of its optimum for the finest rounding
  that it could afford in the same time.

--quick leaves out Eurasia at full resolution. --note writes the numbers to docs/measured/weighted.json,
from where the README takes them.
"""

import argparse
import math
import resource
import sys
import time
from pathlib import Path

import gshhg
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import conftest  # noqa: E402

from isthmus.core.partition import min_weight  # noqa: E402
from isthmus.core.partition.tradeoff import joint_solver, smallest_dilation, together  # noqa: E402
from isthmus.core.rings import one_polygon  # noqa: E402
from isthmus.core.partition.min_size import SLACK, witness_lengths  # noqa: E402
from isthmus.core.partition.solve import prepare, select  # noqa: E402

sys.path.insert(0, str(conftest.ROOT / "tools"))
from measured import note  # noqa: E402

STEPS_PER_SECOND = 1e8

min_weight.time.monotonic = time.process_time  # the limit counts what is reported


def western_europe():
    path = conftest.ROOT / "tests" / "data" / "western_europe.csv"
    ring = np.loadtxt(path, delimiter=",", skiprows=1)
    return gshhg.sinusoidal(ring, 10.0)


def greedy(prepared, tau):
    """Edges of the greedy solution: O(n) a cut."""
    net = prepared.carved.net
    cut = np.zeros(len(net.length), dtype=bool)
    cut[0] = True
    while True:
        below, above = witness_lengths(net, cut)
        dilation = np.where(cut, 1.0, np.minimum(below, above) / net.length)
        worst = int(np.argmax(dilation))
        if dilation[worst] <= tau * (1.0 + SLACK):
            return prepared.carved.node_edge[cut[1:]]
        cut[worst] = True


def rounded(prepared, tau, seconds):
    """Length of an optimum for rounded lengths, and the rounding step."""
    steps = STEPS_PER_SECOND * seconds
    low, high = prepared.length.min() / 100.0, prepared.length.max()
    for _ in range(60):  # the finest step with sum w^2 <= steps
        step = math.sqrt(low * high)
        if (np.rint(prepared.length / step) ** 2).sum() > steps:
            low = step
        else:
            high = step
    solution = select(prepared, tau, weight=np.rint(prepared.length / high), max_gap=1e-3, time_limit=60.0)
    return prepared.length[solution.selected].sum(), high


def measure(name, ring, taus, max_gap, limit, baselines):
    start = time.process_time()
    prepared = prepare(one_polygon(ring, [0, len(ring)]))
    print(f"\n{name}: {len(ring):,} vertices, prepared in {time.process_time() - start:.1f} s")
    noted = {"vertices": len(ring)}
    for tau in taus:
        start = time.process_time()
        best = select(prepared, tau, weight=prepared.length, max_gap=max_gap, time_limit=limit)
        best = best._replace(cost=best.cost[0], lower_bound=best.lower_bound[0])
        seconds = time.process_time() - start
        gap = 100.0 * (best.cost - best.lower_bound) / best.cost
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2
        print(
            f"  tau {tau:>3}: {best.cost:12.4f} km, {len(best.selected):,} cuts, gap {gap:.4f} %, "
            f"{seconds:.1f} s, {peak:.2f} GB so far",
            flush=True,
        )

        noted[f"tau_{tau}"] = row = {
            "km": round(best.cost, 4), "cuts": len(best.selected), "gap": round(gap, 4),
            "seconds": round(seconds, 1), "gb": round(peak, 2),
        }  # fmt: skip

        def beside(label, edges, prepared=prepared, best=best, row=row):
            length = prepared.length[edges].sum()
            row[label] = {"km": round(length, 4), "cuts": len(edges)}
            more = 100.0 * (length / best.cost - 1.0)
            print(f"      {label:10} {length:12.4f} km (+{more:.2f} %), {len(edges):,} cuts")

        beside("MinSize", select(prepared, tau).selected)
        if baselines:
            beside("greedy", greedy(prepared, tau))
            length, step = rounded(prepared, tau, seconds)
            more = 100.0 * (length / best.cost - 1.0)
            print(f"      rounding   {length:12.4f} km (+{more:.2f} %), to {step:.3g} km", flush=True)
    seconds = [row["seconds"] for row in noted.values() if isinstance(row, dict)]
    noted |= {"fastest": min(seconds), "slowest": max(seconds)}
    return prepared, noted


def budgets(prepared):
    """How many solutions a budget query takes, and how long beside one of them."""
    solve = joint_solver(prepared, np.zeros(1, dtype=int), 1)
    start = time.process_time()
    for _ in range(10):
        solve([4.0])
    one = (time.process_time() - start) / 10
    times = []
    for budget in (1, 10, 40, 151, 509):
        calls = []

        def counting(tau, calls=calls):
            calls.append(tau)
            return solve(tau)

        start = time.process_time()
        answer, _ = together([smallest_dilation(budget)], counting)[0]
        seconds = time.process_time() - start
        print(
            f"  budget of {budget:>3} cuts: tau {answer.dilation:.6f}, {len(calls)} solutions, "
            f"{seconds / one:.1f} times the time of one"
        )
        times.append(round(seconds / one, 1))
    return {"least": min(times), "most": max(times)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--note", action="store_true")
    options = parser.parse_args()
    found = {"source": "weighted.py --note"}
    prepared, found["western_europe"] = measure(
        "Western Europe", western_europe(), (2, 4, 6, 10), 0.0, 60.0, True
    )
    found["budget"] = budgets(prepared)
    ring = gshhg.sinusoidal(gshhg.eurasia("i"))
    _, found["eurasia_i"] = measure("Eurasia, intermediate", ring, (2, 4, 10), 1e-3, 60.0, False)
    if not options.quick:
        ring = gshhg.sinusoidal(gshhg.eurasia("f"))
        _, found["eurasia_f"] = measure("Eurasia, full", ring, (4,), 1e-2, 600.0, False)
    if options.note:
        note("weighted", found)


if __name__ == "__main__":
    main()

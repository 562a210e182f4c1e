"""Which steps of a trade-off curve pay off."""

from __future__ import annotations

import math

__all__ = ["paying_steps"]


def paying_steps(tau, cost, most=5):
    """Find the steps that buy most: the largest fall of the detour for what they cost more.

    Parameters
    ----------
    tau : list of float
        Falling: the least dilation achievable at each cost.
    cost : list of float
        Rising.
    most : int
        How many steps to find.

    Returns
    -------
    list of int
        Steps, ascending. The first step is never one: nothing was paid for it.

    Notes
    -----
    The fall is measured on a logarithmic scale: halving a detour of 40 is worth as much as halving
    one of 4. Only steps on the lower convex hull of the curve count, since any other is a bad buy:
    some mixture of its neighbours would be cheaper.
    """
    hull = []
    for k in range(len(tau)):
        while len(hull) > 1 and (  # steps in line with their neighbours stay, noise apart
            _slope(tau, cost, hull[-2], hull[-1]) > _slope(tau, cost, hull[-1], k) * (1.0 - 1e-9)
        ):
            hull.pop()
        hull.append(k)
    gain = {b: -_slope(tau, cost, a, b) for a, b in zip(hull[:-1], hull[1:])}
    best = sorted(gain, key=lambda k: (-gain[k], k))[:most]
    return sorted(best)


def _slope(tau, cost, a, b):
    """Change of log tau for each unit of cost from step a to step b; negative."""
    rise = cost[b] - cost[a]
    return (math.log(tau[b]) - math.log(tau[a])) / rise if rise > 0.0 else -math.inf

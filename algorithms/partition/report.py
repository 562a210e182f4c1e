"""The HTML report of the trade-off tool: plain SVG, readable without a network."""

from __future__ import annotations

import html
import math
from typing import Any

from ..words import tr

WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 720, 340, 70, 48, 16, 20

STYLE = """
body { font: 15px/1.45 sans-serif; max-width: 760px; margin: 2em auto; padding: 0 1em; color: #222 }
h1 { font-size: 1.5em } h2 { font-size: 1.15em; margin: 2em 0 .3em }
table { border-collapse: collapse; margin: .6em 0 }
caption { text-align: left; color: #555; white-space: nowrap }
td, th { padding: .15em .8em; border-bottom: 1px solid #ddd; text-align: right }
svg { max-width: 100%; height: auto } svg text { font: 12px sans-serif; fill: #444 }
"""


def page(title: str, intro: list[str], curves: list[dict[str, Any]]) -> str:
    """Return the report.

    Parameters
    ----------
    title : str
    intro : list of str
        Paragraphs.
    curves : list of dict
        For each feature: name, unit (of the cost), tau, cost, cuts, share (lists, a step each),
        marked (steps), complete (whether the curve goes down to its lower bound).
    """
    body = [f"<h1>{html.escape(title)}</h1>"]
    body += [f"<p>{html.escape(text)}</p>" for text in intro]
    for curve in curves:
        body.append(f"<h2>{html.escape(curve['name'])}</h2>")
        body.append(_plot(curve))
        body.append(_table(curve))
    return (
        f'<!DOCTYPE html><html lang="{tr("en")}"><head><meta charset="utf-8"><title>{html.escape(title)}'
        f"</title><style>{STYLE}</style></head><body>{''.join(body)}</body></html>\n"
    )


def _table(curve):
    own_cost = curve["cost"] != curve["cuts"]  # otherwise the number of cuts is the cost
    rows = [
        f"<tr><td>{_round_up(curve['tau'][k], curve['tau'][k - 1] if k else math.inf)}</td>"
        f"<td>{curve['cuts'][k]}</td>"
        + f"<td>{curve['cost'][k]:.6g}</td>" * own_cost
        + f"<td>{_per_cent(curve['share'][k])}</td></tr>"
        for k in curve["marked"]
    ]
    if not rows:
        return f"<p>{tr('No step pays off more than another.')}</p>"
    return (
        f"<table><caption>{tr('The steps that pay off most: the tau to set, and what it gives.')}</caption>"
        f"<tr><th>tau</th><th>{tr('cuts')}</th>"
        + f"<th>{html.escape(curve['unit'])}</th>" * own_cost
        + f"<th>{tr('largest part')}</th></tr>{''.join(rows)}</table>"
    )


def _per_cent(share):
    return "?" if math.isnan(share) else f"{100 * share:.1f} %"


def _round_up(tau, above):
    """A short number from tau up to less than the tau of the step above, to be typed in."""
    for digits in range(2, 16):
        text = f"{math.ceil(tau * 10**digits) / 10**digits:.{digits}f}"
        if tau <= float(text) < above:
            return text
    return repr(tau)


def _plot(curve):
    """The step function: tau to the right (logarithmic), cost upwards."""
    tau, cost = curve["tau"], curve["cost"]
    finite = [t for t in tau if math.isfinite(t)]
    low, high = min(finite) / 1.1, max(finite) * 1.3
    top = max(cost) * 1.08 or 1.0

    def x(value):
        share = (math.log(min(value, high)) - math.log(low)) / (math.log(high) - math.log(low))
        return LEFT + share * (WIDTH - LEFT - RIGHT)

    def y(value):
        return HEIGHT - BOTTOM - value / top * (HEIGHT - BOTTOM - TOP)

    path, right = [], high
    for t, c in zip(tau, cost):
        path.append(f"{'L' if path else 'M'}{x(right):.1f} {y(c):.1f}L{x(t):.1f} {y(c):.1f}")
        right = t
    parts = [
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{tr("Cost over tau")}">',
        f'<path d="M{LEFT} {TOP}V{HEIGHT - BOTTOM}H{WIDTH - RIGHT}" fill="none" stroke="#888"/>',
    ]
    for value in _ticks_log(low, high):
        parts.append(
            f'<path d="M{x(value):.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#eee"/>'
            f'<text x="{x(value):.1f}" y="{HEIGHT - BOTTOM + 17}" text-anchor="middle">{value:g}'
            "</text>"
        )
    for value in _ticks(top):
        parts.append(
            f'<path d="M{LEFT} {y(value):.1f}H{WIDTH - RIGHT}" stroke="#eee"/>'
            f'<text x="{LEFT - 6}" y="{y(value) + 4:.1f}" text-anchor="end">{value:g}</text>'
        )
    parts.append(
        f'<text x="{(LEFT + WIDTH) / 2}" y="{HEIGHT - 10}" text-anchor="middle">'
        f"{tr('tau: largest detour allowed')}</text>"
        f'<text transform="translate(16 {HEIGHT / 2}) rotate(-90)" '
        f'text-anchor="middle">{html.escape(curve["unit"])}</text>'
        f'<path d="{"".join(path)}" fill="none" stroke="#2b6ca3" stroke-width="1.6"/>'
    )
    for k in curve["marked"]:
        parts.append(
            f'<circle cx="{x(tau[k]):.1f}" cy="{y(cost[k]):.1f}" r="4.5" fill="#d7301f"/>'
            f'<text x="{x(tau[k]) + 7:.1f}" y="{y(cost[k]) - 6:.1f}">{tau[k]:.3g}</text>'
        )
    if not curve["complete"]:
        parts.append(
            f'<text x="{x(tau[-1]) - 6:.1f}" y="{y(cost[-1]) - 4:.1f}" text-anchor="end">'
            f"{tr('goes on')}</text>"
        )
    return "".join(parts) + "</svg>"


def _ticks(top):
    """Round values from 0 up to the top."""
    step = 10.0 ** math.floor(math.log10(top / 4))
    step *= next(f for f in (1, 2, 5, 10) if top / (step * f) <= 6)
    return [k * step for k in range(int(top / step) + 1)]


def _ticks_log(low, high):
    """Round values on a logarithmic scale."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    factors = (1, 2, 5) if high / low < 1e4 else (1,)
    if high / low < 4:
        factors = (1, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9)
    values = [f * 10.0**d for d in decades for f in factors]
    return [value for value in values if low <= value <= high]

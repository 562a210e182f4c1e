"""The HTML report of an aggregation: plain tables with bars, readable without a network."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from ..base import amount, grouped
from ..partition.report import STYLE
from ..words import spoken, tr

if TYPE_CHECKING:
    from ...core.aggregation.outcome import Balance


BAR = """
.bar { display: inline-block; height: .8em; background: #2b6ca3 }
td.text, th:first-child { text-align: left }
h2 + p { color: #555; margin: 0 }
"""


def page(title: str, intro: list[str], balance: Balance) -> str:
    """Return the report.

    Parameters
    ----------
    title : str
    intro : list of str
        Paragraphs.
    balance : outcome.Balance
    """
    total = balance.costs[-1][2]
    cost_rows = [
        (spoken(name), amount(before), amount(after), *_share(after, total))
        for name, before, after in balance.costs
    ]
    size = sum(row[2] for row in balance.classes)
    class_rows = [
        (
            name,
            grouped(areas),
            grouped(before / 1e4, ",.1f"),
            *_share(before, size),
            grouped(regions),
            grouped(after / 1e4, ",.1f"),
            *_share(after, size),
        )
        for name, areas, before, regions, after in balance.classes
    ]
    lost_rows = [
        (name, grouped(many), grouped(lost), *_share(lost, many)) for name, lost, many in balance.lost
    ]
    body = [
        f"<h1>{html.escape(title)}</h1>",
        *(f"<p>{html.escape(text)}</p>" for text in intro),
        _table(
            tr("Cost"),
            tr("Before: every area a region of its own. The share is that of the cost after."),
            ("", tr("before"), tr("after"), tr("share"), ""),
            cost_rows,
        ),
        _table(
            tr("Classes"),
            tr("Areas before, regions after, with their sizes in hectares."),
            (
                tr("class"),
                tr("areas"),
                "ha",
                tr("share"),
                "",
                tr("regions"),
                "ha",
                tr("share"),
                "",
            ),
            class_rows,
        ),
        _table(
            tr("Lost areas"),
            tr(
                "Areas above half of the minimum size of their class, and how many of them lost it (by "
                "more than half of their size)."
            ),
            (tr("class"), tr("areas"), tr("lost"), tr("share"), ""),
            lost_rows,
        )
        if lost_rows
        else f"<h2>{tr('Lost areas')}</h2><p>{tr('No area is above half of its minimum size.')}</p>",
    ]
    return (
        f'<!DOCTYPE html><html lang="{tr("en")}"><head><meta charset="utf-8"><title>{html.escape(title)}'
        f"</title><style>{STYLE}{BAR}</style></head><body>{''.join(body)}</body></html>\n"
    )


def _share(part, whole):
    """A share as text, and as a bar."""
    share = part / whole if whole else 0.0
    return f"{100 * share:.1f} %", _Bar(share)


class _Bar(float):
    """A share that is drawn."""


def _table(title, caption, names, rows):
    def cell(value, first):
        if isinstance(value, _Bar):
            width = max(0.0, min(1.0, value)) * 6.0
            return f'<td class="text"><span class="bar" style="width:{width:.2f}em"></span></td>'
        return f"<td{' class=text' * first}>{html.escape(value)}</td>"

    lines = "".join(f"<tr>{''.join(cell(value, not k) for k, value in enumerate(row))}</tr>" for row in rows)
    head = "".join(f"<th>{html.escape(name)}</th>" for name in names)
    return f"<h2>{html.escape(title)}</h2><p>{html.escape(caption)}</p><table><tr>{head}</tr>{lines}</table>"

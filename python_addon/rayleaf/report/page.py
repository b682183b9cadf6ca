"""One HTML page that needs nothing else: text, tables, SVG plots and pictures inside it. Readable on a phone, printable."""

import base64
import html
import io
import re
from collections.abc import Iterable, Sequence
from typing import Any

import matplotlib.image
import numpy as np

from .errors import displayed, to_srgb

_STYLE = """
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 76rem; margin: auto; padding: 0 1rem 4rem; }
h1, h2, h3 { line-height: 1.2; } h2 { margin-top: 3rem; border-bottom: 1px solid #8888; }
table { border-collapse: collapse; font-size: 13px; } th, td { padding: .15rem .6rem; text-align: right; }
th { border-bottom: 1px solid #888; vertical-align: bottom; } td:first-child, th:first-child { text-align: left; }
tr:nth-child(even) td { background: #8881; } tr.dominated td { opacity: .55; }
nav ul { columns: 14rem; padding: 0; list-style: none; }
.wide { overflow-x: auto; } figure { margin: 1rem 0; } figcaption, .note { font-size: 13px; opacity: .8; }
svg, img { max-width: 100%; height: auto; } svg { background: #fff; }
.pictures { display: grid; gap: .8rem; grid-template-columns: repeat(auto-fill, minmax(10rem, 1fr)); }
.pictures figure { margin: 0; } .pictures .plot { grid-column: span 2; } .wide { margin-bottom: 1rem; }
.pictures img { width: 100%; image-rendering: pixelated; }
p { max-width: 62rem; } td:first-child { min-width: 9rem; }
td:last-child, th:last-child { min-width: 5rem; }
tr.dominated td:last-child { font-size: 11px; line-height: 1.2; } .plot svg { width: 34rem; }
pre { font-size: 12px; }
@page { size: A4 landscape; margin: 12mm; }
@media print {
  body { max-width: none; padding: 0; font-size: 11px; } h2 { break-before: page; } h3, h2 { break-after: avoid; }
  figure, tr { break-inside: avoid; } .wide { overflow: visible; } .plot svg { width: 24rem; }
  table { font-size: 9px; } th, td { padding: .1rem .4rem; } pre { font-size: 6.5px; white-space: pre-wrap; }
  .pictures { grid-template-columns: repeat(7, 1fr); }
  .plot, .wide { display: inline-block; vertical-align: top; }
}
"""


def text(value: Any) -> str:
    """A cell as people read it: four digits of a number."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    if isinstance(value, float):
        return f"{value:.4g}" if abs(value) < 1e5 else f"{value:,.0f}"
    return html.escape(str(value))


def table(head: Sequence[str], rows: Iterable[Sequence[Any]], dim: Iterable[bool] = ()) -> str:
    """`dim` marks rows to be shown weaker."""
    weak = list(dim)
    parts = ["<div class=wide><table><tr>", *(f"<th>{html.escape(name)}</th>" for name in head), "</tr>"]
    for number, row in enumerate(rows):
        kind = " class=dominated" if number < len(weak) and weak[number] else ""
        parts += [f"<tr{kind}>", *(f"<td>{text(cell)}</td>" for cell in row), "</tr>"]
    return "".join([*parts, "</table></div>"])


def paragraph(words: str, kind: str = "") -> str:
    """Plain text."""
    return f"<p{f' class={kind}' if kind else ''}>{html.escape(words)}</p>"


def anchor(title: str) -> str:
    """What a link to a section is named."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def section(title: str, *parts: str, level: int = 2) -> str:
    """A heading and what belongs to it. Those of level 2 are in the list of contents."""
    return f"<h{level} id='{anchor(title)}'>{html.escape(title)}</h{level}>" + "".join(parts)


def contents(body: str) -> str:
    """Links to the sections of level 2."""
    found = re.findall(r"<h2 id='([^']*)'>(.*?)</h2>", body)
    links = "".join(f"<li><a href='#{place}'>{title}</a></li>" for place, title in found)
    return f"<nav><ul>{links}</ul></nav>" if found else ""


def png(pixels: Any) -> bytes:
    """(height, width, 3) bytes, rows top to bottom, as a PNG file."""
    file = io.BytesIO()
    matplotlib.image.imsave(file, np.ascontiguousarray(pixels), format="png")
    return file.getvalue()


def picture(linear: Any, caption: str) -> str:
    """A scene-linear picture, rows bottom to top, as the report shows it: sRGB, clipped."""
    rgb = np.asarray(linear)[::-1]
    if rgb.shape[-1] == 1:
        rgb = np.repeat(rgb, 3, axis=-1)
    data = png(np.round(to_srgb(displayed(rgb)) * 255).astype(np.uint8))
    source = base64.b64encode(data).decode()
    words = html.escape(caption)
    return f"<figure><img alt='{words}' src='data:image/png;base64,{source}'><figcaption>{words}</figcaption></figure>"


def pictures(*figures: str) -> str:
    """Figures side by side."""
    return f"<div class=pictures>{''.join(figures)}</div>"


def plot(svg: str, caption: str) -> str:
    """A plot with a line of text."""
    return f"<figure class=plot>{svg}<figcaption>{html.escape(caption)}</figcaption></figure>"


def page(title: str, *parts: str) -> str:
    """The whole document. The first part stands before the list of contents."""
    introduction, body = "".join(parts[:1]), "".join(parts[1:])
    return (
        f"<!DOCTYPE html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>"
        f"<title>{html.escape(title)}</title><style>{_STYLE}</style><h1>{html.escape(title)}</h1>"
        f"{introduction}{contents(body)}{body}</html>\n"
    )

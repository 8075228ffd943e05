"""Writes font_outlines.cc: the outlines of DejaVu Sans for the letters that pictures use.

    pip install fonttools; python3 make_outlines.py /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf

The table is committed, so that pictures have the same text wherever they are made.
"""

import sys
from pathlib import Path

from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.ttLib import TTFont

kUnits = 1024  # per em
kExtra = "–—‘’“”•…′″√∞∂∇≈≠≤≥−·⁰⁴⁵⁶⁷⁸⁹⁻₀₁₂₃₄₅₆₇₈₉"
letters = [*range(0x20, 0x7F), *range(0xA1, 0x100), *range(0x391, 0x3CA), *map(ord, kExtra)]


def outline(font, name, scale):
    """Contours of (x, y, on the curve)."""
    pen = DecomposingRecordingPen(font.getGlyphSet())
    font.getGlyphSet()[name].draw(pen)
    contours = []
    for verb, points in pen.value:
        xy = [(round(p[0] * scale), round(p[1] * scale)) for p in points if p]
        if verb == "moveTo":
            contours.append([(*xy[0], 1)])
        elif verb == "lineTo":
            contours[-1].append((*xy[0], 1))
        elif verb == "qCurveTo":
            if points[-1] is None:  # all points are off the curve
                contours.append([(*p, 0) for p in xy])
            else:
                contours[-1] += [(*p, 0) for p in xy[:-1]] + [(*xy[-1], 1)]
    return [c[:-1] if len(c) > 1 and c[0] == c[-1] else c for c in contours]


font = TTFont(sys.argv[1])
scale = kUnits / font["head"].unitsPerEm
names, widths = font.getBestCmap(), font["hmtx"].metrics
glyphs, numbers = [], []
for code in sorted(set(letters)):
    if code not in names:
        continue
    contours = outline(font, names[code], scale)
    glyphs.append((code, round(widths[names[code]][0] * scale), len(numbers), len(contours)))
    for contour in contours:
        numbers.append(len(contour))
        for x, y, on in contour:
            numbers += [2 * x + on, y]


def lines(words):
    out, line = [], "   "
    for word in words:
        if len(line) + len(word) + 1 > 108:
            out.append(line)
            line = "   "
        line += " " + word
    return "\n".join([*out, line])


Path(__file__).with_name("font_outlines.cc").write_text(
    f"""// Outlines of DejaVu Sans 2.37 (Bitstream Vera's licence, see NOTICE), made by make_outlines.py: as long as a font is.
// {kUnits} units are an em. A contour is the number of its points, then of each 2 x + 1 if it is on the curve, and y;
// between two points off the curve there is one on it, in their middle.
#include "engine/sinks/picture/text/font_outlines.h"

namespace truestep::picture {{

// clang-format off
constexpr Outline kTable[] = {{
{lines(f"{{{c}, {w}, {at}, {n}}}," for c, w, at, n in glyphs)}
}};

constexpr int16_t kNumbers[] = {{
{lines(f"{n}," for n in numbers)}
}};
// clang-format on

std::span<const Outline> outlines() {{ return kTable; }}
std::span<const int16_t> outline_numbers() {{ return kNumbers; }}

}}  // namespace truestep::picture
""",
    encoding="utf-8",
)

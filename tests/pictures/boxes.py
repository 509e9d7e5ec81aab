"""Makes boxes.woff2, a font in which every letter is the same box, for pictures that look alike on
every machine. Needs fonttools and brotli: `python boxes.py`."""

from fontTools.fontBuilder import FontBuilder
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import newTable
from fontTools.ttLib.tables._c_m_a_p import CmapSubtable

EM, WIDTH, BLANKS = 1000, 520, [0x20, 0xA0, 0x2007, 0x2008, 0x2009, 0x202F]


def box() -> object:
    pen = TTGlyphPen(None)
    corners = [(40, 0), (40, 560), (WIDTH - 40, 560), (WIDTH - 40, 0)]
    pen.moveTo(corners[0])
    for corner in corners[1:]:
        pen.lineTo(corner)
    pen.closePath()
    return pen.glyph()


def main() -> None:
    font = FontBuilder(EM, isTTF=True)
    font.setupGlyphOrder([".notdef", "blank", "box"])
    font.setupCharacterMap({code: "blank" for code in BLANKS})
    blank = TTGlyphPen(None).glyph()
    font.setupGlyf({".notdef": box(), "blank": blank, "box": box()})
    font.setupHorizontalMetrics({name: (WIDTH, 40) for name in (".notdef", "blank", "box")})
    font.setupHorizontalHeader(ascent=800, descent=-200)
    font.setupNameTable({"familyName": "Boxes", "styleName": "Regular"})
    font.setupOS2(sTypoAscender=800, sTypoDescender=-200, usWinAscent=800, usWinDescent=200)
    font.setupPost()
    # One table for all letters: format 13 says of a whole range that it is one glyph.
    letters = CmapSubtable.newSubtable(13)
    letters.platformID, letters.platEncID, letters.language = 3, 10, 0
    blanks = set(BLANKS)
    letters.cmap = {
        code: "blank" if code in blanks else "box" for code in range(0x20, 0x3000)
    }
    cmap = newTable("cmap")
    cmap.tableVersion, cmap.tables = 0, [letters]
    font.font["cmap"] = cmap
    font.font.flavor = "woff2"
    font.font["head"].created = font.font["head"].modified = 0
    font.save("boxes.woff2")


main()

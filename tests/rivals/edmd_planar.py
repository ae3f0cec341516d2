"""Makes EDMD's program for one event a particle planar by substitutions on its source.

Each substitution has a required number of matches, and finally nothing may name the third coordinate: a changed source is
refused, and the message names the failed substitution.
"""

import pathlib
import re

# Functions that read, write or start, and unused ones: in_edmd.c has its own.
CUT = ["main", "printstuff", "mygetline", "fcc", "loadparticles", "randommovement", "findallcollisions", "outputsnapshot", "write",
       "backinbox", "thermostat"]
# Names that belong to the third coordinate.
THIRD = r"\b(z|vz|zn|dz|dvz|hz|cz|cdz|cellz|zsize|iczsize|boxestraveledz)\b"

# Pattern, replacement, and number of matches. `^…$` is a whole line, which is removed.
SUBSTITUTIONS = [
    # Settings of a measurement.
    (r"^#define MAXNEIGH \d+$", "", 1),
    (r"shellsize = 1\.5;", "shellsize = SHELL;", 1),
    (r"seed = 1;", "seed = chosen_seed;", 1),
    (r"^int N = .*$", "int N; static unsigned long chosen_seed; void hexagonal();", 1),
    (r"if \(initialconfig == 0\)[^;]*;\s*else[^;]*;", "hexagonal();", 1),
    # Events that only write, or heat.
    (r"particle\* writeevent(?s:.*?)addevent\(writeevent\);", "", 1),
    (r"if \(usethermostat\)\s*\{[^}]*\}", "", 1),
    (r"case 10[01]:[^;]*;\s*break;", "", 2),
    # Declarations.
    (r"\bx, y, z;", "x, y;", 1),
    (r"vx, vy, vz;", "vx, vy;", 1),
    (r"xn, yn, zn;", "xn, yn;", 1),
    (r", (boxestraveledz|zsize|hz|iczsize|cz|cdz);", ";", 6),
    (r"dx, dy, dz, r2", "dx, dy, r2", 1),
    # Cells.
    (r", int (cellz|c)\)", ")", 4),
    (r" \+ c\*cx\*cy", "", 1),
    (r"cx\*cy\*cz", "cx*cy", 2),
    (r"^ *(cz \*?=|iczsize =|cellz \+=|for \(cdz =|.*\"Cells:) .*$", "", 6),
    (r", p->z \* iczsize", "", 1),
    (r", cellz\)", ")", 2),
    (r" \|\| cellz == (0|cz - 1)", "", 2),
    (r", cellz = p1->z \* iczsize", "", 1),
    (r", cdz % cz", "", 1),
    # Positions and velocities.
    (r"; hz = 0\.5 \* zsize", "", 1),
    (r"^.*(boxestraveledz = 0|zn = p1?->z);$", "", 3),
    (r"^.*p1->z (\+=|>=|<) .*$", "", 3),
    (r"^ *(double )?(dz|dvz) = .*$", "", 6),
    (r"^ *if \(dz > hz\).*$", "", 3),
    (r", dvz = p1->vz", "", 1),
    (r" \+ (dz \* dvz|dvz \* dvz|dz \* dz)", "", 8),
    (r" dz \*= rinv;", "", 1),
    (r"^.*p[12]->vz [-+]= .*$", "", 2),
]


class Changed(Exception):
    """The source differs from the one that these substitutions were written for."""


def substituted(text, pattern, by, times):
    text, found = re.subn(pattern, by, text, flags=re.MULTILINE)
    if found != times:
        raise Changed(f"EDMD's source has changed: /{pattern}/ occurs {found} times, expected {times}")
    return text


def planar(folder):
    """Source of the program in two dimensions, from the folder `Single` of a checkout."""
    source, header = (pathlib.Path(folder, name).read_text() for name in ("mdSingle.c", "mdSingle.h"))
    text = substituted(source, r'^#include "mdSingle\.h"', lambda _: header, 1)
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", text.replace("\r", ""), flags=re.DOTALL)
    text = re.sub(r"[ \t]+$", "", text, flags=re.MULTILINE)
    for name in CUT:
        text = substituted(text, rf"^\w+ {name}\([^)]*\)\s*\{{(?s:.*?)^\}}", "", 1)
    for substitution in SUBSTITUTIONS:
        text = substituted(text, *substitution)
    if left := re.search(THIRD, text):
        raise Changed(f"EDMD's source has changed: {left[0]} remains in «{text[: left.end()].splitlines()[-1].strip()}»")
    return text + pathlib.Path(__file__).with_name("in_edmd.c").read_text()

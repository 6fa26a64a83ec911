#!/usr/bin/env python3
"""No two types of the same full name, in whichever files: the linker would take one's inline functions for both, and no
compiler says so. Namespaces and types are read from the lines that begin with them, as clang-format lays them out;
what lies in an unnamed namespace is its file's own.
"""

import argparse
import pathlib
import re
import sys

FOLDERS = ("src", "apps", "tests", "benchmarks", "examples")
OPENED = re.compile(r"namespace\s*([\w:]*)\s*\{")
CLOSED = re.compile(r"\}\s*// namespace")
TYPE = re.compile(r"(?:struct|class|union|enum(?: class)?)\s+([\w:]+)\b(?!.*;\s*(?://.*)?$)")


def types_of(text):
    """(full name, line number) of each type that is seen from other files."""
    spaces = []
    for number, line in enumerate(text.splitlines(), 1):
        if opened := OPENED.match(line):
            spaces.append(opened.group(1))
        elif CLOSED.match(line):
            spaces.pop()
        elif (found := TYPE.match(line)) and "" not in spaces:
            yield "::".join([*spaces, found.group(1)]), number


def check_tree(root):
    places = {}
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.[hc]pp")):
            for name, number in types_of(path.read_text()):
                places.setdefault(name, []).append(f"{path.relative_to(root)}:{number}")
    return [f"{there[-1]}: {name} is defined in {there[0]} too" for name, there in places.items() if len(there) > 1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=pathlib.Path, nargs="?", default=pathlib.Path(__file__).resolve().parent.parent)
    found = check_tree(parser.parse_args().root)
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

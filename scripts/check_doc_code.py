#!/usr/bin/env python3
"""Code that a page shows is that of an example, which is compiled and run.

usage: check_doc_code.py PAGE.md EXAMPLE.cpp: every ```cpp block of the page must stand in the example, but for how far it is
indented.
"""

import pathlib
import re
import sys


def unindented(text):
    return [line.strip() for line in text.strip().splitlines()]


def main():
    page, example = (pathlib.Path(argument).read_text(encoding="utf-8") for argument in sys.argv[1:3])
    lines = unindented(example)
    blocks = re.findall(r"^```cpp\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    if not blocks:
        sys.exit(f"{sys.argv[1]}: shows no code")
    for block in blocks:
        wanted = unindented(block)
        if not any(lines[i : i + len(wanted)] == wanted for i in range(len(lines))):
            sys.exit(f"{sys.argv[1]}: isn't in {sys.argv[2]}: {wanted[0]} ...")


if __name__ == "__main__":
    main()

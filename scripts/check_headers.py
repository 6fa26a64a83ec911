#!/usr/bin/env python3
"""Each public header compiles alone. Most are the first include of their own .cpp or test, which the compilation
database, being without precompiled headers, has already compiled for clang-tidy; the others are compiled here.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys

from tidy import command_of

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = ROOT / "src"
FIRST_INCLUDE = re.compile(r'^#include ["<]([^">]+)[">]', re.MULTILINE)


def is_first_of_its_own(header):
    """Whether its own .cpp or test begins with it."""
    for source in (header.with_suffix(".cpp"), header.with_name(header.stem + "_test.cpp")):
        first = FIRST_INCLUDE.search(source.read_text()) if source.exists() else None
        if first and first.group(1) == str(header.relative_to(SOURCES)):
            return True
    return False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("database", type=pathlib.Path, help="compile_commands.json without precompiled headers")
    entries = json.loads(parser.parse_args().database.read_text())
    flags_of = {pathlib.Path(e["file"]).parent: (command_of(e), e["directory"]) for e in entries}

    headers = [h for h in sorted(SOURCES.rglob("*.hpp")) if not h.stem.endswith("_internal")]
    alone = [h for h in headers if not is_first_of_its_own(h)]
    failed = 0
    for header in alone:
        command, directory = flags_of[header.parent]
        text = f'#include "{header.relative_to(SOURCES)}"\n'
        run = subprocess.run([*command, "-fsyntax-only", "-x", "c++", "-"], cwd=directory, input=text, text=True)
        failed += run.returncode != 0
    print(f"headers: {len(headers)}, {len(headers) - len(alone)} first of their own source, {len(alone)} compiled alone, "
          f"{failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

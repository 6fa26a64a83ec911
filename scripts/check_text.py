#!/usr/bin/env python3
"""The project's files speak of the project alone: no absolute paths of somebody's machine, no hosts but known ones."""

import pathlib
import re
import subprocess
import sys

# Folders that exist on every Debian, and names that tests use for what is not there.
KNOWN_ROOTS = {"bin", "dev", "etc", "no", "nonexistent", "proc", "sys", "usr"}
# Hosts that the docs may link to.
KNOWN_HOSTS = {
    "arxiv.org",
    "doi.org",
    "keepachangelog.com",
    "semver.org",
    "www.apache.org",
    "www.conventionalcommits.org",
    "www.cvlibs.net",
}
# An absolute path of two parts at least, where one can begin: after a space, a quote (not one that is joined to what
# stands before), a bracket, = or :.
PATH = re.compile(r"""(?:^|[\s'`(\[<=:,]|(?<!\+ )")/([A-Za-z_][\w.+-]*)/[\w.]""")
HOST = re.compile(r"""\b[a-z][a-z0-9+.-]*://([\w.-]+)""", re.IGNORECASE)
NOT_OURS = {"LICENSE", ".gitignore"}


def problems(name, text):
    for number, line in enumerate(text.splitlines(), 1):
        for match in PATH.finditer(line):
            if match.group(1) not in KNOWN_ROOTS:
                yield f"{name}:{number}: absolute path: {line.strip()}"
        for match in HOST.finditer(line):
            if match.group(1).lower() not in KNOWN_HOSTS:
                yield f"{name}:{number}: unknown host {match.group(1)}; if it is meant, add it to {sys.argv[0]}"


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    listing = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=root,
                             check=True, capture_output=True, text=True).stdout
    found = []
    for name in sorted(set(listing.split("\0")) - NOT_OURS - {""}):
        path = root / name
        if not path.is_file():
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        found.extend(problems(name, text))
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

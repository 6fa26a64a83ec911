#!/usr/bin/env python3
"""Includes point downwards only.

Modules, their order and what each may see are read from the groundscale_module(...) lines of CMakeLists.txt: a file of a
module, its tests included, may include that module, its DEPENDS and what lies beneath those. Third parties stay in .cpp
and _internal.hpp files, and only in the modules that the table below gives them. Public headers see the standard library,
Eigen and groundscale.
"""

import argparse
import pathlib
import re
import sys

# Third party by the beginning of its include: modules whose .cpp files may see it, None for all.
THIRD_PARTIES = {
    "Eigen/": None,
    "fmt/": None,
    "opencv2/": {"io", "tracking", "plane", "road", "mapping", "report", "tests"},
    "yaml-cpp/": {"io"},
    "nlohmann/": {"io", "odometry", "evaluation", "report", "experiments"},
    "expat.h": {"io"},
    "opengv/": {"motion", "mapping"},
    "ceres/": {"plane", "mapping"},
    "embree3/": {"simulation"},
    "tbb/": {"simulation"},
    "CLI/": {"apps"},
    "gtest/": {"test"},
    "gmock/": {"test"},
    "benchmark/": {"benchmarks"},
}
# Never, whatever CMakeLists.txt says.
FORBIDDEN = {("simulation", "odometry")}
# Folders beside the modules; they may include every module.
TOP_FOLDERS = ("apps", "tests", "benchmarks", "examples")

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
MODULE = re.compile(r"^groundscale_module\(([^)]*)\)", re.MULTILINE)
KEYWORDS = ("DEPENDS", "LINK", "PUBLIC_LINK", "SLOW_TESTS")


def read_modules(cmake_text):
    """Module -> modules it may include, itself among them. Raises ValueError where a module comes before one beneath."""
    visible = {}
    for match in MODULE.finditer(cmake_text):
        words = re.sub(r"#.*", "", match.group(1)).split()
        name, keyword, depends = words[0], None, []
        for word in words[1:]:
            if word in KEYWORDS:
                keyword = word
            elif keyword == "DEPENDS":
                depends.append(word)
        visible[name] = {name}
        for below in depends:
            if below not in visible:
                raise ValueError(f"CMakeLists.txt: module {name} depends on {below}, which does not stand above it")
            visible[name] |= visible[below]
    return visible


def problem_of(include, quoted, module, is_test, is_public_header, visible):
    """Why a file of a module (or of a top folder) may not include this, or None."""
    if include.startswith("groundscale/"):
        target = include.split("/")[1]
        if module in TOP_FOLDERS:
            return None
        if target not in visible[module] or (module, target) in FORBIDDEN:
            return f"module {module} must not see {target}"
        return None if quoted else "write includes of groundscale in quotes"
    for prefix, allowed in THIRD_PARTIES.items():
        if not include.startswith(prefix):
            continue
        if is_public_header and prefix != "Eigen/":
            return f"a public header must not see {prefix.rstrip('/')}"
        if allowed is not None and module not in allowed and not (is_test and "test" in allowed):
            return f"{prefix.rstrip('/')} is not for {module}"
        return None
    if quoted:
        return None if module in TOP_FOLDERS else "write the path from groundscale/ on"
    if "/" not in include and not include.endswith(".h"):
        return None  # standard library
    if include.endswith(".h") and not include.startswith("boost"):
        return "a public header must not see the system's headers" if is_public_header else None
    return "unknown third party; the table in scripts/check_includes.py names those in use"


def check_tree(root):
    try:
        visible = read_modules((root / "CMakeLists.txt").read_text())
    except ValueError as error:
        return [str(error)]
    found = []
    folders = [root / "src" / "groundscale"] + [root / folder for folder in TOP_FOLDERS]
    for path in sorted(p for folder in folders for p in folder.rglob("*.[ch]pp")):
        name = path.relative_to(root)
        module = name.parts[2] if name.parts[0] == "src" else name.parts[0]
        if name.parts[0] == "src" and module not in visible:
            found.append(f"{name}: no groundscale_module({module} ...) in CMakeLists.txt")
            continue
        is_test = path.stem.endswith("_test") or module == "tests"
        is_public_header = name.parts[0] == "src" and path.suffix == ".hpp" and not path.stem.endswith("_internal")
        text = path.read_text()
        for match in INCLUDE.finditer(text):
            why = problem_of(match.group(2), match.group(1) == '"', module, is_test, is_public_header, visible)
            if why:
                line = text.count("\n", 0, match.start(2)) + 1
                found.append(f"{name}:{line}: {match.group(2)}: {why}")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    found = check_tree(parser.parse_args().root)
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

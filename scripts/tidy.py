#!/usr/bin/env python3
"""clang-tidy over every file of a compilation database, several at a time.

A file that came out clean is not checked again while its preprocessed text (comments included: NOLINT is one), its
flags, the configuration and clang-tidy's version are the same. The names of the clean ones, as hashes, lie in
$XDG_CACHE_HOME/groundscale-tidy (~/.cache where that is unset).
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import shlex
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


def command_of(entry):
    """Compiler and flags of an entry, without the output and the source."""
    words = shlex.split(entry["command"])
    kept, skip = [], False
    for word in words:
        if skip or word in ("-c", entry["file"]):
            skip = False
        elif word == "-o":
            skip = True
        else:
            kept.append(word)
    return kept


def hash_of(entry, salt):
    command = command_of(entry)
    preprocessed = subprocess.run(command + ["-E", "-C", "-P", "-w", entry["file"]], cwd=entry["directory"], check=True,
                                  capture_output=True).stdout
    digest = hashlib.sha256(salt)
    # Flags with the paths of this checkout would make every other checkout's results useless.
    digest.update(" ".join(command).replace(str(ROOT), "").encode())
    digest.update(preprocessed)
    return digest.hexdigest()


def check(entry, salt, cache, tidy, database):
    """(name, seconds, output); output is "" where the file is clean, seconds is None where that was known."""
    name = os.path.relpath(entry["file"], ROOT)
    started = time.monotonic()
    try:
        stamp = cache / hash_of(entry, salt)
    except subprocess.CalledProcessError as error:
        return name, time.monotonic() - started, error.stderr.decode()
    if stamp.exists():
        stamp.touch()
        return name, None, ""
    run = subprocess.run([tidy, "--quiet", "--warnings-as-errors=*", "--extra-arg=-Wno-unknown-warning-option", "-p",
                          str(database.parent), entry["file"]], capture_output=True, text=True)
    output = ""
    if run.returncode == 0:
        stamp.touch()
    else:
        output = run.stdout.strip() or run.stderr.strip() or f"clang-tidy ended with {run.returncode}"
    return name, time.monotonic() - started, output


def remove_old(cache, days=30):
    for stamp in cache.iterdir():
        if time.time() - stamp.stat().st_mtime > days * 86400:
            stamp.unlink(missing_ok=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("database", type=pathlib.Path, help="compile_commands.json")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", default="", help="only files whose path contains this")
    parser.add_argument("--verbose", action="store_true", help="every file with its time")
    arguments = parser.parse_args()

    tidy = "clang-tidy"
    version = subprocess.run([tidy, "--version"], check=True, capture_output=True).stdout
    salt = version + (ROOT / ".clang-tidy").read_bytes()
    cache = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "groundscale-tidy"
    cache.mkdir(parents=True, exist_ok=True)
    remove_old(cache)

    generated = str(arguments.database.resolve().parent) + os.sep
    entries = {e["file"]: e for e in json.loads(arguments.database.read_text())
               if arguments.only in e["file"] and not e["file"].startswith(generated)}
    checked, dirty = 0, 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        tasks = [pool.submit(check, entries[file], salt, cache, tidy, arguments.database) for file in sorted(entries)]
        for task in concurrent.futures.as_completed(tasks):
            name, seconds, output = task.result()
            checked += seconds is not None
            if arguments.verbose and seconds is not None:
                print(f"{seconds:6.1f} s  {name}", flush=True)
            if output:
                dirty += 1
                print(output, flush=True)
    print(f"clang-tidy: {len(entries)} files, {checked} checked, {len(entries) - checked} known as clean, "
          f"{dirty} with findings")
    return 1 if dirty else 0


if __name__ == "__main__":
    sys.exit(main())

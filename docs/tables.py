#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Make the tables of the documents anew: run the command above each table and replace the table by its output.

    docs/tables.py [--build DIR] [--only WORDS] [FILE.md ...]      default: build, README.md and docs/measurements.md

--only: only the tables whose command contains these words.
A table is an indented block; its command is the first `hyperfocal-bench ...` in the paragraph right above it."""
import os
import re
import subprocess
import sys

COMMAND = re.compile(r"`(?:build/bench/)?(hyperfocal-bench [^`]*)`")


def is_table(line):
    return line.startswith("    ")


# Yield for each table the range of its lines, and its command.
def find_tables(lines):
    at = 0
    while at < len(lines):
        if not is_table(lines[at]) or (at > 0 and lines[at - 1].strip()):
            at += 1
            continue
        end = at
        while end < len(lines) and (is_table(lines[end]) or (not lines[end].strip() and end + 1 < len(lines) and
                                                             is_table(lines[end + 1]))):
            end += 1
        above = at - 1
        while above > 0 and lines[above - 1].strip():
            above -= 1
        command = COMMAND.search(" ".join(line.strip() for line in lines[above:at]))
        if command:
            yield at, end, command.group(1)
        at = end


def main():
    args, build = sys.argv[1:], "build"
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    os.chdir(root)
    only = ""
    while args[:1] in (["--build"], ["--only"]):
        if args[0] == "--build":
            build = args[1]
        else:
            only = args[1]
        args = args[2:]
    for path in args or ["README.md", "docs/measurements.md"]:
        with open(path, encoding="utf-8") as f:
            lines = f.read().split("\n")
        for at, end, command in reversed(list(find_tables(lines))):
            words = command.split()
            if only not in command:
                continue
            print("%s:%d: %s" % (path, at + 1, command), flush=True)
            words[0] = os.path.join(build, "bench", words[0])
            out = subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout
            lines[at:end] = [("    " + line).rstrip() for line in out.rstrip("\n").split("\n")]
        with open(path, "w", encoding="utf-8") as f:
            f.write("\n".join(lines))


main()

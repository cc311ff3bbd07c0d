#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Adds to a folder of saved inputs those few of many that reach the most places not reached yet.

    tools/select_inputs.py CONTROL CORPUS COUNT

CONTROL is what libFuzzer wrote (-merge_control_file) when it ran all of them: the names of the
files, then for each a line `FT index place place ...`. What is in CORPUS stays; it is filled up to
COUNT files, each time with the one that adds the most places, the smaller of two that add as many.
"""
import hashlib
import pathlib
import shutil
import sys


def read_control(path):
    lines = iter(pathlib.Path(path).read_text().splitlines())
    count = int(next(lines))
    next(lines)  # how many were there before
    files = [pathlib.Path(next(lines)) for _ in range(count)]
    places = [set() for _ in files]
    for line in lines:
        word, index, *numbers = line.split()
        if word == "FT":
            places[int(index)] = set(numbers)
    return files, places


def main():
    control, corpus, limit = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
    files, places = read_control(control)
    reached, found = set(), []
    for file, reaches in zip(files, places):
        if file.resolve().parent == corpus.resolve():
            reached |= reaches
        else:
            found.append((file, reaches))
    room = limit - sum(1 for file in corpus.iterdir() if file.is_file())
    while room > 0 and found:
        file, reaches = max(found, key=lambda f: (len(f[1] - reached), -f[0].stat().st_size))
        if reaches <= reached:
            break
        reached |= reaches
        name = hashlib.sha1(file.read_bytes()).hexdigest()[:8]
        shutil.copyfile(file, corpus / name)
        room -= 1
    print(f"{corpus}: {limit - room} inputs reach {len(reached)} places")


main()

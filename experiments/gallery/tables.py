#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Tables of results: tables.py RESULTS.json prints them again, tables.py OLD.json NEW.json
compares two versions."""
import json
import re
import sys
from collections import Counter, defaultdict
from pathlib import Path

import faults
import sound


def catalogue():
    lines = [f"{len(sound.KINDS)} sound kinds"]
    for k in sound.KINDS:
        lines.append(f"  {k.name:16} {k.rate:5g} Hz {k.seconds / 60:6.0f} min {k.channels:3} "
                     f"{k.about}")
    lines.append(f"{len(faults.FAULTS)} faults")
    for f in faults.FAULTS:
        strengths = ", ".join(f"{s:.4g}" for s in f.strengths)
        lines.append(f"  {f.name:18} of {f.base:12} {strengths} {f.unit}: {f.about}")
    return "\n".join(lines)


def _counts(entries):
    counter = Counter(code for e in entries for code in e["codes"])
    return ", ".join(f"{code} {n}" for code, n in counter.most_common())


def _coverage(entries, term):
    held = total = 0
    for e in entries:
        a, b = e["covered"].get(term, (0, 0))
        held, total = held + a, total + b
    return f"{held}/{total}" if total else "-"


def _other_than_short(e):
    """Doubted for another reason than that slow terms are bounded only."""
    return bool(set(e["codes"]) - {"short"})


def _in_verdict(e):
    """The same, by the verdict without standard error."""
    return bool({c for c in e["codes"] if not c.startswith("stderr:")} - {"short"})


def _sound_line(kind, group):
    false = Counter(t for e in group for t in e["claimed"])
    claims = " ".join(f"{t} {n}" for t, n in sorted(false.items())) or "-"
    return (f"{kind:16} {len(group):4} {sum(e['doubted'] for e in group):5} "
            f"{sum(map(_other_than_short, group)):6} {sum(map(_in_verdict, group)):7} "
            + " ".join(f"{_coverage(group, t):>7}" for t in "NBKQR")
            + f"  {claims}; {_counts(group)}")


def sound_table(entries):
    groups = defaultdict(list)
    for e in entries:
        groups[e["kind"]].append(e)
    lines = ["Sound logs: doubted (also on standard error); without the code `short`; of these by "
             "the verdict;", "intervals that hold the truth; terms claimed falsely; codes", "",
             f"{'kind':16} {'logs':>4} {'doubt':>5} {'-short':>6} {'verdict':>7} {'N':>7} {'B':>7} "
             f"{'K':>7} {'Q':>7} {'R':>7}"]
    lines += [_sound_line(k.name, groups[k.name]) for k in sound.KINDS if k.name in groups]
    n = len(entries)
    lines += ["", f"Doubted: {sum(e['doubted'] for e in entries)} of {n}; for another reason than "
              f"`short`: {sum(map(_other_than_short, entries))}; of these by the verdict: "
              f"{sum(map(_in_verdict, entries))} (allowed: 1 %, that is {n // 100}, and chance).",
              "Intervals that hold the truth: "
              + ", ".join(f"{t} {_coverage(entries, t)}" for t in "NBKQR")]
    return "\n".join(lines)


def pair_classes(group):
    """(refused, [(pairs, all-clears, all-clears of the verdict alone)] of pairs that move by up to
    a half-width, up to three, beyond)."""
    refused = [e for e in group if e["refused"]]
    rest = [e for e in group if not e["refused"] and e["move"]]
    by = [[e for e in rest if e["move"]["class"] == c] for c in range(3)]
    return len(refused), [(len(b), sum(not e["doubted"] for e in b),
                           sum(not e["verdict_doubts"] for e in b)) for b in by]


def _worst(group):
    moved = [e for e in group if e["move"] and e["move"]["class"] == 2
             and not e["verdict_doubts"] and not told(e)]
    if not moved:
        return ""
    w = max(moved, key=lambda e: e["move"]["ratio"])["move"]
    percent = "" if w["percent"] is None or abs(w["percent"]) > 1e5 else f"{w['percent']:+.3g} %, "
    return f"{w['term']} {percent}{w['half_widths']:+.3g} half-widths"


def _mark(fault):
    return "undecidable" if fault.undecidable else "harmless" if fault.harmless else ""


def _grouped(entries):
    groups = defaultdict(list)
    for e in entries:
        groups[e["fault"], e["level"]].append(e)
    return groups


def _pair_line(fault, level, group):
    refused, by = pair_classes(group)
    cells = " ".join(f"{'/'.join(map(str, b)):>9}" for b in by)
    words = [_mark(fault), _worst(group), _counts(group)]
    return (f"{fault.name:18} {fault.strengths[level]:7.4g} {fault.unit:>8} {len(group):5} "
            f"{refused:3} {cells}  " + "; ".join(w for w in words if w))


def _reasons(groups):
    return [f"{_mark(f)}: {f.name}: {f.undecidable or f.harmless}." for f in faults.FAULTS
            if _mark(f) and any((f.name, k) in groups for k in range(3))]


# Notes that name another explanation of a term, if they name the channel, too.
TELLING = {"K": {"walk_or_drift", "ambiguous", "possible_step"},
           "R": {"walk_or_drift", "ambiguous", "possible_step"},
           "B": {"ambiguous", "possible_step"}}


WORDS = {"K": "random walk", "R": "ramp", "B": "bias instability"}


def _names(entry, code):
    """Does the note name the channel, and of terms that stand for each other the one that moved?"""
    move = entry["move"]
    about = re.search(re.escape(move["channel"]) + r" \(([^)]*)\)", entry["notes"].get(code, ""))
    return bool(about) and (code != "ambiguous" or WORDS[move["term"]] in about.group(1))


def told(entry):
    """An all-clear of which a note says what else explains the term that moved, on its channel."""
    move = entry["move"]
    return bool(not entry["verdict_doubts"] and move and move["class"] == 2
                and any(_names(entry, code) for code in TELLING.get(move["term"], ())))


def _silent(fault, entry):
    """An all-clear of an undecidable fault that moves a value, without the note that says so."""
    return bool(not entry["verdict_doubts"] and entry["move"] and entry["move"]["class"] == 2
                and fault.says and fault.says not in entry["notes"])


def _sum_line(groups):
    beyond = [pair_classes(g)[1][2] for (name, _), g in groups.items()
              if not faults.BY_NAME[name].undecidable]
    total, clear, verdict = (sum(b[k] for b in beyond) for k in range(3))
    middle = [pair_classes(g)[1][1] for (name, _), g in groups.items()
              if not faults.BY_NAME[name].undecidable]
    harmless = [e for (name, _), g in groups.items() for e in g if faults.BY_NAME[name].harmless]
    named = sum(map(told, (e for (name, _), g in groups.items() for e in g
                           if not faults.BY_NAME[name].undecidable)))
    silent = sum(_silent(faults.BY_NAME[name], e) for (name, _), g in groups.items()
                 if faults.BY_NAME[name].undecidable for e in g)
    return (f"All-clears among {total} pairs that moved beyond max(3 half-widths, 2 %): {verdict} "
            f"by the verdict, {clear} also without a word on standard error.\n"
            f"Of the {verdict}, a note says in {named} what else the moved term may be; "
            f"false: {verdict - named} (allowed: 0).\n"
            f"All-clears among {sum(b[0] for b in middle)} pairs that moved by one half-width to "
            f"there: {sum(b[2] for b in middle)}.\n"
            f"Undecidable faults that move a value without the note that says so: {silent}.\n"
            f"Harmless faults doubted by the verdict: {sum(map(_in_verdict, harmless))} of "
            f"{len(harmless)}.")


def pair_table(entries):
    groups = _grouped(entries)
    lines = ["Faults: pairs whose largest move is up to one half-width, up to max(3 half-widths, "
             "2 %), and beyond.", "Each as pairs/all-clears/all-clears of the verdict alone, "
             "without standard error.", "Then the worst all-clear of the verdict, and the codes.",
             "", f"{'fault':18} {'strength':>16} {'pairs':>5} {'ref':>3} {'<1':>9} {'1-3':>9} "
             f"{'beyond':>9}"]
    for fault in faults.FAULTS:
        for level in range(3):
            if (fault.name, level) in groups:
                lines.append(_pair_line(fault, level, groups[fault.name, level]))
    return "\n".join(lines + ["", _sum_line(groups)] + _reasons(groups))


def worst_table(entries):
    """Faults in the order of their false all-clears."""
    rows = []
    for (name, level), group in _grouped(entries).items():
        verdict = pair_classes(group)[1][2][2]
        named = sum(map(told, group))
        if verdict and not faults.BY_NAME[name].undecidable:
            rows.append(((verdict - named) / len(group), verdict, named, len(group), name, level,
                         _worst(group)))
    lines = ["All-clears of the verdict, the most frequent first; with a note on what else the term "
             "may be; pairs"]
    for _, verdict, named, total, name, level, worst in sorted(rows, reverse=True):
        lines.append(f"  {name:18} {faults.LEVELS[level]:6} {verdict:3} {named:3} of {total:3}  "
                     f"{worst}")
    return "\n".join(lines)


def report(results):
    parts = []
    if results["sound"]:
        parts.append(sound_table(results["sound"]))
    if results["pairs"]:
        parts += [pair_table(results["pairs"]), worst_table(results["pairs"])]
    return "\n\n".join(parts)


def compare(old, new):
    """Differences of verdicts between two versions, log by log."""
    lines = []
    for which, keys in (("sound", ("kind", "seed")), ("pairs", ("fault", "level", "seed"))):
        before = {tuple(e[k] for k in keys): e for e in old[which]}
        gained, lost, common = Counter(), Counter(), 0
        for e in new[which]:
            was = before.get(tuple(e[k] for k in keys))
            if was:
                common += 1
                label = " ".join(str(e[k]) for k in keys[:-1])
                gained[label] += e["doubted"] and not was["doubted"]
                lost[label] += was["doubted"] and not e["doubted"]
        lines.append(f"{which}: {common} logs in both; newly doubted {sum(gained.values())}, no "
                     f"longer doubted {sum(lost.values())}")
        for label in sorted(gained):
            if gained[label] or lost[label]:
                lines.append(f"  {label:28} +{gained[label]} -{lost[label]}")
    return "\n".join(lines)


def main():
    files = [json.loads(Path(f).read_text(encoding="utf-8")) for f in sys.argv[1:3]]
    print(report(files[0]) if len(files) == 1 else compare(*files))


if __name__ == "__main__":
    main()

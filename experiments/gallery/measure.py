# SPDX-License-Identifier: Apache-2.0
"""What imukit says about a log, and how far an estimate moves."""
import json
import math
import subprocess

TERMS = {"quantization": "Q", "angle_random_walk": "N", "velocity_random_walk": "N",
         "bias_instability": "B", "rate_random_walk": "K", "acceleration_random_walk": "K",
         "rate_ramp": "R", "acceleration_ramp": "R"}
EXTRAS = ("gauss_markov", "sinusoid", "resonance")


def _number(x):
    return math.inf if x is None else x


def _estimate(e):
    return {"present": e["present"], "value": _number(e["value"]), "free": _number(e["free_value"]),
            "lower": -math.inf if e["lower"] is None else e["lower"], "upper": _number(e["upper"])}


def _channel(c):
    extras = {key: len(c["extras"].get(key) or []) for key in EXTRAS}
    extras["filter"] = int(c["extras"].get("filter") is not None)
    return {"name": c["name"], "extras": extras,
            "terms": {TERMS[k]: _estimate(e) for k, e in c["terms"].items() if k in TERMS}}


def identify(imukit, operands):
    """Run `imukit identify`.  @return a dict: refused (the message, or None), doubts (codes), notes
    (messages by code), channels"""
    command = ["nice", imukit, "identify", *operands, "--json", "--threads", "1"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0 or not done.stdout:
        message = done.stderr.strip().splitlines()
        return {"refused": message[-1] if message else f"exit {done.returncode}", "doubts": [],
                "notes": {}, "warnings": [], "channels": []}
    data = json.loads(done.stdout)
    verdict = data["result"]["verdict"]
    return {"refused": None,
            "doubts": sorted({v["code"] for v in verdict if v["level"] in ("warning", "failure")}),
            "notes": {v["code"]: v["message"] for v in verdict if v["level"] in ("note", "good")},
            "warnings": sorted({w["code"] for w in data["findings"] if w["level"] == "warning"}),
            "channels": [_channel(c) for c in data["result"]["channels"]]}


def verdict_doubts(result):
    return bool(result["refused"] or result["doubts"])


def doubted(result):
    """Warnings on standard error count as doubts, as those of the verdict do."""
    return verdict_doubts(result) or bool(result["warnings"])


def codes(result):
    """The codes of all doubts, those that are on standard error only with a mark."""
    if result["refused"]:
        return ["(refused)"]
    return result["doubts"] + ["stderr:" + w for w in result["warnings"]
                               if w not in result["doubts"]]


def _moves_of(clean, faulty, factor):
    """(change, half-width of the clean interval, value), of one term."""
    both = clean["present"] and faulty["present"]
    before = factor * (clean["value"] if both else clean["free"])
    after = faulty["value"] if both else faulty["free"]
    return after - before, factor * (clean["upper"] - clean["lower"]) / 2, before


def move(clean, faulty, factor=1):
    """The largest move of any term of any channel. factor: what the fault, if it is a property, does
    to N, and so to the bound of Q, which stands on it.  @return a dict: class (0: within one
    half-width, 1: up to max(3 half-widths, 2 %), 2: beyond), term, channel, half_widths, percent;
    None when there is nothing to compare"""
    worst = None
    for a, b in zip(clean["channels"], faulty["channels"]):
        for term in a["terms"].keys() & b["terms"].keys():
            change, half, value = _moves_of(a["terms"][term], b["terms"][term],
                                            factor if term in "NQ" else 1)
            if not math.isfinite(change) or not math.isfinite(half) or half <= 0:
                continue
            limit = max(3 * half, 0.02 * abs(value))
            kind = 2 if abs(change) > limit else 1 if abs(change) > half else 0
            this = {"class": kind, "term": term, "channel": a["name"], "ratio": abs(change) / limit,
                    "half_widths": change / half,
                    "percent": 100 * change / value if value else None}
            if worst is None or (kind, this["ratio"]) > (worst["class"], worst["ratio"]):
                worst = this
    return worst


def new_extras(clean, faulty):
    """Extras that one of the two models has and the other has not."""
    return sorted({key for a, b in zip(clean["channels"], faulty["channels"])
                   for key in a["extras"] if a["extras"][key] != b["extras"][key]})


def covered(result, truth_of):
    """For each term of the truth that is not zero: (intervals that hold it, intervals)."""
    held = {}
    for c in result["channels"]:
        for term, value in truth_of(c["name"]).items():
            if value and term in c["terms"]:
                e = c["terms"][term]
                n = held.setdefault(term, [0, 0])
                n[0] += int(e["lower"] <= value <= e["upper"])
                n[1] += 1
    return held


def claimed(result, truth_of):
    """Terms that are reported as present and that the truth does not hold."""
    return sorted({term for c in result["channels"] for term, value in truth_of(c["name"]).items()
                   if not value and c["terms"].get(term, {}).get("present")})

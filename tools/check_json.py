#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What --json prints is what schemas/VERB.json says, for every verb and mode:

    tools/check_json.py          the invocations of tests/outputs that have --json, one for each mode
    tools/check_json.py REGEX    those in whose line the expression is found; unseen keys are listed

It fails if a verb has no schema, if an object does not fit its schema (a key that is not described
does not fit), or if a described key was in none of the objects. With BUILD=DIR the command of
another build is checked."""

import glob
import importlib.machinery
import importlib.util
import json
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import jsonschema

SOURCE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
IMUKIT = os.path.join(SOURCE, os.environ.get("BUILD", "build"), "imukit")
SLOW = re.compile(r"real_|identify_(runs_differ|devices_filtered|devices_two|long)|drift_disagree"
                  r"|calibrate_mag_(?!json|both)|identify_\w+_text|identify_curve_(plain|misfit)"
                  r"|grade_presets|drift_lost|calibrate_repeatability_moved")


def load(path, name):
    """A program of this folder as a module."""
    loader = importlib.machinery.SourceFileLoader(name, path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


def read_schemas():
    schemas = {}
    for path in sorted(glob.glob(os.path.join(SOURCE, "schemas", "*.json"))):
        with open(path) as file:
            schemas[os.path.basename(path)] = json.load(file)
    return schemas


class Seen:
    """Which described keys occurred. Of alternatives, only those that fit count."""

    def __init__(self):
        self.keys, self.stack = set(), []

    def validator(self):
        def properties(validator, described, instance, schema):
            if isinstance(instance, dict):
                for key in described.keys() & instance.keys():
                    (self.stack[-1] if self.stack else self.keys).add((id(described), key))
            yield from base.VALIDATORS["properties"](validator, described, instance, schema)

        def any_of(validator, choices, instance, schema):
            fits, errors = False, []
            for index, choice in enumerate(choices):
                self.stack.append(set())
                found = list(validator.descend(instance, choice, schema_path=index))
                keys = self.stack.pop()
                if found:
                    errors.extend(found)
                else:
                    fits = True
                    (self.stack[-1] if self.stack else self.keys).update(keys)
            if not fits:
                yield jsonschema.ValidationError(f"{str(instance)[:60]} fits none of the modes",
                                                 context=errors)

        base = jsonschema.Draft202012Validator
        return jsonschema.validators.extend(base, {"properties": properties, "anyOf": any_of})


def described_keys(schema, path):
    """(id of the table of properties, key): path, of all keys below; units are no keys."""
    found = {}
    if isinstance(schema, dict):
        if isinstance(schema.get("properties"), dict) and "$ref" not in schema:
            for key in schema["properties"]:
                found[id(schema["properties"]), key] = f"{path}{key}"
        for name, part in schema.items():
            if name == "properties" and "$ref" not in schema:
                for key, below in part.items():
                    found.update(described_keys(below, f"{path}{key}."))
            elif name == "$defs":
                for key, below in part.items():
                    found.update(described_keys(below, f"{path.split(':')[0]}:{key}."))
            elif name in ("items", "anyOf", "additionalProperties"):
                found.update(described_keys(part, path))
    elif isinstance(schema, list):
        for part in schema:
            found.update(described_keys(part, path))
    return found


def deepest(error):
    """The error of the alternative that fits best."""
    while error.context:
        error = max(error.context, key=lambda e: len(e.absolute_path))
    return error


def run_all(chosen, outputs, root):
    inputs = outputs.make_inputs(root, IMUKIT)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(
            lambda i: (i, outputs.run(IMUKIT, i, os.path.join(root, i.name), inputs)), chosen))


def check(results, schemas, seen):
    """What does not fit, as lines."""
    cls, faults = seen.validator(), []
    for invocation, outcome in results:
        try:
            document = json.loads(outcome.outputs["standard output"])
        except ValueError:
            faults.append(f"{invocation.line}\n  prints no JSON")
            continue
        name = f"{document['command']}.json"
        schema = schemas.get(name)
        if document["command"] is None:
            name, schema = "common.json", schemas["common.json"]["$defs"]["no_verb"]
        if schema is None:
            faults.append(f"{invocation.line}\n  there is no schemas/{name}")
            continue
        resolver = jsonschema.RefResolver(name, schemas[name], store=schemas)
        for error in map(deepest, cls(schema, resolver=resolver).iter_errors(document)):
            place = ".".join(map(str, error.absolute_path))
            faults.append(f"{invocation.line}\n  {name}, {place}: {error.message[:200]}")
        if outcome.code == 0 and "error" in document:
            faults.append(f"{invocation.line}\n  has an error and ends with 0")
    return faults


def main():
    outputs = load(os.path.join(SOURCE, "tools", "compare_outputs"), "compare_outputs")
    expression = sys.argv[1] if len(sys.argv) > 1 else ""
    schemas, seen = read_schemas(), Seen()
    for schema in schemas.values():
        jsonschema.Draft202012Validator.check_schema(schema)
    lists = sorted(glob.glob(os.path.join(SOURCE, "tests", "outputs", "commands*.txt")))
    chosen = [i for i in outputs.read_invocations(lists).values()
              if "--json" in i.words and not i.real and re.search(expression, i.line)
              and (expression or not SLOW.match(i.name))]
    root = tempfile.mkdtemp(prefix="imukit-json-")
    try:
        faults = check(run_all(chosen, outputs, root), schemas, seen)
    finally:
        outputs.remove(root)
    told = subprocess.run([IMUKIT, "help"], capture_output=True, text=True, check=True).stdout
    verbs = re.findall(r"^  ([a-z]+) +\S", told.split("Verbs")[1].split("\n\n")[0], re.M)
    faults += [f"there is no schemas/{verb}.json" for verb in verbs if f"{verb}.json" not in schemas]
    keys = {}
    for name, schema in schemas.items():
        keys.update(described_keys(schema, f"{name[:-5]}:"))
    unseen = sorted({path for key, path in keys.items() if key not in seen.keys
                     and not path.endswith(":error")})
    if not expression:
        faults += [f"{path} is described, but no invocation shows it" for path in unseen]
    else:
        print("\n".join(unseen))
    print("\n".join(faults + [f"{len(chosen)} invocations, {len(keys)} keys of {len(schemas)} "
                              f"schemas, {len(faults)} faults"]))
    return 1 if faults or not chosen else 0


if __name__ == "__main__":
    sys.exit(main())

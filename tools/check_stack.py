#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The deepest path of calls below any public function of libimukit and libimukit-physics takes at
most 48 KiB of stack.

    check_stack.py                  the objects of tools/compile_cortex.sh
    check_stack.py DIR [OBJDUMP]    other objects, compiled with -ffunction-sections,
                                    -fdata-sections, -fno-pie and -fcallgraph-info=su

The compiler's call graph names each function's frame and its calls. A call through a pointer
reaches, by the type of the pointer, every function of that type whose address the nearest caller
takes (it, or a constant table it uses, holds the address); where no caller takes one, every
function of that type whose address is taken anywhere. What is called beyond the library gets the
allowance of OUTSIDE. Frames without a bound are refused, and so is recursion that BOUNDED does not
list.
"""
import collections
import pathlib
import re
import subprocess
import sys

LIMIT = 48 * 1024
# Recursion with a bound: how many calls of a function stand on the stack at most. All that is below
# it counts as often.
BOUNDED = {
    "src/base/units/units.c:read_product": 9,  # a bracket in each of 8, BRACKETS_MAX
}
# Macros that define a function, and what it takes (src/physics/derived_rows_internal.h).
DEFINES = dict.fromkeys(["VALUE", "VALUE_IF"], "const void *design")
# What is not ours. libm: the reduction of large angles, with 4 x 20 doubles, is its deepest.
OUTSIDE = [(r"__aeabi_\w+|__\w+[sd]f\d?", 64), (r"mem\w+|str\w+", 128), (r"\w+", 1024)]

ROOT = pathlib.Path(__file__).resolve().parent.parent
NODE = re.compile(r'node: \{ title: "([^"]+)" label: "([^"\\]+)\\n([^"\\]+)\\n'
                  r'(\d+) bytes \(([^)]+)\)')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"(?: label: "([^"]+)")?')
RELOCATION = re.compile(r"^[0-9a-f]+\s+(\S+)\s+(\S+?)(?:[-+]0x[0-9a-f]+)?$")
ADDRESS = re.compile(r"R_ARM_(ABS32|THM_MOVW_ABS_NC)|R_X86_64_(32S?|64)")


class Graph:
    def __init__(self):
        self.frame, self.place, self.calls, self.pointer_calls = {}, {}, {}, {}
        self.refers = collections.defaultdict(set)  # function or table: functions and tables


def read_calls(path, graph, complaints):
    text = path.read_text()
    for title, _, place, size, kind in NODE.findall(text):
        graph.frame[title], graph.place[title] = int(size), place
        graph.calls.setdefault(title, set())
        graph.pointer_calls.setdefault(title, set())
        if kind not in ("static", "dynamic,bounded"):
            complaints.append(f"{place}: the frame of {title} has no bound")
    for caller, callee, place in EDGE.findall(text):
        if callee == "__indirect_call":
            graph.pointer_calls.setdefault(caller, set()).add(place)
        else:
            graph.calls.setdefault(caller, set()).add(callee)


def listings(objdump, option, paths):
    """What objdump says of each file."""
    told = subprocess.run([objdump, option, *paths], capture_output=True, text=True, check=True)
    parts = re.split(r"^(\S+): +file format .*$", told.stdout, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


def read_addresses(path, symbols, relocations, graph):
    """Who holds whose address. A symbol of one file only gets the file's name in front."""
    unit = re.search(r'title: "([^"]+)"', path.with_suffix(".ci").read_text())[1]
    public = {line.split()[-1] for line in symbols.splitlines() if re.match(r"\w+ g", line)}

    def name_of(section_or_symbol):
        name = re.sub(r"^\.(text\.(unlikely|startup|exit|hot)|text|rodata|data\.rel\.ro(\.local)?|"
                      r"data|bss)\.", "", section_or_symbol)
        local = name in public or not (section_or_symbol.startswith(".") or name in own)
        return name if local else f"{unit}:{name}"

    own = {line.split()[-1] for line in symbols.splitlines() if re.match(r"\w+ l", line)}
    holder = None
    for line in relocations.splitlines():
        section = re.match(r"RELOCATION RECORDS FOR \[(\.(?:text|rodata|data)\S*)\]", line)
        if line.startswith("RELOCATION"):
            holder = name_of(section[1]) if section else None
        elif holder and (match := RELOCATION.match(line)) and ADDRESS.fullmatch(match[1]):
            graph.refers[holder].add(name_of(match[2]))


def parameter_types(text):
    """The types of a list of parameters, without their names."""
    types = []
    for parameter in re.sub(r"/\*.*?\*/", "", text).split(","):
        parameter = re.sub(r"\[\w*\]", "*", parameter)
        match = re.fullmatch(r"((?:const |struct |unsigned )*\w+)((?: |\*|const\b)*)(\w*)(\**)",
                             " ".join(parameter.split()))
        if not match:
            return None
        types.append((match[1] + match[2] + match[4]).replace(" ", "").replace("*const", "*"))
    return ", ".join(types)


class Types:
    """Types of functions and of pointers to them, from the source."""

    def __init__(self):
        self.lines, self.pointers, self.named = {}, collections.defaultdict(set), {}
        text = "".join(path.read_text() for folder in ("include", "src")
                       for path in sorted((ROOT / folder).rglob("*.[ch]")))
        text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
        for name, parameters in re.findall(r"\(\*(\w+)\)\(([^()]*)\)", text) + \
                re.findall(r"typedef \w+ (\w+)\(([^()]*)\);", text):
            self.pointers[name].add(parameter_types(parameters))
        variables = collections.defaultdict(set)
        for name, variable in re.findall(r"\b(\w+)(?= \*?(?:const )?(\w+))", text):
            variables[name].add(variable)
        for name in list(self.pointers):  # what has a named type
            for variable in variables[name]:
                self.pointers[variable] |= self.pointers[name]

    def at(self, place):
        name, line, column = place.rsplit(":", 2)
        if name not in self.lines:
            self.lines[name] = (ROOT / name).read_text().splitlines()
        lines = self.lines[name][int(line) - 1:]
        return lines[0][int(column) - 1:] + "\n" + "\n".join(lines[1:12])

    def of_function(self, place):
        text = self.at(place)
        match = re.match(r"\w+\(([^()]*)\)", text)
        taken = DEFINES.get(text.split("(")[0], match and match[1])
        return parameter_types(taken) if taken else None

    def of_call(self, place):
        match = re.match(r"[\w.>\[\]\s-]*?(\w+)\(", self.at(place))
        return self.pointers.get(match[1], set()) if match else set()


class Depth:
    """Depth of the stack below each function, by who was last to take addresses of each type."""

    def __init__(self, graph, types, complaints):
        self.graph, self.complaints = graph, complaints
        self.known, self.open, self.taken_of = {}, [], {}
        functions = {f for held in graph.refers.values() for f in held if f in graph.frame}
        self.type_of = {f: types.of_function(graph.place[f]) for f in functions}
        self.everywhere = collections.defaultdict(set)
        for function, kind in self.type_of.items():
            self.everywhere[kind].add(function)
            if kind is None:
                complaints.append(f"{graph.place[function]}: cannot read the type of {function}")
        self.kinds = {}
        for function, places in graph.pointer_calls.items():
            self.kinds[function] = set()
            for place in places:
                kinds = types.of_call(place)
                self.kinds[function] |= kinds
                if not kinds or None in kinds:
                    complaints.append(f"{place}: cannot read the type of what is called")
        self.needs = self.reachable_kinds()

    def reachable_kinds(self):
        """Types that are called through pointers anywhere below a function."""
        needs = {f: set(kinds) for f, kinds in self.kinds.items()}
        changed = True
        while changed:
            changed = False
            for function in needs:
                below = set(self.graph.calls[function])
                for kind in needs[function]:
                    below |= self.everywhere[kind]
                more = set().union(*(needs.get(f, set()) for f in below)) - needs[function]
                if more:
                    needs[function] |= more
                    changed = True
        return needs

    def taken(self, function):
        """Functions whose address this one, or a table it uses, holds; by type."""
        if function not in self.taken_of:
            seen, left = set(), [function]
            while left:
                for name in self.graph.refers.get(left.pop(), ()):
                    if name not in seen:
                        seen.add(name)
                        if name not in self.graph.frame:
                            left.append(name)
            found = collections.defaultdict(set)
            for name in seen & self.type_of.keys():
                found[self.type_of[name]].add(name)
            self.taken_of[function] = found
        return self.taken_of[function]

    def outside(self, name):
        return next(size for pattern, size in OUTSIDE if re.fullmatch(pattern, name))

    def of(self, function, given=()):
        """(bytes, path) of the deepest calls from a function on."""
        if function not in self.graph.frame:
            return self.outside(function), ((function, self.outside(function)),)
        bound = dict(given) | {kind: frozenset(f) for kind, f in self.taken(function).items()}
        bound = {kind: f for kind, f in bound.items() if kind in self.needs[function]}
        key = (function, frozenset(bound.items()))
        if key in self.known:
            return self.known[key]
        if key in self.open:
            if function not in BOUNDED:
                names = [f for f, _ in self.open[self.open.index(key):]] + [function]
                self.complaints.append("recursion without a stated bound: " + " > ".join(names))
            return 0, ()
        self.open.append(key)
        below = set(self.graph.calls[function])
        for kind in self.kinds[function]:
            below |= bound.get(kind, self.everywhere[kind])
        depth, path = max((self.of(f, bound.items()) for f in sorted(below)), default=(0, ()))
        self.open.pop()
        frame, times = self.graph.frame[function], BOUNDED.get(function, 1)
        path = ((function, frame),) + path
        result = (depth + frame) * times, path * times
        if not any(f in BOUNDED for f, _ in self.open):  # else part of it may be missing
            self.known[key] = result
        return result


def declared():
    """Functions of the public headers."""
    text = "".join(path.read_text() for path in (ROOT / "include/imukit").glob("*.h"))
    return set(re.findall(r"\b(imk_\w+)\(", text))


def main():
    if len(sys.argv) > 1:
        folder = pathlib.Path(sys.argv[1])
    else:
        folder = ROOT / "build-check/cortex-m4"
        subprocess.run([ROOT / "tools/compile_cortex.sh"], check=True)
    objdump = sys.argv[2] if len(sys.argv) > 2 else "arm-none-eabi-objdump"
    graph, complaints = Graph(), []
    paths = sorted(folder.glob("*.ci"))
    objects = [str(path.with_suffix(".o")) for path in paths]
    symbols, relocations = (listings(objdump, option, objects) for option in ("-t", "-r"))
    for path, name in zip(paths, objects):
        read_calls(path, graph, complaints)
        read_addresses(path, symbols[name], relocations[name], graph)
    depth = Depth(graph, Types(), complaints)
    public = sorted(declared() & graph.frame.keys())
    deepest = sorted((depth.of(name) for name in public), reverse=True)
    for size, path in deepest:
        if size > LIMIT:
            complaints.append(f"{path[0][0]}: {size} bytes of stack, more than {LIMIT}")
    for line in complaints:
        print(line)
    for name, size in deepest[0][1]:
        print(f"{size:7d}  {name}")
    print(f"{len(public)} public functions; {deepest[0][1][0][0]} goes deepest, "
          f"{deepest[0][0] / 1024:.1f} KiB of {LIMIT // 1024}")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())

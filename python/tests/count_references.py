# SPDX-License-Identifier: Apache-2.0
"""References that the examples of all docstrings leave behind, counted by a debug interpreter.

    python3-dbg count_references.py [ROUNDS]

Each example is run ROUNDS times (default 20, at least 4) between two counts of all references and of
all blocks of memory; what an empty one leaves is the counting's own. One that leaves a reference or a
block behind each time, also in five times as many rounds, is told, and fails. The extension must be
compiled for the debug interpreter."""
import contextlib
import doctest
import gc
import importlib
import io
import pkgutil
import sys
import warnings

sys.modules["numpy"] = None  # is compiled for another interpreter, so its references are miscounted
import imukit  # noqa: E402


def examples():
    finder = doctest.DocTestFinder(exclude_empty=True)
    for name in ["", *(f".{m.name}" for m in pkgutil.iter_modules(imukit.__path__))]:
        module = importlib.import_module(f"imukit{name}")
        for test in finder.find(module, module.__name__):
            source = "".join(example.source for example in test.examples)
            if source:
                yield test.name, compile(source, test.name, "exec"), test.globs


def counts():
    gc.collect()
    return sys.gettotalrefcount(), sys.getallocatedblocks()


def left_behind(code, names, rounds):
    """References and blocks that are more after `rounds` rounds: the less of two times, since
    caches fill at some time or other."""
    least = [sys.maxsize] * 2
    for _ in range(2):
        before = counts()
        for _ in range(rounds):
            with contextlib.redirect_stdout(io.StringIO()):
                exec(code, dict(names))
        least = [min(x, after - b) for x, after, b in zip(least, counts(), before)]
    return least


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    warnings.simplefilter("ignore")
    failed = total = 0
    for name, code, names in examples():
        total += 1
        for count in rounds, 5 * rounds:  # what is left once looks like what is left by few rounds
            own = left_behind(compile("", "nothing", "exec"), {}, count)
            left = left_behind(code, names, count)
            references, blocks = left[0] - own[0], left[1] - own[1]
            if max(references, blocks) <= 0.9 * count:
                break
        else:
            failed += 1
            print(f"{name}: {references} references and {blocks} blocks after {count} rounds")
    print(f"{total} examples, {rounds} rounds each: {failed} leave something behind")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())

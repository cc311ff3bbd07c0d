# SPDX-License-Identifier: Apache-2.0
"""Runs the Python blocks of a page one after another, as a notebook does (tools/check_docs.py).

Reads lines of JSON, {"code": …}, and answers each with {"printed", "figure", "failed"}: what the
block printed with the representation of its last expression, and the figure of that, if it has one.
"""
import ast
import contextlib
import io
import json
import sys
import traceback


def run(code, names):
    """The value of the last expression, or None."""
    tree = ast.parse(code, "page")
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "page", "exec"), names)
    return eval(compile(ast.Expression(last.value), "page", "eval"), names) if last else None


def answer(code, names):
    said, failed, figure = io.StringIO(), False, None
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            value = run(code, names)
            if value is not None:
                print(repr(value))
            figure = value.figure() if hasattr(value, "figure") else None
        except Exception:
            failed = True
            traceback.print_exc()
    return {"printed": said.getvalue(), "figure": figure, "failed": failed}


def main():
    names = {"__name__": "__main__"}
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line)["code"], names)), flush=True)


main()

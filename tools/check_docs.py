#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The pages do what they say: every fenced block of README.md, CONTRIBUTING.md and docs is run, and
so are the examples that --help begins with.

    tools/check_docs.py                     all pages
    tools/check_docs.py docs/logs.md help   those whose name begins so
    tools/check_docs.py --update ...        what pages print is replaced by what is printed now

Each page has a folder of its own, which looks like the root of the repository. What is done with a
block follows from its language:

    sh           run, after those above it; it has to succeed
    python       run, in one session a page, with the package imukit of this build
    text         compared with what the sh or python block above it printed, with the value of its
                 last expression; a line … stands for any lines
    yaml, csv    a whole file: the command has to accept it
    json         parsed
    c            compiled

A comment right before a block, which no reader of the page sees, says more:

    <!-- not run: REASON -->    the block is counted only
    <!-- file: NAME -->         the block is this file of the page's folder
    <!-- exit: CODE -->         the sh block ends so
    <!-- before: TEXT -->       stands before the C or Python; braces it opens are closed behind
    <!-- setup: COMMANDS -->    run where they stand: what a reader has and the page does not make
    <!-- figure: NAME -->      the value of the python block is drawn in docs/images/NAME.svg

Links have to lead somewhere, `--options` to be options, and an index.md to name all pages of its
folder. Scratch is build-check/docs, where the folders of pages with faults stay."""
import collections
import concurrent.futures
import difflib
import itertools
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = (ROOT / os.environ.get("BUILD", "build")).resolve()
SCRATCH = ROOT / "build-check" / "docs"
ENVIRONMENT = {**os.environ, "PATH": f"{BUILD}:{os.environ['PATH']}", "LC_ALL": "C.UTF-8"}
PACKAGE = BUILD / "python-package"
LIMIT = ["timeout", "120"]  # seconds for a block, on a busy machine
SHELL = ["bash", "-euo", "pipefail", "-c"]
COMPILE = ["gcc", "-std=c17", "-Wall", "-Wextra", "-Werror", "-Wno-unused", "-fsyntax-only",
           f"-I{ROOT}/include"]
YAML = {  # what a file holds, by a key, and a command that reads it
    "imukit_motion": "imukit simulate navigation --motion {} --rate 100Hz --duration 1s",
    "imukit_temperature": "imukit simulate navigation --temperature {} --rate 1Hz --duration 9s",
    "instrument": "imukit physics {} --show",
    "imukit": "imukit convert {} accepted.json",
}
MARKER = re.compile(r"<!--\s*(not run|file|exit|before|setup|figure):\s*(.*?)\s*-->", re.S)
OTHER_PROGRAMS = re.compile(r"sbatch|cmake|pkg-config|tools/")
Block = collections.namedtuple("Block", "line kind lines markers")


def blocks_of(text):
    """The fenced blocks of a page, by the number of their fence; setup comments are of that kind."""
    lines, markers, number = text.split("\n"), {}, 0
    while number < len(lines):
        begin = number
        if lines[begin].startswith("<!--"):
            while "-->" not in lines[number]:
                number += 1
            found = MARKER.fullmatch("\n".join(lines[begin:number + 1]))
            if found and found[1] == "setup":
                yield Block(begin + 1, "setup", found[2].split("\n"), {})
            elif found:
                markers[found[1]] = found[2]
        elif lines[begin].lstrip().startswith("```"):
            number = lines.index("```", begin + 1)
            yield Block(begin + 1, lines[begin][3:], lines[begin + 1:number], markers)
            markers = {}
        elif lines[begin]:
            markers = {}
        number += 1


def renewed(shown, printed):
    """What a block has to show, given all that was printed: the same, unless it is out of date."""
    if "…" not in shown:
        return printed
    result, line = [], 0
    parts = [list(lines) for _, lines in itertools.groupby(shown, "…".__eq__)]
    for part in parts:
        if part[0] == "…":
            result.append("…")
            continue
        places = range(line, len(printed) - len(part) + 1)
        places = places[:1] if part is parts[0] else places[-1:] if part is parts[-1] else places
        if places:
            begin = max(places, key=lambda at: likeness(part, printed[at:at + len(part)]))
            line = begin + len(part)
            result += printed[begin:line]
    return result


def likeness(one, other):
    """Equal lines before like ones; numbers and blanks do not count for these."""
    words = [re.sub(r"[-\d.\s]+", " ", "\n".join(lines)) for lines in (one, other)]
    return one == other, difflib.SequenceMatcher(None, *words, autojunk=False).ratio()


def indented(lines):
    return "\n".join("    " + line for line in lines)


class Page:
    """A page, what was done with its blocks, and what is wrong with them."""

    def __init__(self, name, text):
        self.name, self.text, self.lines = name, text, text.split("\n")
        self.complaints, self.done, self.reasons = [], collections.Counter(), collections.Counter()
        self.printed, self.stale, self.seconds = None, [], 0.0
        self.session, self.figures = None, {}
        self.folder = SCRATCH / name.replace("/", "-").removesuffix(".md")

    def complain(self, line, text):
        self.complaints.append(f"{self.name}:{line}: {text}")

    def check(self):
        begin = time.monotonic()
        shutil.rmtree(self.folder, ignore_errors=True)
        (self.folder / "build").mkdir(parents=True)
        (self.folder / "build" / "imukit").symlink_to(BUILD / "imukit")
        for name in ("docs", "examples", "include", "tests"):
            (self.folder / name).symlink_to(ROOT / name)
        try:
            for block in blocks_of(self.text):
                self.check_block(block)
        except (ValueError, IndexError):
            self.complain(len(self.lines), "a block or a comment has no end")
        if self.session:
            self.session.communicate()
        if not self.complaints:
            shutil.rmtree(self.folder)
        self.seconds = time.monotonic() - begin

    def check_block(self, block):
        if block.kind == "sh":
            self.printed = None
        if "not run" in block.markers:
            self.reasons[block.markers["not run"]] += 1
            return
        if "file" in block.markers:
            (self.folder / block.markers["file"]).write_text("\n".join(block.lines) + "\n")
        check = getattr(self, "check_" + (block.kind or "nothing"), None)
        if check:
            check(block)
            self.done[block.kind] += 1
        else:
            self.complain(block.line, f'a block of language "{block.kind}": what is to be done with'
                          " it? See the head of tools/check_docs.py")

    def run(self, block, command, text=""):
        """What the command prints in the page's folder; a complaint when it does not end as said."""
        code = int(block.markers.get("exit", 0))
        answer = subprocess.run(LIMIT + command, input=text, cwd=self.folder, env=ENVIRONMENT,
                                text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                check=False)
        lines = [line.rstrip() for line in answer.stdout.rstrip().split("\n")]
        if answer.returncode != code:
            self.complain(block.line, f"the {block.kind} block ends with {answer.returncode}, not "
                          f"{code}:\n{indented(lines[-12:])}")
        return lines

    def check_sh(self, block):
        self.printed = self.run(block, SHELL + ["\n".join(block.lines)])

    def check_setup(self, block):
        self.run(block, SHELL + ["\n".join(block.lines)])

    def check_text(self, block):
        if self.printed is None:
            self.complain(block.line, "this is printed by no sh block above")
            return
        now = renewed(block.lines, self.printed)
        if now != block.lines:
            difference = difflib.unified_diff(block.lines, now, "shown", "printed", lineterm="")
            self.complain(block.line, f"not what is printed:\n{indented(difference)}")
            self.stale.append((block, now))

    def check_yaml(self, block):
        text = "\n".join(block.lines) + "\n"
        key = next((key for key in YAML if re.search(f"^{key}:", text, re.M)), None)
        if key:
            (self.folder / "block.yaml").write_text(text)
            self.run(block, YAML[key].format("block.yaml").split())
        else:
            self.complain(block.line, "not a whole model, motion, temperature or design file")

    def check_csv(self, block):
        self.run(block, ["imukit", "convert", "-", "-"], "\n".join(block.lines) + "\n")

    def check_json(self, block):
        try:
            json.loads("\n".join(block.lines))
        except ValueError as error:
            self.complain(block.line, f"not JSON: {error}")

    def check_c(self, block):
        before = block.markers.get("before", "")
        behind = "}" * (before.count("{") - before.count("}"))
        folders = sorted({f"-I{header.parent}" for header in self.folder.rglob("*.h")})
        self.run(block, COMPILE + folders + ["-xc", "-"],
                 "\n".join([before, *block.lines, behind, ""]))

    def check_python(self, block):
        if not self.session:
            self.session = subprocess.Popen(
                ["/usr/bin/python3", ROOT / "tools/python_session.py"], cwd=self.folder, text=True,
                env={**ENVIRONMENT, "PYTHONPATH": PACKAGE}, stdin=subprocess.PIPE,
                stdout=subprocess.PIPE)
        code = "\n".join([block.markers.get("before", ""), *block.lines])
        self.session.stdin.write(json.dumps({"code": code}) + "\n")
        self.session.stdin.flush()
        answer = json.loads(self.session.stdout.readline())
        self.printed = [line.rstrip() for line in answer["printed"].rstrip().split("\n")]
        if answer["failed"]:
            self.complain(block.line, f"the python block fails:\n{indented(self.printed[-12:])}")
        if "figure" in block.markers:
            self.check_figure(block, answer["figure"])

    def check_figure(self, block, drawn):
        """A figure is there and about as long as what is drawn now: the last digits of estimates
        depend on the machine."""
        file = ROOT / "docs/images" / f"{block.markers['figure']}.svg"
        there = len(file.read_text()) if file.exists() else 0
        if not drawn:
            self.complain(block.line, "the value of the python block has no figure")
        elif not 0.8 < len(drawn) / (there or 1) < 1.25:
            self.complain(block.line, f"{file.name} is not what is drawn")
        self.figures[file] = drawn or ""

    def check_words(self, options):
        """Links, options and stray commands between the blocks."""
        fenced = False
        for number, line in enumerate(self.lines, 1):
            fenced ^= line.startswith("```")
            if fenced:
                continue
            if re.match(r" {4,}(\$ |(build/)?imukit )", line):
                self.complain(number, "a command outside a fenced block is not run")
            for target in re.findall(r"\]\(([^)\s]+)\)", re.sub("`[^`]*`", "", line)):
                self.check_link(number, target)
            for code in re.findall("`([^`]+)`", line):
                for option in re.findall(r"(?<!\S)--[a-z][a-z-]*", code):
                    if option not in options and not OTHER_PROGRAMS.match(code):
                        self.complain(number, f"no verb has an option {option}")

    def check_link(self, number, target):
        path, _, anchor = target.partition("#")
        file = (ROOT / self.name).parent / path if path else ROOT / self.name
        if path.startswith("http"):
            return
        if not file.exists():
            self.complain(number, f"{target} is not there")
        elif anchor and anchor not in anchors_of(file):
            self.complain(number, f"{path or 'this page'} has no heading #{anchor}")

    def update(self):
        for block, now in reversed(self.stale):
            self.lines[block.line:block.line + len(block.lines)] = now
        (ROOT / self.name).write_text("\n".join(self.lines))

    def update_figures(self):
        for file, drawn in self.figures.items():
            file.write_text(drawn)


def anchors_of(file):
    headings = re.findall(r"^#+ (.*)$", file.read_text(), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def unlisted_pages():
    for index in sorted(ROOT.glob("docs/**/index.md")):
        links = set(re.findall(r"\]\(([^)#]+)", index.read_text()))
        for page in sorted(index.parent.glob("*.md")):
            if page != index and page.name not in links:
                yield f"{index.relative_to(ROOT)}: {page.name} is not in it"


def help_of(*verb):
    return subprocess.run([BUILD / "imukit", *verb, "--help"], capture_output=True, text=True,
                          check=True).stdout


def help_page(verb, text):
    """The examples of a verb's help, after tools/help_inputs.sh has made what they read."""
    head = re.split("^(?:Usage|Verbs)$", text, maxsplit=1, flags=re.M)[0]
    blocks = [f"```sh\n{example}\n```" for example in re.findall("^  (imukit .*)$", head, re.M)]
    setup = f"<!-- setup: bash {ROOT}/tools/help_inputs.sh {verb} -->"
    return Page(f"help-{verb}", "\n".join([setup, *blocks]))


def pages_of_everything():
    files = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(ROOT.glob("docs/**/*.md"))]
    pages = [Page(str(file.relative_to(ROOT)), file.read_text()) for file in files]
    helps = {"imukit": help_of()}
    for verb in re.findall(r"^  (?!imukit)([a-z]+) +\S", helps["imukit"].split("Verbs\n")[1], re.M):
        helps[verb] = help_of(verb)
    options = set(re.findall(r"--[a-z][a-z-]*", " ".join(helps.values())))
    for page in pages:
        page.check_words(options | {"--help"})
    # So do findings, from which sentences that judge are made.
    findings = Page("src/report/finding_text.c", "")
    for number, line in enumerate((ROOT / findings.name).read_text().splitlines(), 1):
        for option in set(re.findall(r"--[a-z][a-z-]*", line)) - options - {"--help"}:
            findings.complain(number, f"no verb has an option {option}")
    return [*pages, findings] + [help_page(verb, text) for verb, text in helps.items()]


FAULTS = """```sh
echo right; echo 2
```
```text
wrong
…
```
```sh
echo so; false
```
```
no language
```
<!-- not run: a reason -->
```sh
exit 1
```
```yaml
gyro: {}
```
[there](nowhere.md) and `--nothing`
"""


def check_the_check():
    """The faults of a wrong page are found: else all of this would prove nothing."""
    page = Page("faults", FAULTS)
    page.check()
    page.check_words(set())
    lines = [complaint.split(":")[1] for complaint in page.complaints]
    if lines != ["4", "8", "11", "18", "21", "21"] or page.stale[0][1] != ["right", "…"]:
        sys.exit("the faults of a wrong page are not found, but:\n" + "\n".join(page.complaints))
    shutil.rmtree(page.folder)


def make_package():
    """The package that the python blocks import."""
    subprocess.run([ROOT / "tools/build_package.sh", PACKAGE, "/usr/bin/python3"],
                   env={**os.environ, "BUILD": str(BUILD)}, check=True)


def main(arguments):
    subprocess.run([ROOT / "tools/release_build.sh", "imukit-command"], check=True)
    make_package()
    check_the_check()
    wanted = tuple(name for name in arguments if name != "--update") or ("",)
    pages = [page for page in pages_of_everything() if page.name.startswith(wanted)]
    pages.sort(key=lambda page: -page.text.count("imukit "))  # long ones first
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(Page.check, pages))

    for page in sorted(pages, key=lambda page: -page.seconds)[:8]:
        print(f"{page.seconds:6.1f} s  {page.name}")
    done = sum((page.done for page in pages), collections.Counter())
    reasons = sum((page.reasons for page in pages), collections.Counter())
    complaints = [text for page in pages for text in page.complaints] + list(unlisted_pages())
    for reason, count in reasons.most_common():
        print(f"not run: {count} {reason}")
    print("".join(text + "\n" for text in complaints), end="")
    if "--update" in arguments:
        for page in filter(lambda page: page.stale, pages):
            page.update()
        for page in pages:
            page.update_figures()
    files = sum(count for kind, count in done.items() if kind not in ("sh", "text", "setup"))
    print(f"{len(pages)} pages: {done['sh']} blocks run, {done['text']} compared, {files} files and "
          f"programs, {sum(reasons.values())} not run")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

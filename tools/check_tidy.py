#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""clang-tidy (.clang-tidy) on the libraries, the command, the extension of Python, the examples, the
fuzz entry points and what is in the page only, with clang's own warnings.

    tools/check_tidy.py          the analyzer gives up on a function after 3,000 steps
    tools/check_tidy.py --deep   after 225,000, its own limit: five minutes (make tidy-deep)

Nearly all the time is the analyzer's. It follows calls within a file either way: a fault that takes
two functions, such as a pointer that one leaves unset and the other frees, is seen within few steps.
Of functions in other files it knows what tools/analyzer_models says.

A file is not looked at again while its text, what it includes and the rules are what they were when
it passed (build-check/tidy).
"""
import concurrent.futures
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODELS = pathlib.Path("tools/analyzer_models")
PASSED = pathlib.Path("build-check/tidy")
FILES_AT_ONCE = 12
# clang's own, for what only it warns about: cmake/flags.cmake has gcc's.
WARNINGS = """-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
    -Wstrict-prototypes -Wmissing-prototypes""".split()
# What web/core is compiled with (web/CMakeLists.txt); its functions are called from JavaScript.
WEB = """--target=wasm32-wasi -include web/core/machine.h -D_Thread_local= -D_WASI_EMULATED_SIGNAL
    -D_WASI_EMULATED_MMAN -D_WASI_EMULATED_PROCESS_CLOCKS -Wno-missing-prototypes""".split()
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def package(*names):
    """Compiler flags of the first of these packages that is installed; None when none is."""
    for name in names:
        found = subprocess.run(["pkg-config", "--cflags", name], capture_output=True, text=True)
        if found.returncode == 0:
            return found.stdout.split()
    return None


def own_flags(file, text):
    """What a file is compiled with besides; None when it cannot be. `text`: with all it includes."""
    name = file.name
    for end, flags in [("avx2.c", ["-mavx2", "-mfma"]), ("fma.c", ["-mfma"]),
                       ("avx512.c", ["-mavx512f", "-mavx512dq"])]:
        if name.endswith(end):
            return flags
    if pathlib.Path("web/core") in file.parents:
        return WEB if pathlib.Path("/usr/include/wasm32-wasi").exists() else None
    if "#include <mex.h>" in text:
        place = shutil.which("mkoctfile") and subprocess.run(
            ["mkoctfile", "-p", "OCTINCLUDEDIR"], capture_output=True, text=True).stdout.strip()
        return ["-isystem", place] if place else None
    if "#include <Python.h>" in text:
        place = sysconfig.get_path("include")
        return ["-isystem", place] if (pathlib.Path(place) / "Python.h").exists() else None
    if "#include <hdf5.h>" in text:
        return package("hdf5-serial", "hdf5")
    return package("mpi-c") if name.endswith("_mpi.c") else []


class Texts:
    """Files with all that they include of ours, each read once."""

    def __init__(self):
        self.text, self.included = {}, {}

    def read(self, file):
        if file not in self.text:
            self.text[file] = file.read_text(encoding="utf-8")
            places = [file.parent, *map(pathlib.Path, ["include", "src", "cli"])]
            found = [next((place / name for place in places if (place / name).exists()), None)
                     for name in INCLUDE.findall(self.text[file])]
            self.included[file] = [path for path in found if path]
        return self.text[file]

    def all_of(self, file):
        seen, left = set(), [file]
        while left:
            path = left.pop()
            if path not in seen:
                seen.add(path)
                self.read(path)
                left += self.included[path]
        return "".join(self.text[path] for path in sorted(seen))


def stale(files, deep):
    """Flags and key of every file that has not passed as it is."""
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True).stdout
    rules = b"".join(path.read_bytes() for path in
                     [pathlib.Path(".clang-tidy"), *sorted(MODELS.iterdir())])
    modelled = {path.stem for path in MODELS.glob("*.model")}
    defines = re.compile(r"^\w[\w *]*\b(" + "|".join(modelled) + r")\(", re.MULTILINE)
    texts, found = Texts(), {}
    for file in files:
        text = texts.all_of(file)
        flags = own_flags(file, text)
        if flags is None:
            continue
        analyzer = f"max-nodes={225000 if deep else 3000}"
        if not defines.search(texts.read(file)): # a function has one body
            analyzer += f",model-path={MODELS}"
        flags = ["-std=c17", "-Iinclude", "-Isrc", "-Icli", *WARNINGS, *flags,
                 "-Xclang", "-analyzer-config", "-Xclang", analyzer]
        whole = "\0".join([*flags, text]).encode()
        key = hashlib.sha256(version + rules + whole).hexdigest()
        if not (PASSED / key).exists():
            # clang 14 takes va_start and va_copy for unknown functions in all files of a process but
            # the first.
            alone = file.name if re.search(r"\bva_(start|copy)\b", texts.text[file]) else ""
            found.setdefault((alone, *flags), []).append((file, key))
    return found


def check(flags, batch):
    """What clang-tidy says about these files; None when that is nothing."""
    run = subprocess.run(["clang-tidy", "--quiet", *(file for file, _ in batch), "--", *flags],
                         stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    if run.returncode == 0:
        for _, key in batch:
            (PASSED / key).touch()
        return None
    return run.stdout or f"clang-tidy ended with {run.returncode}: {batch[0][0]} …\n"


def main():
    os.chdir(ROOT)
    PASSED.mkdir(parents=True, exist_ok=True)
    # The largest first, so that nobody waits for them at the end.
    files = sorted((path for folder in ["src", "cli", "matlab", "python", "examples", "fuzz",
                                   "web"]
                    for path in pathlib.Path(folder).rglob("*.c")),
                   key=lambda path: -path.stat().st_size)
    batches = [(flags, group[i:i + FILES_AT_ONCE])
               for (_, *flags), group in stale(files, "--deep" in sys.argv[1:]).items()
               for i in range(0, len(group), FILES_AT_ONCE)]
    failed = False
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for said in pool.map(lambda batch: check(*batch), batches):
            if said:
                failed = True
                print(said, end="", flush=True)
    if not failed:
        print(f"{len(files)} files")
    return failed


if __name__ == "__main__":
    sys.exit(main())

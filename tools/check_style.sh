#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# House rules a program can check: licence line, unique file names, nothing left behind, no name of
# the library without its prefix, citations that resolve.
set -u
cd "$(dirname "$0")/.."
status=0
complain() { echo "$*"; status=1; }

mapfile -t code < <(find include src cli python tests bench fuzz examples experiments web tools .ci cmake Makefile \
    CMakeLists.txt -type f \( -name '*.[ch]' -o -name '*.cpp' -o -name '*.sh' -o -name '*.py' \
    -o -name '*.cmake' -o -name '*.js' -o -name '*.mjs' -o -name CMakeLists.txt -o -name Makefile -o -path 'tools/*' \
    -o -path '.ci/*' \) ! -name '*.txt' ! -name '*.pyc' ; echo CMakeLists.txt)
awk 'FNR > 3 { nextfile }
    /SPDX-License-Identifier: Apache-2.0/ { has[FILENAME] }
    END {
        for (i = 1; i < ARGC; i++)
            if (!(ARGV[i] in has)) {
                print ARGV[i] ": no SPDX line at the head"
                failed = 1
            }
        exit failed
    }' "${code[@]}" || status=1

# A name says what is inside; two files of the same name would not. The header of a module may have
# the name of its source file.
for name in $(find src cli python web -name '*.c' -printf '%f\n' | sort | uniq -d); do
    complain "$name: more than one file has this name:" \
        $(find src cli python web -name "$name" -printf '%p ')
done

# Of two messages with one code the second would never be told.
for code in $(grep -oE '^    \{"[^"]+"' src/report/finding_text.c | sort | uniq -d | tr -d ' {"'); do
    complain "src/report/finding_text.c: two messages have the code $code: name the job, JOB:$code"
done

grep -rnE '\b(TODO|FIXME|XXX|HACK)\b' include src cli python web tests bench fuzz examples cmake &&
    complain "something is left behind (above)"

# Scripts that no other check runs can be parsed.
/usr/bin/python3 -c 'import ast, sys
for f in sys.argv[1:]: ast.parse(open(f).read(), f)' experiments/gallery/*.py ||
    complain "a script of experiments/gallery cannot be parsed (above)"

# What clang-format leaves where it has broken a comment's lines: a line of a /** block that lost its
# indentation, blanks from the line's end in the middle of what a /**< comment says.
mapfile -t headers < <(printf '%s\n' "${code[@]}" | grep '\.[ch]$')
awk 'function told(line, what) { print FILENAME ":" line ": " what; found = 1 }
     FNR == 1 { block = member = 0 }
     /^ *\/\*\*( |$)/ { block = 1; deep = lost = 0 }
     block && /^ *\*  [^ ]/ { deep = 1 }
     block && /^ *\* [^ \/]/ && !lost { lost = FNR }
     block && /\*\// { if (deep && lost) told(lost, "a comment has lost its indentation"); block = 0 }
     /\/\*\*</ { member = 1; text = $0; sub(/.*\/\*\*< */, "", text) }
     member && !/\/\*\*</ { text = $0; sub(/^ */, "", text) }
     member && text ~ /[^ ]  +[^ ]/ { told(FNR, "blanks in the middle of a comment") }
     member && /\*\// { member = 0 }
     END { exit found }' "${headers[@]}" || complain "a comment was broken (above)"

# A public function says what it does.
awk '/^IMK_API/ && before !~ /\*\/$/ { print FILENAME ":" FNR ": no comment"; found = 1 }
     { before = $0 }
     END { exit found }' include/imukit/*.h || complain "a public function has no comment (above)"

# Every [KEY] cited is in docs/references.md, and there is nothing that nobody cites.
key='[A-Z][A-Z-]+[0-9]{2,4}(\.[0-9]+)?[a-z]?'
sources="include src cli tests bench fuzz examples tools docs/theory docs/physics"
cited=$(grep -rhoE "\[$key(, [^]]*)?\]" $sources 2>/dev/null | grep -oE "\b$key\b" | sort -u)
listed=$(grep -oE "^\| $key " docs/references.md | tr -d '| ' | sort -u)
for name in $(comm -23 <(echo "$cited") <(echo "$listed")); do
    complain "$name is cited in" $(grep -rlF "$name" $sources 2>/dev/null | head -n 2) \
        "and not in docs/references.md"
done
for name in $(comm -13 <(echo "$cited") <(echo "$listed")); do
    complain "$name is in docs/references.md and nobody cites it"
done

[ $status = 0 ] && echo "${#code[@]} files"
exit $status

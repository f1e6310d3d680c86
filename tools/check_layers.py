#!/usr/bin/env python3
"""Checks who includes whom, and that the compiler and the runtime never link each other.

The table is the one in README.md, "The layers". Exit status 0 when it holds, 1 with one line a breach.
usage: tools/check_layers.py [--self-test]
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STAGES = ["source", "diagnostics", "expression", "parse", "validate", "elaborate", "optimise", "lower"]

# folder -> (project folders it may include, third-party prefixes it may include). The first match holds.
RULES = [
    ("runtime/image", ["runtime/image"], []),
    ("runtime/ports", ["runtime/ports", "runtime/image"], []),
    ("runtime/engine", ["runtime/engine", "runtime/image"], []),
    ("runtime/learn", ["runtime/learn", "runtime/image"], []),
    ("runtime/sense", ["runtime/sense", "runtime/image", "runtime/ports"], []),
    ("runtime/act", ["runtime/act", "runtime/image", "runtime/ports"], []),
    ("runtime/loop", ["runtime/"], []),
    ("runtime/record", ["runtime/"], []),
    ("drivers/camera", ["drivers/camera", "runtime/ports", "runtime/image"], ["opencv2/"]),
    ("drivers/head", ["drivers/head", "runtime/ports", "runtime/image", "runtime/record/recording.h"],
     ["opencv2/", "Eigen/"]),
    ("drivers/servo", ["drivers/servo", "runtime/ports", "runtime/image"], []),
    ("compiler/source", ["compiler/source"], ["fmt/"]),
    ("compiler/diagnostics", ["compiler/diagnostics", "compiler/source"], ["fmt/"]),
    ("compiler/expression", ["compiler/expression", "runtime/image/program.h", "runtime/image/spike_image.h",
                             "runtime/image/philox.h"], ["fmt/"]),
    ("compiler/format", ["compiler/format", "compiler/source"], ["fmt/"]),
    ("compiler/parse", ["compiler/parse", "compiler/source", "compiler/diagnostics", "compiler/expression"],
     ["fmt/", "nlohmann/"]),
    ("compiler/validate", ["compiler/validate", "compiler/parse", "compiler/source", "compiler/diagnostics",
                           "compiler/expression", "runtime/image/spike_image.h", "runtime/image/plasticity.h",
                            "runtime/image/models.h", "runtime/image/philox.h"], ["fmt/"]),
    ("compiler/elaborate", ["compiler/elaborate", "compiler/validate", "compiler/source", "compiler/diagnostics",
                            "compiler/expression", "runtime/image/spike_image.h", "runtime/image/plasticity.h",
                            "runtime/image/models.h", "runtime/image/philox.h"], ["fmt/"]),
    ("compiler/optimise", ["compiler/optimise", "compiler/elaborate", "compiler/source", "compiler/diagnostics",
                           "compiler/validate/circuit.h", "runtime/image/spike_image.h"], ["fmt/"]),
    ("compiler/lower", ["compiler/lower", "compiler/elaborate", "compiler/source", "compiler/diagnostics",
                        "compiler/expression", "compiler/validate/circuit.h", "runtime/image"], ["fmt/"]),
    ("compiler", ["compiler/", "runtime/image"], ["fmt/"]),
    ("tools", ["tools/", "compiler/", "runtime/", "drivers/"],
     ["fmt/", "CLI/", "Eigen/", "nlohmann/", "opencv2/", "benchmark/"]),
    ("tests", ["tools/", "compiler/", "runtime/", "drivers/", "tests/"],
     ["fmt/", "doctest/", "Eigen/", "nlohmann/", "opencv2/", "CLI/"]),
]

PROJECT = ("compiler/", "runtime/", "drivers/", "tools/", "tests/")
# POSIX and compiler headers that the world outside the C++ standard library is reached with.
SYSTEM = {
    "runtime/image": {"fcntl.h", "sys/mman.h", "sys/stat.h", "unistd.h"},
    "runtime/record": {"fcntl.h", "sys/stat.h", "unistd.h"},
    "runtime/loop": {"fcntl.h", "pthread.h", "sched.h", "signal.h", "sys/mman.h", "time.h", "unistd.h"},
    "runtime/engine": {"immintrin.h"},
    "runtime/sense": {"immintrin.h"},
    "drivers/servo": None,  # a driver talks to the operating system
    "drivers/camera": None,
    "tools": None,
    "tests": None,
}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')


def rule_for(path):
    for folder, may, third in RULES:
        if path == folder or path.startswith(folder + "/"):
            return folder, may, third
    return None


def is_standard(header):
    return "." not in header and "/" not in header


def breach(path, line):
    """One sentence when `line` of the file at `path` includes what it may not, else None."""
    found = INCLUDE.match(line)
    if not found:
        return None
    rule = rule_for(path)
    if rule is None:
        return f"{path} is in no known layer"
    folder, may, third = rule
    header = found.group(2)
    if header.startswith(PROJECT):
        if any(header == m or header.startswith(m if m.endswith("/") else m + "/") for m in may):
            return None
        return f'{folder} may not include "{header}"'
    if found.group(1) == '"':
        return f'"{header}" is not relative to the root'
    if is_standard(header) or any(header.startswith(t) for t in third):
        return None
    allowed = SYSTEM.get(folder, set())
    if allowed is None or header in allowed:
        return None
    return f"{folder} may not include <{header}>"


def check_links(cmake_text):
    """The link lines of the layers: neither half may name the other."""
    problems = []
    for call in re.findall(r"tectum_layer\(([^)]*)\)", cmake_text):
        words = call.split()
        links = words[words.index("LINKS") + 1:] if "LINKS" in words else []
        if words[0] == "tectum_compiler" and "tectum_runtime" in links:
            problems.append("CMakeLists.txt: tectum_compiler links tectum_runtime")
        if words[0] == "tectum_runtime" and "tectum_compiler" in links:
            problems.append("CMakeLists.txt: tectum_runtime links tectum_compiler")
        if words[0] in ("tectum_image", "tectum_runtime"):
            extra = [w for w in links if w not in ("tectum_image", "Threads::Threads")]
            problems += [f"CMakeLists.txt: {words[0]} links {w}" for w in extra]
    return problems


def check_tree():
    problems = []
    files = [p for d in ("compiler", "runtime", "drivers", "tools", "tests") for p in (ROOT / d).rglob("*")
             if p.suffix in (".h", ".cpp") and p.is_file()]
    for file in sorted(files):
        path = file.relative_to(ROOT).as_posix()
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
            problem = breach(path, line)
            if problem:
                problems.append(f"{path}:{number}: {problem}")
    problems += check_links((ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))
    return problems, len(files)


def self_test():
    """Each of these must be caught, or the checker checks nothing."""
    cases = [
        ("runtime/engine/x.cpp", '#include <fmt/format.h>', True),
        ("runtime/engine/x.cpp", '#include "compiler/compile.h"', True),
        ("runtime/engine/x.cpp", '#include "runtime/ports/camera.h"', True),
        ("runtime/engine/x.cpp", '#include <vector>', False),
        ("compiler/validate/x.cpp", '#include <nlohmann/json.hpp>', True),
        ("compiler/parse/x.cpp", '#include <nlohmann/json.hpp>', False),
        ("compiler/elaborate/x.cpp", '#include "compiler/parse/json_tree.h"', True),
        ("drivers/servo/x.cpp", '#include "drivers/head/sim_head.h"', True),
        ("drivers/servo/x.cpp", '#include "runtime/engine/spike_engine.h"', True),
        ("runtime/sense/x.cpp", '#include "retina.h"', True),
    ]
    wrong = [c for c in cases if (breach(c[0], c[1]) is not None) != c[2]]
    bad_links = check_links("tectum_layer(tectum_compiler FOLDERS a LINKS tectum_image tectum_runtime)")
    for case in wrong:
        print(f"self-test: {case[0]}: {case[1]} expected {'a breach' if case[2] else 'no breach'}")
    if len(bad_links) != 1:
        print("self-test: a compiler that links the runtime was not caught")
    return 1 if wrong or len(bad_links) != 1 else 0


def main():
    if "--self-test" in sys.argv[1:]:
        return self_test()
    problems, count = check_tree()
    for problem in problems:
        print(problem)
    if problems:
        return 1
    print(f"the layers hold in {count} files")
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Dependencies point one way: base <- {raster, jpeg, mpeg1, geomcodec} <- sim <- {tests, bench}.

Fails on any other #include arrow, on GLM outside raster/ and sim/, and on ISA files that include more than <cstdint>,
<cstddef>, intrinsics, kernel contracts and *_simd.inc, which they include in their anonymous namespace (an inline function shared with an -mavx2 object could replace the plain one).
Usage: check_includes.py SOURCE_DIR
"""
import pathlib
import re
import sys

ALLOWED = {
    "base": {"base"},
    "raster": {"base", "raster"},
    "jpeg": {"base", "jpeg"},
    "mpeg1": {"base", "mpeg1"},
    "geomcodec": {"base", "geomcodec"},
    "sim": {"base", "raster", "jpeg", "mpeg1", "geomcodec", "sim"},
}
ISA_ALLOWED = re.compile(r"<cstdint>|<cstddef>|<\w*intrin\.h>|<arm_neon\.h>|\"base/kernels/\w+_kernels\.h\"|\"base/kernels/\w+_simd\.inc\"")
FORBIDDEN_SYSTEM = {"iostream", "fstream", "sstream", "locale", "filesystem", "regex", "iomanip"}


def includes(path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        match = re.match(r"\s*#\s*include\s*([<\"][^>\"]+[>\"])", line)
        if match:
            yield number, match.group(1)


def problems(root):
    for folder, allowed in ALLOWED.items():
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            where = path.relative_to(root)
            isa_file = re.search(r"_(sse41|avx2|neon)\.cpp$", path.name)
            in_library = "cli" not in where.parts
            for number, name in includes(path):
                target = name[1:-1].split("/")[0]
                if name[0] == '"' and "/" not in name:
                    yield f"{where}:{number}: include {name} without its folder"
                if target in ALLOWED and target not in allowed:
                    yield f"{where}:{number}: {folder}/ must not include {name}"
                if target == "glm" and folder not in ("raster", "sim"):
                    yield f"{where}:{number}: GLM belongs to raster/ and sim/ only"
                if isa_file and not ISA_ALLOWED.fullmatch(name):
                    yield f"{where}:{number}: an ISA file must not include {name}"
                if in_library and name[1:-1] in FORBIDDEN_SYSTEM:
                    yield f"{where}:{number}: libraries do not use <{name[1:-1]}>"
                if in_library and name[1:-1] in ("thread", "mutex", "condition_variable", "future") and folder != "base":
                    yield f"{where}:{number}: threads are made in base/parallel only"


found = list(problems(pathlib.Path(sys.argv[1])))
print("\n".join(found) if found else "every include points the allowed way")
sys.exit(1 if found else 0)

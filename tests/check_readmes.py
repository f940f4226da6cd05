#!/usr/bin/env python3
"""Every path that a README (or NEWS, FORMAT) names exists, and no folder README is longer than 120 lines.

A path is anything in backquotes that ends like a source file or folder of this repository. Usage: check_readmes.py SOURCE_DIR
"""
import pathlib
import re
import sys

FOLDERS = ("base", "raster", "jpeg", "mpeg1", "geomcodec", "sim", "tests", "bench", "docs", "cmake", "tools", ".ci")
NAMED = re.compile(r"`([\w./*{},-]+)`")


def expand(name):
    match = re.search(r"\{([^}]*)\}", name)
    if not match:
        return [name]
    return [e for option in match.group(1).split(",") for e in expand(name[: match.start()] + option + name[match.end():])]


def looks_like_path(name):
    return "/" in name and name.split("/")[0] in FOLDERS or re.search(r"\.(h|cpp|md|py|sh|cmake|json|mjs)$", name)


def exists(root, readme, name):
    return any(any(base.glob(name.rstrip("/"))) for base in (root, readme.parent))


def problems(root):
    readmes = [root / "README.md"] + sorted(p for f in FOLDERS for p in (root / f).rglob("*.md"))
    for folder in ("base", "raster", "jpeg", "mpeg1", "geomcodec", "sim", "tests", "bench"):
        if not (root / folder / "README.md").exists():
            yield f"{folder}/README.md is missing"
    for readme in readmes:
        text = readme.read_text()
        where = readme.relative_to(root)
        if readme.name == "README.md" and readme.parent != root and len(text.splitlines()) > 120:
            yield f"{where}: longer than 120 lines"
        for number, line in enumerate(text.splitlines(), 1):
            for name in NAMED.findall(line):
                if name.startswith(("build/", "out/", "/")):
                    continue
                for one in expand(name):
                    if looks_like_path(one) and not exists(root, readme, one):
                        yield f"{where}:{number}: names {one}, which does not exist"


found = list(problems(pathlib.Path(sys.argv[1]).resolve()))
print("\n".join(found) if found else "every path named exists")
sys.exit(1 if found else 0)

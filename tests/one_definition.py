#!/usr/bin/env python3
"""Two types of one name in one namespace are one type to the linker, which takes the std::vector of either for both: memory is
written over where their sizes differ. Neither a compiler nor the linker says so; this looks at the sources."""

import collections
import pathlib
import re
import sys

COMMENT = re.compile(r"//.*")
OPENS = re.compile(r"\s*(?:inline )?namespace ([\w:]*)\s*\{")
CLOSES = re.compile(r"\}.*namespace")
TYPE = re.compile(r"(?:struct|class|enum class) (?:alignas\(\w+\) )?(\w+)(?: final)?\s*(?::(?!:)[^;]*)?\{")


def types_of(text):
    """(name with its namespaces, line) of each type defined at the left rim, where clang-format puts those of a namespace."""
    spaces = []
    for number, line in enumerate(text.splitlines(), 1):
        code = COMMENT.sub("", line)
        if opened := OPENS.match(code):
            spaces.append(opened.group(1))
        elif CLOSES.match(line) and spaces:
            spaces.pop()
        if (found := TYPE.match(code)) and "" not in spaces:  # "": each source has its own
            yield "::".join([*spaces, found.group(1)]), number


def main(root):
    places = collections.defaultdict(set)
    for folder in ("core", "devices", "projects", "widgets", "app"):
        for path in sorted((root / folder).rglob("*.cpp")) + sorted((root / folder).rglob("*.h")):
            for name, line in types_of(path.read_text(encoding="utf-8")):
                places[name].add(f"{path.relative_to(root)}:{line}")
    if len(places) < 500:
        sys.exit(f"only {len(places)} types found under {root}: this reads the sources no more")
    twice = {name: where for name, where in places.items() if len(where) > 1}
    for name, where in sorted(twice.items()):
        print(f"{name} is defined twice: {', '.join(sorted(where))}")
    sys.exit(1 if twice else 0)


main(pathlib.Path(sys.argv[1]))

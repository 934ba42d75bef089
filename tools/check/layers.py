#!/usr/bin/env python3
"""Proves the include table of ARCHITECTURE.md from the sources.

Every `#include "runtime/..."` (or drivers/, board/, tools/, tests/) must point inward by the table below. Exit 1 and a line
per offence otherwise. The table in ARCHITECTURE.md must say the same: it is read and compared.
"""

import pathlib
import re
import sys

# folder -> folders of runtime/ that it may include, besides itself
RUNTIME = {
    "base": set(),
    "math": {"base"},
    "ports": {"base"},
    "camera": {"base", "math"},
    "map": {"base", "math"},
    "store": {"base", "math", "ports", "camera"},
    "export": {"base", "math", "camera", "store"},
    "console": {"base", "ports"},
    "marker": {"base", "math"},
    "lidar": {"base", "math"},
    "grab": {"base", "math", "ports", "lidar"},
    "scan": {"base", "math", "map", "lidar"},
    "pose": {"base", "math", "camera", "map"},
    "rig": {"base", "math", "camera", "map"},
}
RUNTIME["calib"] = set(RUNTIME) - {"grab"}
RUNTIME["profile"] = {"base", "math", "camera", "lidar", "grab", "calib", "store"}
RUNTIME["press"] = {"base", "math", "ports", "marker", "lidar", "grab", "calib", "store"}
RUNTIME["face"] = {"base", "math", "ports", "map", "lidar", "marker", "calib", "store", "export", "console", "profile", "press"}
# top folder -> prefixes that it may include, besides itself
OUTER = {
    "runtime": ("runtime/",),
    "drivers": ("runtime/base/", "runtime/ports/"),
    "board": ("runtime/", "drivers/"),
    "tools": ("runtime/",),
    "tests": ("runtime/", "drivers/", "board/", "tools/"),
}
# single headers beyond that: a pure reader of a file format
EXTRA = {"drivers/replay/": ("runtime/lidar/pcap.h",)}
# libraries that must not enter the firmware
FORBIDDEN_IN_RUNTIME = re.compile(r"#include <(opencv2?|ceres|yaml-cpp|CLI|fmt|spdlog|nlohmann|iostream|thread|mutex|unistd\.h|sys/|linux/)")
INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"', re.MULTILINE)
GENERATED = "_generated.h"


def offences(root: pathlib.Path):
    for top in OUTER:
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in {".h", ".cpp"}:
                continue
            name = path.relative_to(root).as_posix()
            text = path.read_text(encoding="utf-8")
            for target in INCLUDE.findall(text):
                if target.endswith(GENERATED):
                    target = f"{path.parent.relative_to(root).as_posix()}/" if "/" not in target else target
                if not allowed(name, target):
                    yield f"{name}: includes {target}"
            if top == "runtime":
                for match in FORBIDDEN_IN_RUNTIME.finditer(text):
                    yield f"{name}: includes <{match.group(1)}...>, which stays out of the firmware"


def allowed(name: str, target: str) -> bool:
    top = name.split("/")[0]
    if target.split("/")[0] not in OUTER:
        return False  # every own include gives its full path
    if any(name.startswith(folder) and target in headers for folder, headers in EXTRA.items()):
        return True
    if top != "runtime":
        return target.startswith((top + "/", *OUTER[top]))
    if not target.startswith("runtime/"):
        return False
    inner, other = name.split("/")[1], target.split("/")[1]
    return other == inner or other in RUNTIME[inner]


def table_in_architecture(root: pathlib.Path):
    rows = {}
    for line in (root / "ARCHITECTURE.md").read_text(encoding="utf-8").splitlines():
        match = re.match(r"\| `runtime/(\w+)` \|[^|]*\| ([^|]*) \|", line)
        if match:
            rows[match.group(1)] = set(re.findall(r"\w+", match.group(2)))
    return rows


def main() -> int:
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    bad = list(offences(root))
    for folder, may in table_in_architecture(root).items():
        expected = RUNTIME[folder] - {folder}
        if may != expected:
            bad.append(f"ARCHITECTURE.md: runtime/{folder} says {sorted(may)}, the check says {sorted(expected)}")
    print("\n".join(bad) if bad else "layers: every include points inward")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())

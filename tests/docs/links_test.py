#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Every relative link of every Markdown file leads to a file, and its #anchor to a heading there.

  links_test.py SOURCE_DIR
"""
import pathlib
import sys

sys.dont_write_bytecode = True
from markdown import anchors, documents, links  # noqa: E402


def complaint(root, path, target):
    if target.startswith(("https://", "mailto:")):
        return None
    if target.startswith("http://"):
        return "http:// where https:// would do"
    name, _, anchor = target.partition("#")
    file = (path.parent / name).resolve() if name else path
    if not file.is_relative_to(root):
        return "leads out of the repository"
    if not file.exists():
        return "no such file"
    if anchor and file.suffix == ".md" and anchor not in anchors(file):
        return f"no such heading; there are {', '.join(sorted(anchors(file)))}"
    return None


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    checked, mistakes = 0, []
    for path in documents(root):
        if not path.exists():  # deleted, and not committed yet
            continue
        for link in links(path.resolve()):
            checked += 1
            why = complaint(root, path.resolve(), link.target)
            if why:
                mistakes.append(f"{path.relative_to(root)}:{link.line}: {link.target}: {why}")
    print("\n".join(mistakes + [f"{checked} links, {len(mistakes)} broken"]))
    return 1 if mistakes or checked < 20 else 0


sys.exit(main())

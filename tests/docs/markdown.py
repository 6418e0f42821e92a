# SPDX-License-Identifier: Apache-2.0
"""What the tests of the documentation read of a Markdown file."""
import collections
import pathlib
import re
import subprocess

Block = collections.namedtuple("Block", "heading language text line")
Link = collections.namedtuple("Link", "target line")


def documents(root):
    """Every Markdown file that is kept in the repository, or is about to be."""
    names = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md"],
                           cwd=root, check=True, capture_output=True, text=True).stdout.split()
    return [pathlib.Path(root) / name for name in names]


def fenced_blocks(path):
    """Each with the heading above it."""
    blocks, heading, open_block = [], "", None
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if open_block is not None:
            if line.strip() == "```":
                blocks.append(Block(*open_block[:2], "\n".join(open_block[2]) + "\n", *open_block[3:]))
                open_block = None
            else:
                open_block[2].append(line)
        elif line.lstrip().startswith("```"):
            open_block = [heading, line.strip()[3:], [], number + 1]
        elif line.startswith("#"):
            heading = line.lstrip("#").strip()
    assert open_block is None, f"{path}: a block that begins before line {open_block[3]} has no end"
    return blocks


def prose(path):
    """(line number, text) without fenced blocks and code spans."""
    inside = False
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if line.lstrip().startswith("```"):
            inside = not inside
        elif not inside:
            yield number, re.sub(r"`[^`]*`", lambda code: "`" * len(code.group()), line)


def links(path):
    found = []
    for number, line in prose(path):
        for target in re.findall(r"\]\(([^()\s]+(?:\([^()]*\))?)(?:\s+\"[^\"]*\")?\)", line):
            found.append(Link(target, number))
        found += [Link(target, number) for target in re.findall(r"<img[^>]*\ssrc=\"([^\"]+)\"", line)]
    return found


def anchors(path):
    """As GitHub names headings: lower case, spaces to hyphens, no punctuation; -1, -2, ... for the same again."""
    seen, names, inside = collections.Counter(), set(), False
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.lstrip().startswith("```"):
            inside = not inside
        if inside or not re.match(r"#{1,6} ", line):
            continue
        text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", line.lstrip("#").strip().replace("`", ""))
        name = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
        names.add(name if seen[name] == 0 else f"{name}-{seen[name]}")
        seen[name] += 1
    return names


def commands(text):
    """The simple commands of a shell script, one string each: comments gone, continued lines joined, cut at | && || ;."""
    for line in re.sub(r"\\\n", " ", text).splitlines():
        command, quote = "", ""
        for i, character in enumerate(line):
            if quote:
                quote = "" if character == quote else quote
            elif character in "'\"":
                quote = character
            elif character == "#" and (i == 0 or line[i - 1].isspace()):
                break
            elif character in "|;&()":
                yield command.strip()
                command = ""
                continue
            command += character
        yield command.strip()

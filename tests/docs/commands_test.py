#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Every `overtone ...` and `overtone-mapping-server ...` in the shell blocks of the documentation is a command that there is,
with flags that it has (by its own --help), every `grpcurl` calls a method that the schema has, and every script is there.

  commands_test.py SOURCE_DIR OVERTONE SERVER
"""
import functools
import pathlib
import re
import shlex
import subprocess
import sys

sys.dont_write_bytecode = True
from markdown import commands, documents, fenced_blocks  # noqa: E402

ROOT = pathlib.Path(sys.argv[1]).resolve()
PROGRAMS = {"overtone": sys.argv[2], "overtone-mapping-server": sys.argv[3]}


@functools.lru_cache(maxsize=None)
def usage(program, *subcommands):
    """(its flags, its subcommands), as --help lists them."""
    text = subprocess.run([PROGRAMS[program], *subcommands, "--help"], check=True, capture_output=True, text=True).stdout
    listed = text.partition("\nSubcommands:\n")[2]
    return (frozenset(re.findall(r"(?<![\w-])(--?[a-z][a-z0-9-]*)", text.partition("\nSubcommands:\n")[0])),
            frozenset(re.findall(r"^  ([a-z][a-z0-9-]*)", listed, re.MULTILINE)))


def check_program(program, words):
    path = []
    while words and words[0] in usage(program, *path)[1]:
        path.append(words.pop(0))
    flags, subcommands = usage(program, *path)
    if subcommands and program == "overtone" and not any(word in flags for word in words):
        return f"no subcommand {words[:1]}; there are {sorted(subcommands)}"
    for word in words:
        flag = word.partition("=")[0]
        if flag.startswith("-") and not re.fullmatch(r"-[\d.]+", flag) and flag not in flags:
            return f"{' '.join([program, *path])} has no flag {flag}"
    return None


def check_grpcurl(words):
    schema = "".join(path.read_text() for path in (ROOT / "proto").rglob("*.proto"))
    for service, method in re.findall(r"([\w.]+\.v1\.\w+)/(\w+)", " ".join(words)):
        if f"rpc {method}(" not in schema or f"service {service.rpartition('.')[2]} " not in schema:
            return f"the schema has no {service}/{method}"
    return None


def check(command):
    """Why a simple command cannot work, None where nothing is known against it, and whether it was looked at."""
    text = re.sub(r"\[(--?[^]]*)\]", r"\1", command)  # what may be left out
    try:
        words = shlex.split(text)
    except ValueError as error:
        return (f"{error}: {command}", True) if "overtone" in command else (None, False)
    while words and re.fullmatch(r"[A-Z_]+=.*", words[0]):
        words.pop(0)
    if not words:
        return None, False
    name = words.pop(0)
    if name in PROGRAMS:
        return check_program(name, words), True
    if name == "grpcurl":
        return check_grpcurl(words), True
    if name.endswith((".sh", ".py")) and not name.startswith(("/", "./")):
        return (None if (ROOT / name).exists() else f"there is no {name}"), True
    return None, False


def main():
    looked_at, mistakes = 0, []
    for path in documents(ROOT):
        for block in fenced_blocks(path) if path.exists() else []:
            if block.language not in ("sh", "bash", "shell", "console"):
                continue
            for command in commands(block.text):
                mistake, known = check(command)
                looked_at += known
                if mistake:
                    mistakes.append(f"{path.relative_to(ROOT)}:{block.line}: {mistake}")
    print("\n".join(mistakes + [f"{looked_at} commands, {len(mistakes)} wrong"]))
    return 1 if mistakes or looked_at < 20 else 0


sys.exit(main())

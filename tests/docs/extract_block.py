#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the one code block of a Markdown file that holds a text.

  extract_block.py FILE TEXT OUTPUT
"""
import pathlib
import sys

sys.dont_write_bytecode = True
from markdown import fenced_blocks  # noqa: E402

blocks = [block for block in fenced_blocks(pathlib.Path(sys.argv[1])) if sys.argv[2] in block.text]
if len(blocks) != 1:
    sys.exit(f"{sys.argv[1]} has {len(blocks)} code blocks with {sys.argv[2]!r}")
pathlib.Path(sys.argv[3]).write_text(f'#line {blocks[0].line} "{sys.argv[1]}"\n{blocks[0].text}', encoding="utf-8")

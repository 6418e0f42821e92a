#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Prints docs/api.md, the reference of the wire, from the comments of the schema.

  proto/reference.py > docs/api.md          writes it
  proto/reference.py --check docs/api.md    fails where it is not what would be written
"""
import difflib
import pathlib
import subprocess
import sys
import tempfile

from google.protobuf import descriptor_pb2

FOLDER = pathlib.Path(__file__).resolve().parent
FILES = [
    "mapping_service", "map_admin_service", "submap", "graph", "constraint", "report", "geometry"]
PACKAGE = ".overtone.v1."
INTRODUCTION = """<!-- Written by proto/reference.py from proto/overtone/v1, and compared with it by a test. -->
# The wire

gRPC, package `overtone.v1`: [MappingService](#mappingservice) is what a robot calls, [MapAdminService](#mapadminservice) what an
operator calls. Beside them each server has `grpc.health.v1.Health` (for each service by name) and, unless `reflection: false`,
server reflection; [grpcurl.md](grpcurl.md) asks it real questions. The schema is in [proto/overtone/v1](../proto/overtone/v1);
fields are only ever added to it. Numbers and messages that are left out are 0 and absent, as always in proto3.
"""

Field = descriptor_pb2.FieldDescriptorProto
SCALARS = {
    Field.TYPE_DOUBLE: "double", Field.TYPE_FLOAT: "float", Field.TYPE_INT64: "int64",
    Field.TYPE_UINT64: "uint64", Field.TYPE_INT32: "int32", Field.TYPE_UINT32: "uint32",
    Field.TYPE_SINT32: "sint32", Field.TYPE_SINT64: "sint64", Field.TYPE_BOOL: "bool",
    Field.TYPE_STRING: "string", Field.TYPE_BYTES: "bytes"}


def read_schema():
    with tempfile.NamedTemporaryFile() as out:
        subprocess.run(
            ["protoc", f"-I{FOLDER}", "--include_source_info", f"--descriptor_set_out={out.name}"] +
            [f"overtone/v1/{name}.proto" for name in FILES], check=True, cwd=FOLDER)
        schema = descriptor_pb2.FileDescriptorSet.FromString(out.read())
    by_name = {pathlib.Path(file.name).stem: file for file in schema.file}
    return [by_name[name] for name in FILES]


def escape(text):
    for character in "*_|":
        text = text.replace(character, "\\" + character)
    return text.replace("<", "&lt;").replace(">", "&gt;")


def as_cell(comment):
    return escape(" ".join(line.strip() for line in comment.splitlines() if line.strip()))


def as_paragraphs(comment):
    """Indented lines of a comment are a list."""
    blocks = []
    for line in comment.splitlines():
        indented = line.startswith("   ")
        if line.strip() and (not blocks or blocks[-1][0] != indented):
            blocks.append((indented, []))
        if line.strip():
            blocks[-1][1].append(("- " if indented else "") + escape(line.strip()))
    return "".join("\n".join(lines) + "\n\n" for _, lines in blocks)


class Page:
    def __init__(self, files):
        self.files = files
        self.lines = [INTRODUCTION]
        self.headings = set()

    def heading(self, level, name):
        assert name.lower() not in self.headings, f"two headings {name}: links would be ambiguous"
        self.headings.add(name.lower())
        self.lines.append(f"{'#' * level} {name}\n")

    def text(self):
        for file in self.files:
            self.add_file(file)
        return "\n".join(self.lines)

    def add_file(self, file):
        comments = {}
        for location in file.source_code_info.location:
            comments[tuple(location.path)] = (location.leading_comments + location.trailing_comments, location)
        self.heading(2, file.name)
        top = comments.get((12,))  # the syntax line, below the license
        if top:
            text = "\n".join(line for line in top[0].splitlines() if "SPDX" not in line)
            self.lines.append(as_paragraphs(text))
        comment = lambda *path: comments[path][0] if path in comments else ""
        for i, service in enumerate(file.service):
            self.add_service(service, comment, (6, i))
        for i, message in enumerate(file.message_type):
            self.add_message(message, comment, (4, i))
        for i, enum in enumerate(file.enum_type):
            self.add_enum(enum, comment, (5, i))

    def add_service(self, service, comment, path):
        self.heading(3, service.name)
        self.lines.append(as_paragraphs(comment(*path)))
        for i, method in enumerate(service.method):
            self.heading(4, method.name)
            request = self.type_link(method.input_type, method.client_streaming)
            response = self.type_link(method.output_type, method.server_streaming)
            self.lines.append(f"{request} → {response}\n")
            self.lines.append(as_paragraphs(comment(*path, 2, i)))

    def add_message(self, message, comment, path):
        self.heading(3, message.name)
        self.lines.append(as_paragraphs(comment(*path)))
        if not message.field:
            self.lines.append("No fields.\n")
            return
        self.lines.append("| | field | type | |\n|---|---|---|---|")
        for i, field in enumerate(message.field):
            kind = SCALARS.get(field.type) or self.type_link(field.type_name, False)
            if field.label == Field.LABEL_REPEATED:
                kind = f"repeated {kind}"
            if field.proto3_optional:
                kind = f"optional {kind}"
            elif field.HasField("oneof_index"):
                kind = f"one of: {kind}"
            self.lines.append(f"| {field.number} | `{field.name}` | {kind} | {as_cell(comment(*path, 2, i))} |")
        self.lines.append("")

    def add_enum(self, enum, comment, path):
        self.heading(3, enum.name)
        self.lines.append(as_paragraphs(comment(*path)))
        self.lines.append("| | value | |\n|---|---|---|")
        for i, value in enumerate(enum.value):
            self.lines.append(f"| {value.number} | `{value.name}` | {as_cell(comment(*path, 2, i))} |")
        self.lines.append("")

    def type_link(self, name, stream):
        short = name.removeprefix(PACKAGE)
        link = f"[{short}](#{short.lower()})" if short != name else f"`{name[1:]}`"
        return f"stream of {link}" if stream else link


def main():
    text = Page(read_schema()).text()
    while "\n\n\n" in text:
        text = text.replace("\n\n\n", "\n\n")
    text = text.rstrip("\n") + "\n"
    if sys.argv[1:2] != ["--check"]:
        sys.stdout.write(text)
        return 0
    committed = pathlib.Path(sys.argv[2]).read_text()
    difference = list(difflib.unified_diff(
        committed.splitlines(), text.splitlines(), sys.argv[2], "proto/reference.py", lineterm=""))
    print("\n".join(difference[:60]))
    if difference:
        print(f"write it anew: proto/reference.py > {sys.argv[2]}")
    return 1 if difference else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Runs every command of docs/grpcurl.md as it stands there against a live server, by grpcurl where it is installed, else by
`buf curl`, and looks at the answers. A command without a line in EXPECTED fails.

  grpcurl_test.py SOURCE_DIR SERVER OVERTONE
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE, SERVER, OVERTONE = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3]
sys.dont_write_bytecode = True
sys.path[:0] = [str(SOURCE / "tests/support"), str(SOURCE / "tests/docs")]
from cookbook_world import World, import_example  # noqa: E402
from live_server import live_server  # noqa: E402
from markdown import fenced_blocks  # noqa: E402

BUF = SOURCE / "build/tools/node_modules/.bin/buf"
ANSWER_S = 60
NEEDS_CERTIFICATES = "Questions at 3 a.m."

# By heading, in the order of its commands: regular expressions that the answer must hold.
EXPECTED = {
    "Is it there?": [["overtone.v1.MapAdminService", "overtone.v1.MappingService", "grpc.health.v1.Health"]],
    "Is it healthy?": [['"status": "SERVING"']],
    "Which version is it, and what are its limits?": [[r'"version": "\d+\.\d+\.\d+"', '"maxMessageBytes": "4194304"']],
    "Which configuration is in force?": [[r'\["listen","localhost:0","flag"\]', r'\["quotas.max_calls_per_s","0","file"\]']],
    "Which maps are there, and does the server keep up?": [['"map":"town"', '"keyframes":"82"', '"components":1']],
    "Which robots are connected?": [['"robot":"anna","uploading":true,"watching":true', r'"robot":"bert","uploading":(null|false)']],
    "What did bert get last?": [[r'"bytesSent":"?\d+'], ['"revision": "1"', '"added": 3', '"applied": true']],
    "Who has the largest backlog?": [[r'\A{"robot":"bert","bytesWaiting":2000,']],
    "How far has an upload come?": [['"nextSequence": "1"', '"nextIndex": "41"']],
    "Why is there no loop here?": [["anna/run:20"]],
    "Which closures were demoted?": [[r'"id":"anna/run:2>anna/run:38#0","chiSquare":\d+'],
                                     ['"verdict":"LOOP_CLOSURE_VERDICT_ACCEPTED","count":"10"']],
    "Veto this one": [[r"\{\s*\}"]],
    "What changed, and when?": [['"revision":"1"', '"accepted":\\[".*anna/run']],
    "Watch the revisions": [[r'^"\d+"$']],
    "Undo what was decided since": [['"mapEpoch"']],
    "What is stored, how many bytes, and is all of it whole?": [['"bytesOnDisk": "[1-9]', '"submaps": "2"']],
    "Export a trajectory": [["^# anna/run", r"^10000000\d\d\.0+ "]],
    "Where is anna?": [['"anchored":true', '"inMap":{', '"byOdometry":{']],
}


def prepare_grpcurl(folder):
    """A PATH on which grpcurl is found, or None."""
    if shutil.which("grpcurl"):
        return os.environ["PATH"]
    if not BUF.exists():
        return None
    shutil.copy(SOURCE / "tests/docs/grpcurl.py", folder / "grpcurl")
    return f"{folder}:{os.environ['PATH']}"


def ask(command, folder, path):
    """The answer: what it prints, and the file that it writes. A watch has no end, so it gets one after its first lines."""
    watch = "--unbuffered" in command
    if watch:
        command = "{ " + command.rstrip() + "\n} | head -n 1"
    done = subprocess.run(["bash", *([] if watch else ["-o", "pipefail"]), "-c", command], cwd=folder, capture_output=True, text=True, timeout=ANSWER_S,
                          env={**os.environ, "PATH": path, "BUF": str(BUF)})
    file, written = folder / "anna.tum", ""
    if file.exists():
        written = file.read_text()
        file.unlink()
    return done.returncode, done.stdout + written, done.stderr


def main():
    missing = [tool for tool in ("jq", "protoc", "grpc_python_plugin") if not shutil.which(tool)]
    try:
        import grpc
    except ImportError:
        missing.append("python3-grpcio")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        path = prepare_grpcurl(folder)
        if path is None:
            missing.append("grpcurl or buf (proto/check.sh installs it)")
        if missing:
            print(f"skipped: not installed: {', '.join(missing)}")
            return 77
        subprocess.run([SOURCE / "client/examples/03_python/generate_stubs.sh", folder / "stubs"], check=True)
        import_example(SOURCE, folder / "stubs")
        (folder / "server.yaml").write_text("quotas: {max_calls_per_s: 0}\n")
        with live_server(SERVER, "--config", str(folder / "server.yaml"), "--data-dir", str(folder / "data"),
                         log=folder / "server.log") as address, grpc.insecure_channel(address) as channel:
            world = World(channel)
            world.build()
            world.report("anna", bytes_waiting=1000)
            world.report("bert", bytes_waiting=2000)
            with world.connected("anna"):
                mistakes = check_cookbook(folder, path, address)
        mistakes += check_certificates(folder, path)
    print("\n".join(mistakes + [f"{len(mistakes)} commands answered wrongly"]))
    return 1 if mistakes else 0


def check_certificates(folder, path):
    """The command with certificates, against a server that asks for them."""
    subprocess.run([OVERTONE, "certs", "--out", "certs", "--operator", "olga", "--server-name", "localhost", "--map", "town"],
                   cwd=folder, check=True, stdout=subprocess.DEVNULL)
    (folder / "tls.yaml").write_text(
        "tls: {ca_file: certs/ca.crt, certificate_file: certs/server.crt, key_file: certs/server.key}\n"
        "access_file: certs/access.yaml\n".replace("certs/", f"{folder}/certs/"))
    command = next(block.text for block in fenced_blocks(SOURCE / "docs/grpcurl.md") if block.heading == NEEDS_CERTIFICATES)
    with live_server(SERVER, "--config", str(folder / "tls.yaml"), "--data-dir", ":memory:", log=folder / "tls.log") as address:
        code, answer, errors = ask(command.replace("map.example.org:7077", address), folder, path)
        stranger = ask(f"grpcurl -cacert certs/ca.crt {address} list", folder, path)[0]
    good = code == 0 and stranger != 0 and "overtone.v1.MapAdminService" in answer
    return [] if good else [f"with certificates: exit code {code}, without one {stranger}\n{answer}{errors}"]


def check_cookbook(folder, path, address):
    mistakes, asked = [], 0
    answered = {heading: 0 for heading in EXPECTED}
    for block in fenced_blocks(SOURCE / "docs/grpcurl.md"):
        if block.language != "sh" or block.heading == NEEDS_CERTIFICATES:
            continue
        number = answered.get(block.heading)
        if number is None or number >= len(EXPECTED[block.heading]):
            mistakes.append(f"line {block.line}: what should \"{block.heading}\" answer? Add it to EXPECTED.")
            continue
        answered[block.heading] += 1
        code, answer, errors = ask(block.text.replace("localhost:7077", address), folder, path)
        asked += 1
        wrong = [pattern for pattern in EXPECTED[block.heading][number] if not re.search(pattern, answer, re.MULTILINE)]
        if code != 0 or wrong:
            mistakes.append(f"line {block.line}, \"{block.heading}\": exit code {code}, not in the answer: {wrong}\n{answer}{errors}")
    mistakes += [f"\"{heading}\" is not in docs/grpcurl.md" for heading, count in answered.items() if count == 0]
    print(f"{asked} commands asked")
    return mistakes


sys.exit(main())

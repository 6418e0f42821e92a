# SPDX-License-Identifier: Apache-2.0
"""A mapping server of a test's own, for as long as the test lasts."""
import contextlib
import subprocess


@contextlib.contextmanager
def live_server(program, *arguments, log):
    """Yields host:port. The log goes to the file `log`."""
    with open(log, "w", encoding="utf-8") as errors, subprocess.Popen(
            [program, "--listen", "localhost:0", *arguments], stdout=subprocess.PIPE, stderr=errors, text=True) as server:
        try:
            line = server.stdout.readline()
            prefix = "listening on "
            if not line.startswith(prefix):
                raise RuntimeError(f"the server said {line!r}; see {log}")
            yield line[len(prefix):].strip()
        finally:
            server.terminate()
            server.wait(30)

#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""grpcurl as far as docs/grpcurl.md uses it, by means of `buf curl` (BUF in the environment), where grpcurl is not installed.

  grpcurl [-plaintext] [-cacert F -cert F -key F] [-d JSON] HOST:PORT [list | SERVICE/METHOD]
"""
import os
import sys


def main(arguments):
    scheme, options, words = "https", [], []
    translated = {"-cacert": "--cacert", "-cert": "--cert", "-key": "--key", "-d": "--data"}
    while arguments:
        word = arguments.pop(0)
        if word == "-plaintext":
            scheme = "http"
            options.append("--http2-prior-knowledge")
        elif word in translated:
            options += [translated[word], arguments.pop(0)]
        elif word.startswith("-"):
            sys.exit(f"grpcurl.py does not know {word}")
        else:
            words.append(word)
    address, what = words
    url = f"{scheme}://{address}"
    options += ["--list-services", url] if what == "list" else [f"{url}/{what}"]
    os.execv(os.environ["BUF"], [os.environ["BUF"], "curl", "--protocol", "grpc", *options])


main(sys.argv[1:])

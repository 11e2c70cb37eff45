# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: The Seamwright authors

"""Runs the post-processor on a stored job, without FreeCAD, and prints the NC program, or writes it to a file.

    python3 run_job.py jobs/contour.json [ARGUMENTS [FILE]]

ARGUMENTS replace those of the job.
"""

import json
import sys
from types import SimpleNamespace

import seamwright_post


def command(name, parameters, annotations=None):
    """A command as FreeCAD has it. Versions before 1.1 know no annotations."""
    stored = SimpleNamespace(Name=name, Parameters=parameters)
    if annotations is not None:
        stored.Annotations = annotations
    return stored


def loaded(stored):
    """An object as FreeCAD has it, from one of a stored job."""
    obj = SimpleNamespace(Label=stored["label"])
    if "active" in stored:
        obj.Active = stored["active"]
    if "coolant" in stored:
        obj.CoolantMode = stored["coolant"]
    if "base" in stored:
        obj.Base = loaded(stored["base"])
    if "group" in stored:
        obj.Group = [loaded(member) for member in stored["group"]]
    if "commands" in stored:
        obj.Path = SimpleNamespace(Commands=[command(*each) for each in stored["commands"]])
    return obj


def main(file, arguments=None, output="-"):
    """Writes the program, or says what is wrong."""
    with open(file, encoding="utf-8") as text:
        job = json.load(text)
    if arguments is None:
        arguments = job.get("arguments", "")
    try:
        program = seamwright_post.export([loaded(obj) for obj in job["objects"]], output, arguments)
    except seamwright_post.PostError as error:
        sys.exit(f"{file}: {error}")
    if output == "-":
        sys.stdout.reconfigure(encoding="utf-8", newline="\n")
        sys.stdout.write(program)


if __name__ == "__main__":
    main(*sys.argv[1:])

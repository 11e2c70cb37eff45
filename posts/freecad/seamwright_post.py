# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: The Seamwright authors

"""Post-processor of FreeCAD's CAM workbench for Seamwright.

FreeCAD calls `export` with the objects of a job: fixtures, tool controllers and operations. Each has a `Path` of
commands with a name, such as "G1", and parameters: lengths in mm, angles in degrees, feeds in mm/s (degrees/s). What
this file does not know is an error with the operation and the command, never left out.
"""

import argparse
import math
import re
import shlex

TOOLTIP = "NC programs for Seamwright: spindles, beams (--beam), and heads with rotary axes A B C."
UNITS = "G21"

# Words that each command may have, in the order in which they are written.
WORDS = {
    "G0": "XYZABCF",
    "G1": "XYZABCF",
    "G2": "XYZABCIJKF",
    "G3": "XYZABCIJKF",
    "G4": "P",
    "G73": "XYZRQLF",
    "G81": "XYZRLF",
    "G82": "XYZRPLF",
    "G83": "XYZRQLF",
    "G85": "XYZRLF",
    "G89": "XYZRPLF",
    "M3": "S",
    "M5": "",
    "M6": "T",
}
ALONE = "G17 G18 G19 G21 G40 G80 G90 G94 G98 G99 M0 M1 M7 M8 M9".split()
SYSTEMS = "G54 G55 G56 G57 G58 G59 G59.1 G59.2 G59.3".split()
WORDS.update((name, "") for name in ALONE + SYSTEMS)

LINES = ("G0", "G1")
ARCS = ("G2", "G3")
CYCLES = ("G73", "G81", "G82", "G83", "G85", "G89")
# The two axes of each plane in the order in which G3 turns, and the letters of their centre.
PLANES = {"G17": ("XY", "IJ"), "G18": ("ZX", "KI"), "G19": ("YZ", "JK")}
COOLANT = {"Mist": "M7", "Flood": "M8"}
# Places that are closer together than this are the same one, but for rounding [mm].
SAME_PLACE = 1e-6


class PostError(Exception):
    """What keeps a job from being written: what, where, and what to do."""


class Arguments(argparse.ArgumentParser):
    """Wrong arguments raise an error: argparse alone would end FreeCAD."""

    def error(self, message):
        raise PostError(f"arguments of the post-processor: {message}; known are:\n{self.format_help()}")


def tolerance(text):
    """A tolerance [mm] from an argument."""
    value = float(text)
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"the tolerance must be 0 mm or more, not {text}")
    return value


def origin(text):
    """X Y Z [mm] from an argument."""
    values = [float(value) for value in text.split(",")]
    if len(values) != 3 or not all(map(math.isfinite, values)):
        raise argparse.ArgumentTypeError(f"the origin must be three numbers X,Y,Z in mm, not {text}")
    return values


PARSER = Arguments(prog="seamwright", add_help=False, allow_abbrev=False)
PARSER.add_argument("--no-header", action="store_true", help="no comment at the start")
PARSER.add_argument("--no-comments", action="store_true", help="no comments at all")
PARSER.add_argument("--modal", action="store_true", help="leave out words that are as in the block before")
PARSER.add_argument(
    "--precision",
    type=int,
    default=4,
    choices=range(3, 7),
    help="decimals of lengths and angles (4)",
)
PARSER.add_argument(
    "--tolerance",
    type=tolerance,
    default=0.05,
    help="how far off corners may be rounded, in mm (0.05); 0: exact path",
)
PARSER.add_argument(
    "--origin",
    type=origin,
    metavar="X,Y,Z",
    help="where the origin of the job (G54) is in the coordinates of the machine, in mm",
)
PARSER.add_argument(
    "--beam",
    action="store_true",
    help="the tool is beam 1: S is its power in W, and it is on in feeds between M3 and M5",
)
PARSER.add_argument(
    "--closed-plunge",
    action="store_true",
    help="with --beam: it stays off in feeds along Z that follow a rapid",
)
TOOLTIP_ARGS = PARSER.format_help()


def export(objectslist, filename, argstring):
    """Writes the NC program of the objects to a file ("-": to none), and returns it."""
    try:
        options = PARSER.parse_args(shlex.split(argstring or ""))
    except ValueError as error:
        raise PostError(f"arguments of the post-processor: {error} in {argstring}") from None
    if options.closed_plunge and not options.beam:
        PARSER.error("--closed-plunge is for --beam")
    program = Program(options)
    for obj in objectslist:
        if not hasattr(obj, "Path") and not hasattr(obj, "Group"):
            raise PostError(f"'{obj.Label}' has no path: select operations of a CAM job only")
        program.add(obj)
    text = program.finish()
    if filename != "-":
        with open(filename, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
    return text


def is_active(obj):
    """Whether an operation is to be made. A dressup has the flag of what it dresses."""
    return getattr(undressed(obj, "Active"), "Active", True)


def undressed(obj, name):
    """The object that has the property, below dressups."""
    while not hasattr(obj, name) and hasattr(obj, "Base"):
        obj = obj.Base
    return obj


def canonical(name):
    """"g01" as "G1"."""
    parts = re.fullmatch(r"([GM])0*(\d+(\.\d+)?)", name.strip().upper())
    return parts.group(1) + parts.group(2) if parts else name


def fixed(value, decimals):
    """A number with fixed decimals, never "-0"."""
    if not math.isfinite(value):
        raise PostError(f"{value} is not a number that can be written; make the operation again")
    text = f"{value:.{decimals}f}"
    return text.lstrip("-") if float(text) == 0.0 else text


class Program:
    """An NC program while it is written."""

    def __init__(self, options):
        self.options = options
        self.lines = []
        self.plane = "G17"
        # Where the path is, as far as it is known, and the words that hold.
        self.at = {}
        self.written = {}
        self.has_feed = False
        self.moves = False
        self.turns = False
        # Cycles: whether one holds, and to which level they retract.
        self.in_cycle = False
        self.retract = "G98"
        # Spindle or beam: what the job asks for, and what is written of it.
        self.tool_on = False
        self.was_on = False
        self.power = None
        self.written_power = None
        self.gate_open = False

    def add(self, obj):
        """An object of a job, or all of a group."""
        if not is_active(obj):
            return
        if hasattr(obj, "Group"):
            for member in obj.Group:
                self.add(member)
            return
        # Groups hold other things too, such as the stock.
        if not hasattr(obj, "Path"):
            return
        self.comment(f"operation {obj.Label}")
        coolant = COOLANT.get(getattr(undressed(obj, "CoolantMode"), "CoolantMode", None))
        if coolant:
            self.line(coolant)
        for number, command in enumerate(obj.Path.Commands, 1):
            try:
                self.command(command)
            except PostError as error:
                words = " ".join(f"{letter}{value:g}" for letter, value in command.Parameters.items())
                place = f"{command.Name} {words}".strip()
                raise PostError(f"operation '{obj.Label}', command {number} ({place}): {error}") from None
        self.end_cycle()
        if coolant:
            self.line("M9")

    def command(self, command):
        """One command of a path."""
        if not command.Name:
            return
        if command.Name.startswith("("):
            self.comment(command.Name[1:-1] if command.Name.endswith(")") else command.Name[1:])
            return
        name = canonical(command.Name)
        self.check(name, command.Parameters)
        if name not in CYCLES and name != "G80":
            self.end_cycle()
        if name in LINES + ARCS + CYCLES:
            self.motion(name, command)
            return
        # After anything else the next motion says all of its words.
        self.written.clear()
        if name == "M3":
            self.switch_on(command.Parameters)
        elif name == "M5":
            self.switch_off()
        elif name == "M6":
            self.change_tool(command.Parameters)
        else:
            self.state(name, command.Parameters)

    def check(self, name, parameters):
        """Whether command and words are known."""
        if name == "M4":
            raise PostError("spindles turn one way; set the spindle direction of the tool controller to Forward")
        if name not in WORDS:
            raise PostError("this command is not known here; take it out, or make the operation another way")
        unknown = [letter for letter in parameters if letter not in WORDS[name]]
        if unknown:
            raise PostError(f"{name} takes no word {unknown[0]}; take it out")

    def state(self, name, parameters):
        """A command that sets something, or waits."""
        if name in PLANES:
            self.plane = name
        elif name in SYSTEMS:
            self.at.clear()
        elif name in ("G98", "G99"):
            self.retract = name
        elif name == "G80":
            self.in_cycle = False
        words = self.words(WORDS[name], parameters)
        if name == "G4" and not words:
            raise PostError("the dwell has no time: set it")
        if name in ("G4", "M0", "M1"):
            self.close_gate()
        self.line(" ".join([name] + list(words.values())))

    def motion(self, name, command):
        """A rapid, a feed or a cycle."""
        parameters = dict(command.Parameters)
        feed = parameters.pop("F", None)
        self.turns |= any(letter in parameters for letter in "ABC")
        if name in ARCS:
            name = self.arc(name, parameters)
        words = self.words(WORDS[name], parameters)
        if not words:
            if name != "G0" and feed is not None:
                self.line(self.feed(feed)["F"])
            return
        if name in CYCLES:
            self.begin_cycle(command)
        if name == "G0":
            # The machine closes the gates of its beams in rapids.
            self.gate_open = False
        else:
            words.update(self.feed(feed))
            self.switch_gate(parameters)
        self.block(name, words)
        self.at.update((letter, parameters[letter]) for letter in "XYZABC" if letter in parameters)
        if name in CYCLES:
            # It ends above the hole, at a level that is the reader's to know.
            self.at.pop("Z", None)
        self.moves = True

    def arc(self, name, parameters):
        """Keeps the centre in the plane only. An arc that ends where it begins once it is written would be a full
        circle: it becomes a line."""
        axes, centre = PLANES[self.plane]
        for letter in set("IJK") - set(centre):
            parameters.pop(letter, None)
        if not any(letter in parameters for letter in centre):
            raise PostError(f"the arc has no centre: {centre[0]} and {centre[1]} are missing")
        offset = [parameters.setdefault(letter, 0.0) for letter in centre]
        start = [self.at.get(axis) for axis in axes]
        if None in start:
            return name
        end = [parameters.setdefault(axis, value) for axis, value in zip(axes, start)]
        written = [[fixed(value, self.options.precision) for value in place] for place in (start, end)]
        chord = math.hypot(end[0] - start[0], end[1] - start[1])
        if written[0] != written[1] or chord < SAME_PLACE:
            return name
        middle = [value + to for value, to in zip(start, offset)]
        angles = [math.atan2(place[1] - middle[1], place[0] - middle[0]) for place in (start, end)]
        turn = angles[1] - angles[0] if name == "G3" else angles[0] - angles[1]
        if turn % math.tau > math.pi:
            return name
        for letter in centre:
            del parameters[letter]
        return "G1"

    def feed(self, feed):
        """The word F of a block that feeds."""
        if feed is None and self.has_feed:
            return {}
        per_minute = fixed(60.0 * (feed or 0.0), 3)
        if not float(per_minute) > 0.0:
            raise PostError("there is no feed above 0; set horizontal and vertical feed of the tool controller")
        self.has_feed = True
        return {"F": "F" + per_minute}

    def begin_cycle(self, command):
        """Before a drilling cycle. Newer versions of FreeCAD say with the cycle how it retracts."""
        if self.options.beam:
            raise PostError("a beam does not drill by cycles; take the operation out, or leave out --beam")
        retract = getattr(command, "Annotations", {}).get("RetractMode", self.retract)
        if retract != self.retract:
            self.retract = retract
            self.line(retract)
        self.written.clear()
        self.in_cycle = True

    def end_cycle(self):
        """After the last cycle of a run."""
        if self.in_cycle:
            self.in_cycle = False
            self.line("G80")

    def switch_on(self, parameters):
        """Spindle or beam on. A beam waits for the next feed."""
        speed = parameters.get("S", self.power)
        if speed is None or not speed > 0.0:
            what = "power in W" if self.options.beam else "speed"
            raise PostError(f"S must be above 0; set the spindle speed of the tool controller to the {what}")
        self.tool_on = self.was_on = True
        self.power = speed
        if not self.options.beam:
            self.line("M3 S" + fixed(speed, 1))

    def switch_off(self):
        """Spindle or beam off. A beam goes off with the next motion, or by `close_gate`."""
        self.tool_on = False
        if not self.options.beam:
            self.line("M5")

    def close_gate(self):
        """Closes the gate of a beam that is off where no motion follows."""
        if self.gate_open and not self.tool_on:
            self.gate_open = False
            self.line("M65 P0")

    def switch_gate(self, parameters):
        """Sets the power of the beam, and opens or closes its gate with the feed that follows."""
        if not self.options.beam:
            return
        if not self.tool_on:
            if self.gate_open:
                self.gate_open = False
                self.line("M63 P0")
            return
        if self.options.closed_plunge and not self.gate_open and self.is_along_z(parameters):
            return
        power = fixed(self.power, 1)
        if power != self.written_power:
            self.written_power = power
            self.line(f"M67 E0 Q{power}")
        if not self.gate_open:
            self.gate_open = True
            self.line("M62 P0")

    def is_along_z(self, parameters):
        """Whether nothing but Z changes."""
        said = [letter for letter in "XYABC" if letter in parameters]
        return all(abs(self.at.get(letter, math.inf) - parameters[letter]) < SAME_PLACE for letter in said)

    def change_tool(self, parameters):
        """Another tool, with the one before at rest."""
        if "T" not in parameters:
            raise PostError("T is missing; set the tool number of the tool controller")
        if self.tool_on:
            self.switch_off()
        self.close_gate()
        self.line(f"T{int(parameters['T'])} M6")

    def words(self, letters, parameters):
        """The words of a block, by letter, without F."""
        words = {}
        for letter in letters:
            if letter not in parameters or letter == "F":
                continue
            value = parameters[letter]
            words[letter] = letter + (str(int(value)) if letter == "L" else fixed(value, self.options.precision))
        return words

    def block(self, name, words):
        """A block with a motion. Lines may leave out what holds already."""
        if self.options.modal:
            may = set("F") if name in ARCS else set("XYZABCF") if name in LINES else set()
            said = [word for letter, word in words.items() if letter not in may or self.written.get(letter) != word]
            holds = name in LINES and self.written.get("G") == name
            if name in LINES and not said:
                return
        else:
            said, holds = list(words.values()), False
        self.line(" ".join(said if holds else [name] + said))
        self.written.update(words)
        self.written["G"] = name
        if name in CYCLES:
            self.written.clear()

    def comment(self, text):
        """A comment on a line of its own. Comments cannot be nested, and end with their line."""
        if not self.options.no_comments:
            text = text.replace("(", "[").replace(")", "]")
            self.line("(" + "".join(c if c.isprintable() else " " for c in text) + ")")

    def line(self, text):
        """A line as it is."""
        self.lines.append(text)

    def finish(self):
        """The whole text, with its start and its end."""
        if not self.moves:
            raise PostError("no active operation moves the tool; activate one, and make its path")
        if self.options.beam and not self.was_on:
            raise PostError("the beam is never on: set the spindle speed of the tool controller to its power in W")
        if self.tool_on:
            self.switch_off()
        self.close_gate()
        body, self.lines = self.lines, []
        if not self.options.no_header:
            self.comment("from FreeCAD, for Seamwright")
        value = self.options.tolerance
        control = f"G64 P{fixed(value, 6).rstrip('0')}" if value > 0.0 else "G61"
        self.line(f"G21 G90 G17 G94 {control}")
        if self.options.origin:
            words = self.words("XYZ", dict(zip("XYZ", self.options.origin)))
            self.line("G10 L2 P1 " + " ".join(words.values()))
        if self.turns:
            # X Y Z are the tip, whatever the rotary axes do.
            self.line("G43.4")
        return "\n".join(self.lines + body + ["M2"]) + "\n"

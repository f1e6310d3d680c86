"""Runs `tectum eval` on points of the search, on tuning seeds, and keeps every result in a log so that no point is run twice."""
import hashlib
import json
import os
import pathlib
import re
import subprocess
import tempfile

from objective import find_file, named_measures, read_json
from parameters import suggestion
from trouble import CircuitError, UsageError

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROTOCOLS = ROOT / "circuits" / "protocols"


def run_tectum(tectum, arguments):
    return subprocess.run([str(tectum), *map(str, arguments)], capture_output=True, text=True)


def first_error(text):
    """The diagnostic itself, without the warnings before it."""
    lines = text.strip().splitlines()
    errors = [i for i, line in enumerate(lines) if re.search(r"\berror\b|^tectum", line)]
    return "\n".join(lines[errors[0]:errors[0] + 4]) if errors else "\n".join(lines[-4:])


def circuit_parameters(tectum, circuit):
    """Name -> value as written, whatever the circuit extends or includes."""
    check = run_tectum(tectum, ["check", circuit])
    if check.returncode != 0:
        raise CircuitError(first_error(check.stderr))
    dump = run_tectum(tectum, ["dump", "decl", circuit])
    return dict(re.findall(r"^parameter (\w+) = '(.*)'$", dump.stdout, re.MULTILINE))


def check_bounds(tectum, circuit, parameters):
    """A value that the compiler refuses is better found before the search than in it."""
    for parameter in parameters:
        for position in (0.0, 1.0, 0.381966):  # both ends, and a value that is no round number
            point = f"{parameter.name}={parameter.text(position)}"
            check = run_tectum(tectum, ["check", circuit, "-p", point])
            if check.returncode == 0:
                continue
            message = first_error(check.stderr)
            if "whole number" in message:
                raise UsageError(f"`{parameter.name}` takes certain values only: give it levels, evenly spaced, such as "
                                 f"200..400ms:401\n{message}")
            raise UsageError(f"the circuit does not take {point}:\n{message}")


class Protocol:
    """A protocol with tuning seeds instead of its own, as a file that `tectum eval` reads."""

    def __init__(self, name, change, seeds, duration_s, folder):
        source = find_file(name, PROTOCOLS, "protocol")
        text = read_json(source)
        for key in change:
            if key not in text:
                raise UsageError(f"protocol `{name}` has no `{key}` that could be changed{suggestion(key, text)}")
        text.update(change)
        self.given = name
        self.name = text.get("name", source.stem)
        first = int(text.get("first_seed", 0))
        reported = range(first, first + int(text.get("trials", 1)))
        both = sorted(set(seeds) & set(reported))
        if both:
            raise UsageError(f"protocol `{self.name}` reports on seeds {reported[0]}..{reported[-1]}, and {both[0]} is among the "
                             f"seeds to tune on ({seeds[0]}..{seeds[-1]}): what is tuned on a seed says nothing on it")
        text["first_seed"], text["trials"] = seeds[0], len(seeds)
        if duration_s:
            text["duration"] = f"{duration_s:g} s"
        self.text = json.dumps(text, indent=1)
        self.path = folder / f"tuning_{self.name}.json"

    def write(self):
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self.path.write_text(self.text)


class Evaluations:
    """Measures of points, run now or taken from the log."""

    def __init__(self, tectum, circuit, protocols, log, threads=0):
        self.tectum, self.circuit, self.protocols, self.log, self.threads = tectum, circuit, protocols, log, threads
        self.run_now = self.from_log = 0
        self.circuit_bytes = circuit.read_bytes()
        self.digests = {protocol.name: self.digest(protocol) for protocol in protocols}
        self.known = self.read_log()

    def digest(self, protocol):
        """Of all that a result depends on beside the point. The image stands for what the circuit extends, includes and reads,
        the declarations for expressions that give the same values at the circuit's own parameters only."""
        with tempfile.TemporaryDirectory() as folder:
            image = pathlib.Path(folder) / "circuit.image"
            compiled = run_tectum(self.tectum, ["compile", self.circuit, "-o", image])
            if compiled.returncode != 0:
                raise CircuitError(first_error(compiled.stderr))
            parts = [pathlib.Path(self.tectum).read_bytes(), image.read_bytes()]
        declarations = run_tectum(self.tectum, ["dump", "decl", self.circuit]).stdout
        parts += [declarations.encode(), protocol.text.encode()]
        return hashlib.sha256(b"".join(hashlib.sha256(part).digest() for part in parts)).hexdigest()[:16]

    def read_log(self):
        known = {}
        lines = self.log.read_text().splitlines() if self.log.is_file() else []
        for line in lines:
            try:
                entry = json.loads(line)
                known[entry["digest"], entry["protocol"], self.key(entry["point"])] = entry["measures"]
            except (ValueError, KeyError, TypeError):
                continue  # cut short when its run was killed: it is run again
        return known

    @staticmethod
    def key(point):
        return tuple(sorted(point.items()))

    def is_known(self, point):
        return all((self.digests[p.name], p.name, self.key(point)) in self.known for p in self.protocols)

    def measures(self, point):
        """Measures by protocol as given; None when the compiler refuses the point. `point`: name -> value text."""
        was_known = self.is_known(point)
        found = {protocol.given: self.of_protocol(protocol, point) for protocol in self.protocols}
        self.from_log += was_known
        self.run_now += not was_known
        return found

    def of_protocol(self, protocol, point):
        key = (self.digests[protocol.name], protocol.name, self.key(point))
        if key not in self.known:
            self.known[key] = self.run(protocol, point)
            entry = {"protocol": protocol.name, "digest": key[0], "point": point, "measures": self.known[key]}
            self.append(json.dumps(entry) + "\n")
        return self.known[key]

    def append(self, line):
        """On a line of its own, also where the last one was cut short."""
        with self.log.open("ab+") as log:
            if log.tell() > 0:
                log.seek(-1, os.SEEK_END)
                line = line if log.read(1) == b"\n" else "\n" + line
            log.write(line.encode())

    def run(self, protocol, point):
        if self.circuit.read_bytes() != self.circuit_bytes:
            raise UsageError(f"{self.circuit} was changed while it was being fitted: give the same command again")
        arguments = ["eval", self.circuit, "--protocol", protocol.path, "--format", "json"]
        arguments += ["--threads", self.threads] if self.threads else []
        for name, value in point.items():
            arguments += ["-p", f"{name}={value}"]
        done = run_tectum(self.tectum, arguments)
        if done.returncode == 1:
            return None
        if done.returncode != 0:
            raise UsageError(first_error(done.stderr) or f"tectum eval ended with {done.returncode}")
        return named_measures(json.loads(done.stdout))

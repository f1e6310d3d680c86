"""What is made small: a weighted sum of penalties on the measures of `tectum eval --format json`.

An objective is a file, so that what was optimised can be read: objectives/*.json, keys in objectives/README.md.
"""
import dataclasses
import fnmatch
import json
import pathlib

from parameters import suggestion
from trouble import UsageError

FOLDER = pathlib.Path(__file__).resolve().parent / "objectives"
TERM_KEYS = {"measures", "target", "below", "above", "minimise", "scale", "weight", "missing", "about"}
KEYS = {"tectum_objective", "name", "about", "protocol", "change", "terms"}


@dataclasses.dataclass(frozen=True)
class Term:
    measures: tuple  # patterns of names, as the shell's: "*/circuit/ratio_to_oracle"
    scale: float  # how far off counts as 1
    weight: float
    missing: float  # penalty of a measure that has no value, such as the gain of a saccade that was not made
    target: float = None
    below: float = None
    above: float = None

    def penalty(self, value):
        if value is None:
            return self.missing
        if self.target is not None:
            return ((value - self.target) / self.scale) ** 2
        if self.below is None and self.above is None:
            return value / self.scale
        excess = max(0.0, value - self.below) if self.below is not None else 0.0
        lack = max(0.0, self.above - value) if self.above is not None else 0.0
        return ((excess + lack) / self.scale) ** 2

    def matching(self, measures):
        return [name for name in measures if any(fnmatch.fnmatchcase(name, pattern) for pattern in self.measures)]

    def cost(self, measures):
        names = self.matching(measures)
        return self.weight * sum(self.penalty(measures[name]) for name in names) / len(names)

    def wanted(self):
        if self.target is not None:
            return f"{self.target:g}, {self.scale:g} off counts 1"
        bounds = [f"above {self.above:g}"] if self.above is not None else []
        bounds += [f"below {self.below:g}"] if self.below is not None else []
        return f"{' and '.join(bounds)}, {self.scale:g} beyond counts 1" if bounds else f"small, in units of {self.scale:g}"

    def describe(self):
        weight = "" if self.weight == 1 else f", {self.weight:g} times"
        return f"{', '.join(self.measures)}: {self.wanted()}{weight}"


@dataclasses.dataclass(frozen=True)
class Objective:
    name: str
    protocol: str
    change: dict  # keys of the protocol that are otherwise while tuning, so that an evaluation is short
    terms: tuple

    def cost(self, measures):
        return sum(term.cost(measures) for term in self.terms)

    def check_against(self, measures):
        """Every pattern has to mean something, or part of the objective would be lost in silence."""
        for term in self.terms:
            for pattern in term.measures:
                if not any(fnmatch.fnmatchcase(name, pattern) for name in measures):
                    raise UsageError(f"objective `{self.name}`: nothing is measured that `{pattern}` matches"
                                     f"{suggestion(pattern, measures)} (--measures lists them all)")


def find_file(name, folder, what):
    """A path, or a name out of a folder."""
    if name.endswith(".json") or "/" in name:
        path = pathlib.Path(name)
        if not path.is_file():
            raise UsageError(f"there is no {what} file `{name}`")
        return path
    path = folder / f"{name}.json"
    if not path.is_file():
        names = sorted(file.stem for file in folder.glob("*.json"))
        raise UsageError(f"there is no {what} called `{name}`{suggestion(name, names)} ({', '.join(names)})")
    return path


def read_json(path):
    try:
        return json.loads(pathlib.Path(path).read_text())
    except (OSError, ValueError) as error:
        raise UsageError(f"{path}: {error}") from None


def read_objective(name):
    path = find_file(name, FOLDER, "objective")
    text = read_json(path)
    if not isinstance(text, dict) or text.get("tectum_objective") != 1:
        raise UsageError(f"{path}: an objective begins with \"tectum_objective\": 1")
    refuse_unknown(text, KEYS, path)
    for key in ("name", "protocol", "terms"):
        if not text.get(key):
            raise UsageError(f"{path}: no `{key}`")
    change = text.get("change", {})
    for key in ("first_seed", "trials"):
        if key in change:
            raise UsageError(f"{path}: `{key}` of the protocol is what --seeds says")
    return Objective(text["name"], text["protocol"], change, tuple(read_term(term, path) for term in text["terms"]))


def refuse_unknown(node, keys, place):
    for key in node:
        if key not in keys:
            raise UsageError(f"{place}: unknown key `{key}`{suggestion(key, sorted(keys))}")


def read_term(node, path):
    measures = node.get("measures", [])
    measures = (measures,) if isinstance(measures, str) else tuple(measures)
    place = f"{path}: term of {', '.join(measures) or 'no measures'}"
    refuse_unknown(node, TERM_KEYS, place)
    kinds = [bool(node.get("minimise")), "target" in node, "below" in node or "above" in node]
    if not measures or sum(kinds) != 1:
        raise UsageError(f"{place}: a term has `measures` and one of `target`, `below` and `above`, or `minimise`")
    for key in ("target", "below", "above", "scale", "weight", "missing"):
        if key in node and (isinstance(node[key], bool) or not isinstance(node[key], (int, float))):
            raise UsageError(f"{place}: `{key}` is no number")
    if node.get("scale", 0) <= 0:
        raise UsageError(f"{place}: `scale` says how far off counts as 1, and is above 0")
    return Term(measures, node["scale"], node.get("weight", 1), node.get("missing", 4), node.get("target"), node.get("below"),
                node.get("above"))


def named_measures(evaluation):
    """The numbers of an evaluation by name: `10 deg/gain`, `hold 1 s, 3 frames/circuit/ratio_to_oracle`."""
    found = {}
    tables = evaluation.get("tables", [])
    for table in tables:
        prefix = f"{table['title']}/" if len(tables) > 1 else ""
        columns = [column["name"] for column in table["columns"]]
        for row in table["rows"]:
            found.update({f"{prefix}{row['what']}/{name}": value for name, value in zip(columns, row["values"])})
    for yardstick in evaluation.get("yardsticks", []):
        found[yardstick["what"]] = yardstick["value"]
    for setting in evaluation.get("settings", []):
        collect(setting, setting_name(setting) + "/", found)
    return found


def setting_name(setting):
    hold, frames = setting.get("hold_s", 0), setting.get("camera_latency_frames", 1)
    late = f"{frames} frame" + ("" if frames == 1 else "s")
    return f"hold {hold:g} s, {late}" if hold else late


def collect(node, prefix, found):
    for key, value in node.items():
        if isinstance(value, dict):
            collect(value, f"{prefix}{key}/", found)
        elif value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)):
            found[prefix + key] = value

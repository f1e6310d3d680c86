"""The parameters that are fitted: their names, the circuit's own values, and between which bounds to look.

A value is a number in the unit that the circuit writes it in. The search works on positions from 0 to 1 between the bounds.
"""
import dataclasses
import difflib
import re

from trouble import UsageError

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
UNIT = r"[A-Za-zµ%]+(?:/[A-Za-zµ]+)*"
QUANTITY = re.compile(rf"\s*({NUMBER})\s*({UNIT})?\s*")
AXIS = re.compile(rf"({NUMBER})\s*({UNIT})?\s*(?:\.\.|:)\s*({NUMBER})\s*({UNIT})?\s*(?::\s*(\d+))?")


@dataclasses.dataclass(frozen=True)
class Parameter:
    name: str
    unit: str
    own: float  # as the circuit has it
    own_text: str
    low: float
    high: float
    levels: int = 0  # evenly spaced values, both ends in; 0: any value

    def text(self, position):
        """The value at a position from 0 to 1, as a circuit writes it; a point is known by these texts."""
        if self.levels:
            position = round(position * (self.levels - 1)) / (self.levels - 1)
        value = self.low + position * (self.high - self.low)
        return f"{value:.6g} {self.unit}".rstrip()

    def own_position(self):
        return (self.own - self.low) / (self.high - self.low)

    def describe(self):
        kind = f"{self.levels} levels" if self.levels else "any value"
        return f"{self.name} from {self.own_text}, between {self.low:g} and {self.high:g} {self.unit}".rstrip() + f", {kind}"


def suggestion(word, words):
    near = difflib.get_close_matches(word, words, 1)
    return f"; did you mean `{near[0]}`?" if near else ""


def parse_axis(text, values):
    """`amplitude_gain=1.2..1.9` or `rest_after=200..400ms:401`, of a circuit whose parameters have these value texts."""
    name, equals, rest = text.partition("=")
    name = name.strip()
    if not equals:
        raise UsageError(f"`{text}` has no bounds: write it as {name}=LOW..HIGH, such as amplitude_gain=1.2..1.9")
    if name not in values:
        near = suggestion(name, values) or f"; it has {', '.join(values) or 'none'}"
        raise UsageError(f"the circuit has no parameter `{name}`{near}")
    axis = AXIS.fullmatch(rest.strip())
    if not axis:
        raise UsageError(f"`{rest}` gives no bounds for `{name}`: write LOW..HIGH with the unit, such as 200..400ms, "
                         "and :LEVELS for evenly spaced values only")
    return checked(name, values[name], axis)


def checked(name, own_text, axis):
    own = QUANTITY.fullmatch(own_text)
    if not own:
        raise UsageError(f"`{name}` is an expression in the circuit (`{own_text}`): fit the parameters that it is made of")
    own_value, own_unit = float(own[1]), own[2] or ""
    low, low_unit, high, high_unit, levels = axis.groups()
    low, high = float(low), float(high)
    for unit in {low_unit or high_unit or "", high_unit or low_unit or ""}:
        if unit != own_unit:
            raise UsageError(f"`{name}` is {own_text.strip()} in the circuit, and its bounds are "
                             f"{'in ' + unit if unit else 'plain numbers'}: "
                             f"{'write them in ' + own_unit if own_unit else 'it takes a plain number'}")
    if low >= high:
        raise UsageError(f"the bounds of `{name}` run from {low:g} to {high:g}: the lower comes first")
    if not low <= own_value <= high:
        raise UsageError(f"`{name}` is {own_text.strip()} in the circuit, outside its bounds {low:g}..{high:g}{own_unit}: "
                         "the search starts from the circuit's own values")
    if levels is not None and int(levels) < 2:
        raise UsageError(f"`{name}` needs at least two levels")
    return Parameter(name, own_unit, own_value, f"{own_value:.6g} {own_unit}".rstrip(), low, high, int(levels or 0))


def parse_axes(texts, values):
    """All of `-p`, each of which may list several, separated by commas."""
    parameters = [parse_axis(part, values) for text in texts for part in text.split(",")]
    names = [parameter.name for parameter in parameters]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"`{name}` is given twice")
    if not parameters:
        raise UsageError("nothing to fit: give at least one parameter, such as -p amplitude_gain=1.2..1.9")
    return parameters

"""Why a fit cannot go on, each said in one line."""


class UsageError(Exception):
    """The command is wrong, or something that it needs is missing: exit code 2."""


class CircuitError(Exception):
    """The circuit is wrong, in the compiler's own words: exit code 1."""

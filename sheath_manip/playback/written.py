"""Names and numbers as they are written for people, the same on the page and in figures."""

_METHODS = {
    "sheath": "SHEATH",
    "sheath-own-labels": "SHEATH, own labels",
    "sheath-plain": "SHEATH as in the draft",
    "dagger": "DAgger",
    "dagger-beta": "DAgger with β",
    "hg-dagger": "HG-DAgger",
    "lazy-dagger": "LazyDAgger",
    "thrifty-dagger": "ThriftyDAgger",
    "smile": "SMILe",
    "shiv": "SHIV's queries",
    "cloning": "behaviour cloning",
}
_METRICS = {"iou": "IoU"}


def shown(name: str) -> str:
    """A method's name as its authors write it."""
    return _METHODS.get(name, name.replace("-", " "))


def quantity(metric: str) -> str:
    """A metric as an axis calls it: `distance_tiles` is a distance in tiles."""
    if metric in _METRICS:
        return _METRICS[metric]
    name, _, unit = metric.rpartition("_")
    return f"{name.replace('_', ' ')} ({unit})" if name else unit


def rounded(number: float) -> str:
    """Return a number with no more digits than say something: `0.31`, `1.6`, `130`."""
    return f"{float(f'{number:.2g}'):,g}"


def in_percent(share: float) -> str:
    """Return a share as titles and ticks write it, with no more digits than say something."""
    return f"{rounded(100 * share)} %" if share < 0.995 else f"{100 * share:.0f} %"


def capitalised(words: str) -> str:
    """Return `words` with a capital first letter, and all others as they are."""
    return words[:1].upper() + words[1:]


def counted(count: int, what: str) -> str:
    """`1 episode`, `2 episodes`."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"

"""Numbers of a result as a page shows them: rates, means and differences, each with its interval.

What they are given are parts of a `summary.json`; a number that the summary lacks is an error.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from sheath_manip.experiments.burdens import overall_burdens
from sheath_manip.experiments.claims import UNINFORMED, uninformed
from sheath_manip.experiments.takeovers.table import GATE
from sheath_manip.metrics import endings

Figures = Mapping[str, Any]


def percent(share: float, digits: int = 0) -> str:
    """Return a share as `14 %`; without decimals where they say nothing."""
    return f"{_short(100 * share, digits)} %"


def rate(figures: Figures, name: str = "failure_rate") -> str:
    """Return a rate and its 95 % interval: `10.4 % (7–16)`, `0.5 % (0.1–2.9)`."""
    return with_interval(100 * figures[name], [100 * end for end in figures["ci95"][name]], " %")


def ended(figures: Figures) -> str:
    """Return in how many of its episodes each way to end came, and Wilson's intervals, as cells.

    `79 % (70–86) | 13 % (8–21) | 8 % (4–15)`: succeeded, failed, stuck.
    """
    found = endings(figures).values()
    return " | ".join(
        with_interval(100 * (share or 0.0), [100 * end for end in ci95], " %")
        for share, ci95 in found
    )


def with_interval(value: float, ci95: Sequence[float], unit: str = "") -> str:
    """Return a value with its unit and the ends of its interval, which have fewer decimals."""
    low, high = ci95
    digits = 1 if high < 10 else 0
    return f"{_short(value, 1)}{unit} ({_short(low, digits)}–{_short(high, digits)})"


def mean(figures: Figures, metric: str, digits: int = 2) -> str:
    """Return the mean of a metric and its 95 % interval: `2.79 (2.64–2.94)`."""
    low, high = figures["ci95"][metric]
    return f"{figures['metric'][metric]:.{digits}f} ({low:.{digits}f}–{high:.{digits}f})"


def more(difference: Figures) -> str:
    """Return a difference of two means and its 95 % interval: `+9 (−1 … +20)`."""
    low, high = (_signed(end) for end in difference["ci95"])
    return f"{_signed(difference['mean'])} ({low} … {high})"


def hits(figures: Figures, name: str = "failure_rate") -> int:
    """Return in how many of its episodes a rate was met."""
    return round(figures[name] * figures["episodes"])


def failing_rounds(method: Figures) -> list[int]:
    """Return the rounds of learning in which an episode failed."""
    rounds = [each for each in method["rounds"] if each["round"] > 0]
    return [each["round"] for each in rounds if each["executed"]["failure_rate"]]


def takeovers_a_minute(method: Figures, control_rate_hz: float) -> float:
    """Return how often a minute somebody else took over from the policy, over all rounds."""
    return overall_burdens(method, control_rate_hz)["takeovers_a_minute"] or 0.0


def takeover_s(method: Figures, control_rate_hz: float) -> str:
    """Return how many seconds a takeover took in the mean; a dash where there were none."""
    found = overall_burdens(method, control_rate_hz)
    count, driving_s = found["takeovers_an_episode"], found["driving_s_an_episode"]
    return f"{driving_s / count:.2f}" if count and driving_s is not None else "–"


def burden_cells(method: Figures, control_rate_hz: float) -> str:
    """Return what a method asked of the expert, as cells; a dash for what the result does not say.

    `2.2 | 20 | 0.73 | 0.6 | 1.6 s | 18.4 % | 86 | 8,226`: takeovers an episode and a minute,
    seconds each in the mean and the median, driving an episode, its share, labels an episode and a
    run.
    """
    found, overall = overall_burdens(method, control_rate_hz), method["overall"]
    cells = (
        written(found["takeovers_an_episode"], ".1f"),
        written(found["takeovers_a_minute"], ".1f"),
        takeover_s(method, control_rate_hz),
        written(found["median_takeover_s"], ".2f"),
        written(found["driving_s_an_episode"], ".1f", " s"),
        percent(overall["expert_share"], 1),
        written(found["labels_an_episode"], ",.0f"),
        written(overall["queries"], ",.0f"),
    )
    return " | ".join(cells)


def written(value: float | None, form: str, unit: str = "") -> str:
    """Return a number as `form` says, with its unit; a dash where there is none."""
    return "–" if value is None else f"{value:{form}}{unit}"


def best_uninformed(target: Figures) -> Figures:
    """Return the `name` and the figures (`of`) of what looks at nothing and leaves fewest failing.

    `target` is one burden at which gate and baselines were compared.
    """
    others = {name: of for name, of in target["ways"].items() if name != GATE}
    name = min(others, key=lambda each: others[each]["rate"])
    return {"name": name, "of": others[name]}


def alike(summary: Figures) -> str:
    """Return in what takeovers at random are like SHEATH's: number and length, or share alone."""
    blocks = uninformed(summary) == UNINFORMED[0]
    return "as many and as long" if blocks else "of the same share"


def of_final_variant(summary: Figures) -> str:
    """Return which scenes last policies are judged on, ` of the variant …`; empty if not said."""
    plan = summary["plan"]
    variant = plan.get("comparison", plan).get("final_variant")
    return f" of the variant `{variant}`" if variant else ""


def minutes(seconds: float) -> int:
    """Return a time in whole minutes."""
    return round(seconds / 60)


def auroc(value: float) -> str:
    """Return an area under a ROC curve without its leading zero: `.994`."""
    return f"{value:.3f}".removeprefix("0")


def _short(value: float, digits: int) -> str:
    # Adding 0 makes of -0.0 a 0.0.
    return f"{round(value, digits) + 0:.{digits}f}".removesuffix(".0")


def _signed(value: float) -> str:
    return f"{value:+.0f}".replace("-", "−")

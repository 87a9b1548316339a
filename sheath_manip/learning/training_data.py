"""The episodes that a checkpoint was fitted to and calibrated on, found again in their store."""

from collections.abc import Sequence
from dataclasses import dataclass

from sheath_manip.dataset.compatibility import RecordedSpec, require_compatible
from sheath_manip.dataset.reader import EpisodeReader, EpisodeSummary
from sheath_manip.exceptions import ParameterError
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.support.calibration import LEAST_EPISODES
from sheath_manip.types import Purpose, TaskSpec
from sheath_manip.types.samples import Samples, samples_from


@dataclass(frozen=True, eq=False)
class TrainedOn:
    """States with their images."""

    states: Samples
    calibration: Sequence[Samples]
    """expert episodes that were held out, one each"""


def trained_on(reader: EpisodeReader, checkpoint: Checkpoint, spec: TaskSpec) -> TrainedOn:
    """What `checkpoint` saw of the episodes in `reader`, used on a task of `spec`.

    Of a learning run: its demonstrations and its own rounds, as far as they went. Where no episodes
    were recorded for calibration, the last demonstrations are the held-out ones, as with
    `sheath train`. Raises ParameterError where there are too few, or none of the task, and
    StoreError where one does not fit `spec`.
    """
    summaries = [each for each in reader.infos() if each.info.task == checkpoint.task]
    runs = {each.info.run_seed for each in summaries}
    if checkpoint.run_seed in runs:
        summaries = [s for s in summaries if s.info.run_seed == checkpoint.run_seed]
    by_purpose = {
        purpose: sorted((each for each in summaries if each.info.purpose is purpose), key=_order)
        for purpose in Purpose
    }
    demonstrations, held_out = by_purpose[Purpose.DEMONSTRATION], by_purpose[Purpose.CALIBRATION]
    if not held_out:
        demonstrations, held_out = (
            demonstrations[:-LEAST_EPISODES],
            demonstrations[-LEAST_EPISODES:],
        )
    if not demonstrations or len(held_out) < LEAST_EPISODES:
        raise ParameterError(
            f"{reader.address} has {len(demonstrations)} demonstrations of {checkpoint.task} to "
            f"train on and {len(held_out)} held out; wanted at least 1 and {LEAST_EPISODES}: give "
            "the store that the checkpoint was trained on"
        )
    rounds = [
        each
        for each in by_purpose[Purpose.LEARNING]
        if each.info.method == checkpoint.method
        and each.info.round <= checkpoint.round
        and each.queries
    ]
    wanted = RecordedSpec.of_task(spec)
    for each in (*demonstrations, *held_out, *rounds):
        remedy = "give the store and the variant that the checkpoint was trained on"
        who = f"{each.name} of {reader.address}"
        require_compatible(wanted, each.spec, who, f"the task {spec.name}", remedy)
    names = [each.name for each in (*demonstrations, *rounds)]
    return TrainedOn(
        samples_from(reader.learnable(names)),
        [samples_from(reader.learnable([each.name])) for each in held_out],
    )


def _order(summary: EpisodeSummary) -> tuple[int, int, str]:
    return summary.info.round, summary.info.index, summary.name

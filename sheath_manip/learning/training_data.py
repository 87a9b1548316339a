"""The episodes that a checkpoint was fitted to and calibrated on, found again in their store."""

from collections.abc import Sequence
from dataclasses import dataclass

from sheath_manip.dataset.compatibility import RecordedSpec, require_compatible
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.exceptions import ParameterError
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.types import TaskSpec
from sheath_manip.types.samples import Samples, samples_from


@dataclass(frozen=True, eq=False)
class TrainingData:
    """States with their images."""

    states: Samples
    calibration: Sequence[Samples]
    """expert episodes that were held out, one each"""


def load_training_data(
    reader: EpisodeReader, checkpoint: Checkpoint, spec: TaskSpec
) -> TrainingData:
    """Read what `checkpoint` was fitted to, by the names that it has kept.

    Raises ParameterError where it has kept none, or `reader` lacks one of them, and StoreError
    where one does not fit `spec`, that of the task which it is used on.
    """
    sources = checkpoint.fitted.sources
    if not sources.fitted_to:
        raise ParameterError(
            "the checkpoint does not say which episodes it was fitted to; wanted one that this "
            "version wrote: train again"
        )
    there = {summary.name: summary for summary in reader.infos()}
    wanted = (*sources.fitted_to, *sources.held_out)
    missing = [name for name in wanted if name not in there]
    if missing:
        raise ParameterError(
            f"{reader.address} lacks {len(missing)} of the {len(wanted)} episodes that the "
            f"checkpoint was fitted to, such as {missing[0]}: give the store that it was trained on"
        )
    remedy = "give the store and the variant that the checkpoint was trained on"
    for name in wanted:
        who = f"{name} of {reader.address}"
        recorded, of_task = there[name].spec, RecordedSpec.of_task(spec)
        require_compatible(of_task, recorded, who, f"the task {spec.name}", remedy)
    return TrainingData(
        samples_from(reader.learnable(sources.fitted_to)),
        [samples_from(reader.learnable([name])) for name in sources.held_out],
    )

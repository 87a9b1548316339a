"""One intervention as a short film that a README can show."""

from pathlib import Path

from sheath_manip.experiments.figures.intervention import Intervention
from sheath_manip.playback.frames import frames
from sheath_manip.playback.gif import gif
from sheath_manip.playback.trace import trace_of

SLOWER = 2.0
"""than it was: at 10 Hz an intervention is over before one has looked"""


def film(shown: Intervention, path: Path) -> None:
    """Write an animated GIF of the intervention and its surroundings, at half speed."""
    episode, window = shown.episode, shown.window
    # One more than there are steps where the episode ends in it.
    moments = range(window.start, window.stop + (window.stop == len(episode)))
    images = shown.view.pictures(episode, moments)
    drawn = list(
        frames(
            trace_of(episode),
            episode.outcome,
            lambda moment: images[moment - window.start],
            window,
        )
    )
    frame_ms = 1000 * SLOWER / episode.info.control_rate_hz
    # Together they show all who act in it.
    typical = (0, shown.start - window.start, len(drawn) - 1)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gif(drawn, frame_ms, typical))

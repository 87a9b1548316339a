"""A stretch of a film to hand on: the same frames as a whole one, with time axis and reason."""

from sheath_manip.dataset.naming import episode_name
from sheath_manip.exceptions import ParameterError
from sheath_manip.playback.film import Film
from sheath_manip.playback.frames import Pictures, frames, seen
from sheath_manip.playback.gif import gif
from sheath_manip.playback.video import mp4

KINDS = ("mp4", "gif")
MOST_STEPS = 1200
"""of a clip: a minute at 20 Hz; more is a film, which the page exports whole"""
_MOST_GIF_FRAMES, _MOST_GIF_HZ = 150, 12.5
"""A GIF holds each frame whole, in hundredths of a second."""


def clip(
    film: Film, pictures: Pictures | None, first: int, stop: int, kind: str
) -> tuple[str, bytes]:
    """Return a file of the steps `first` .. `stop` - 1, `mp4` or `gif`: its name and its content.

    Without `pictures` it shows what the cameras saw. Where it reaches the end of the episode, one
    frame more shows how that ended. Raises ParameterError for another kind, for steps that are not
    there, for more than `MOST_STEPS`, and where there was no camera either.
    """
    if kind not in KINDS:
        raise ParameterError(f"a clip of kind {kind!r}; wanted {' or '.join(KINDS)}")
    if not 0 <= first < stop <= len(film):
        raise ParameterError(
            f"a clip of the steps {first + 1} .. {stop}; wanted some of 1 .. {len(film)}, the "
            "first one first"
        )
    if stop - first > MOST_STEPS:
        raise ParameterError(
            f"a clip of {stop - first} steps; wanted at most {MOST_STEPS}: the tab Marks exports "
            "the whole episode"
        )
    rate_hz = film.info.control_rate_hz
    ends = film.outcome is not None and stop == len(film)
    every = 1
    if kind == "gif":
        every = max(-(-(stop - first) // _MOST_GIF_FRAMES), round(rate_hz / _MOST_GIF_HZ), 1)
    moments = list(range(first, stop, every)) + [stop] * ends
    shown = frames(
        film.trace.so_far(),
        film.outcome,
        seen(film) if pictures is None else pictures,
        slice(first, stop),
        moments,
    )
    name = f"{episode_name(film.info)}-steps-{first + 1}-{stop}.{kind}"
    if kind == "mp4":
        return name, mp4(shown, rate_hz)
    drawn = list(shown)
    return name, gif(drawn, 1000 * every / rate_hz, (0, len(drawn) // 2, len(drawn) - 1))

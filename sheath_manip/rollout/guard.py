"""The one place in which what is foreign to the control loop is called."""

from collections.abc import Callable
from typing import TypeVar

from sheath_manip.exceptions import AttemptError, SheathError, UnattendedError
from sheath_manip.rollout.discarding import DiscardedError
from sheath_manip.rollout.watch import HungError, present_watch
from sheath_manip.types import Breakdown

Answer = TypeVar("Answer")

HUNG = "hung"
LATE = "late"
_LONGEST_NAME, _LONGEST_TEXT = 60, 300


class BrokenError(SheathError):
    """A call broke down: all that can go wrong in one is this one error."""

    def __init__(self, who: str, what: str, text: str = "") -> None:
        super().__init__(f"the {who} broke down ({f'{what}: {text}' if text else what})")
        self.breakdown = Breakdown(who, what)
        self._text = text

    def again(self) -> "BrokenError":
        """Return the same once more: an error that is raised at each step grows by each."""
        return BrokenError(self.breakdown.who, self.breakdown.what, self._text)


def ask(who: str, call: Callable[..., Answer], *arguments: object) -> Answer:
    """Return what `call` returns; raises BrokenError, told of `who`, where it does not.

    A person's orders that end an episode are no breakdown, and neither is what ends the program:
    they are raised as they are.
    """
    watch = present_watch()
    try:
        if watch is None:
            return call(*arguments)
        with watch.called():
            return call(*arguments)
    except (BrokenError, DiscardedError, UnattendedError):
        raise
    except Exception as error:
        raise BrokenError(who, *described(error)) from error
    except HungError:
        assert watch is not None
        raise BrokenError(who, HUNG, f"no answer within {watch.hang_s:g} s") from None


def built(what: str, call: Callable[..., Answer], *arguments: object) -> Answer:
    """Return what `call` makes; raises AttemptError where it fails in a way that nobody foresaw."""
    try:
        return call(*arguments)
    except (SheathError, OSError):
        raise
    except Exception as error:
        name, text = described(error)
        raise AttemptError(f"the {what} could not be made ({name}: {text})") from error


def described(error: Exception) -> tuple[str, str]:
    """Return the class of an error and its text, both fit for one line of a terminal."""
    try:
        text = str(error)
    except Exception:
        text = "it does not say why"
    return name_of(error), _printable(text, _LONGEST_TEXT)


def name_of(something: object) -> str:
    """Return the name of its class, which may be any text, fit for one line of a terminal."""
    return _printable(type(something).__name__, _LONGEST_NAME)


def _printable(text: str, longest: int) -> str:
    words = " ".join(text[: 2 * longest].split())
    shown = "".join(letter if letter.isprintable() else "?" for letter in words)
    return shown if len(shown) <= longest else f"{shown[:longest]}…"


class Foreign:
    """One who is asked through the guard.

    Who hung, or could not begin an episode, is not asked again in it: its answers are that error.
    """

    def __init__(self, who: str) -> None:
        self.who = who
        self._out: BrokenError | None = None

    def begin(self, call: Callable[..., object], *arguments: object) -> None:
        """Begin an episode; where that fails, all that is asked in it does."""
        self._out = None
        try:
            ask(self.who, call, *arguments)
        except BrokenError as error:
            self._out = error.again()

    def ask(self, call: Callable[..., Answer], *arguments: object) -> Answer:
        """Return what `call` returns; raises BrokenError."""
        if self._out is not None:
            raise self._out.again()
        try:
            return ask(self.who, call, *arguments)
        except BrokenError as error:
            if error.breakdown.what == HUNG:
                self._out = error.again()
            raise

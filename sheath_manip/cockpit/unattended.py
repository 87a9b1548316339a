"""Ends a run that nobody can let go on, rather than have anybody drive who was not told to."""

from sheath_manip.cockpit.standing import Now
from sheath_manip.exceptions import UnattendedError


def require_attended(now: Now) -> None:
    """Raise UnattendedError where the page is gone: only a person there could end the hold."""
    if not now.closed:
        return
    if now.halted:
        why = "after an emergency stop, and nobody is left to reset it"
    elif now.must_hold:
        why = "after who drove was lost, and nobody is left to take over"
    else:
        why = "while the run waited for a person, for as long as it takes"
    raise UnattendedError(
        f"the page was closed {why}; this simulation cannot hold, so the run ends here. "
        "Wanted a page that stays open until the run goes on"
    )

"""Text of any origin as a terminal may be given it: nothing moves a cursor or sets a title."""


def printable(text: str) -> str:
    """Return `text` with whatever is no character to be seen written out, such as `\\x1b`.

    Line ends stay.
    """
    if text.isprintable():
        return text
    return "".join(
        one if one.isprintable() or one == "\n" else one.encode("unicode_escape").decode()
        for one in text
    )

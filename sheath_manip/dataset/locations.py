"""The places where episodes can be: a directory of this machine, or a URL of an object store."""

from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

from sheath_manip.dataset.store import EpisodeStore

if TYPE_CHECKING:
    from sheath_manip.dataset.remote import RemoteStore


def open_store(address: str, create: bool = False) -> "EpisodeStore | RemoteStore":
    """The store at a directory or URL, begun first where there is none and `create` says so.

    Raises StoreError where there is none, and SetupError where a URL wants a package that is not
    installed.
    """
    if address.startswith("file://"):
        address = unquote(urlsplit(address).path)
    if "://" not in address:
        return EpisodeStore.create(address) if create else EpisodeStore(address)
    # Only now: it wants an optional package.
    from sheath_manip.dataset.remote import RemoteStore

    return RemoteStore.create(address) if create else RemoteStore(address)

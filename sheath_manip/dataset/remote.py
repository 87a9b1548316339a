"""Episodes in an object store, read where they are.

Under the URL each episode is a folder of objects, the very files of its zarr group, and
`manifest/NAME.json` lists them with their sizes and digests. The manifest is written last and
readers look for nothing else, so a push that was cut off shows no episode, and pushing again mends
it.
Credentials, endpoint and region come from the environment (AWS_…, GOOGLE_…, AZURE_…).
"""

import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import timedelta
from pathlib import PurePosixPath
from typing import Any

from sheath_manip.dataset.attributes import GROUP_FILE, MOST_BYTES, parse_header
from sheath_manip.dataset.extras import needs
from sheath_manip.dataset.faults import Fault, FaultError, FaultKind
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.marker import MARKER, MOST_MARKER_BYTES, marker_text, parse_marker
from sheath_manip.dataset.naming import is_episode_name
from sheath_manip.dataset.reader import LARGEST_FILE_BYTES, EpisodeReader, no_such_episode
from sheath_manip.exceptions import StoreError
from sheath_manip.files.bounded_json import parse_json

with needs("remote", "obstore"):
    import obstore
    from obstore.exceptions import BaseError
    from obstore.store import from_url

MANIFESTS = "manifest"
FORMAT, SCHEMA = "sheath-manifest", 1
MOST_MANIFEST_BYTES = 64 << 20
_DIGEST = re.compile(r"[0-9a-f]{64}")


class RemoteStore(EpisodeReader):
    """The episodes under a URL such as `s3://bucket/demos`; `create` also begins a store there.

    Raises StoreError where there is none or it cannot be reached.
    """

    def __init__(self, url: str) -> None:
        self.url = url.rstrip("/")
        self._objects = _opened(self.url)
        # An episode never changes, so its manifest is asked for once.
        self._manifests: dict[str, Mapping[str, Any]] = {}
        with self._reaching(MARKER, missing=f"wanted an episode store at {url}, found no {MARKER}"):
            parse_marker(self.url, self._get(MARKER, MOST_MARKER_BYTES))

    @classmethod
    def create(cls, url: str) -> "RemoteStore":
        """Open the store at `url`, begun first where there is none."""
        objects = _opened(url.rstrip("/"))
        try:
            obstore.head(objects, MARKER)
        except FileNotFoundError:
            try:
                obstore.put(objects, MARKER, marker_text().encode())
            except (BaseError, OSError) as error:
                raise _unreachable(url, error) from error
        except (BaseError, OSError) as error:
            raise _unreachable(url, error) from error
        return cls(url)

    @property
    def address(self) -> str:
        """The URL, as it was given."""
        return self.url

    def names(self) -> list[str]:
        """The names of all episodes with a manifest, sorted."""
        with self._reaching(MANIFESTS):
            found = obstore.list_with_delimiter(self._objects, MANIFESTS)["objects"]
        files = (PurePosixPath(entry["path"]) for entry in found)
        return sorted(f.stem for f in files if f.suffix == ".json" and is_episode_name(f.stem))

    def header(self, name: str) -> Header:
        """Return all of the episode `name` that is no array.

        Raises StoreError where it is damaged.
        """
        self._manifest(name)
        missing = FaultError(name, FaultKind.MISSING, f"its manifest is there, {GROUP_FILE} is not")
        try:
            return parse_header(name, self._get(f"{name}/{GROUP_FILE}", MOST_BYTES))
        except FileNotFoundError as error:
            raise missing from error
        except BaseError as error:
            raise _unreachable(self.url, error) from error

    def files(self, name: str) -> Mapping[str, int]:
        """The size in bytes of each object of the episode, as its manifest tells."""
        return {file: entry["bytes"] for file, entry in self._manifest(name).items()}

    def content(self, name: str, file: str, most_bytes: int = LARGEST_FILE_BYTES) -> bytes:
        """Return what is in one of the `files`.

        Raises StoreError, and FaultError where it is not what was pushed.
        """
        entry, path = self._manifest(name).get(file), f"{name}/{file}"
        if entry is None:
            raise FaultError(name, FaultKind.MISSING, f"its manifest does not list {file}")
        try:
            content = self._get(path, most_bytes)
        except FileNotFoundError as error:
            text = f"its manifest lists {file}, which is not there"
            raise FaultError(name, FaultKind.MISSING, text) from error
        except (BaseError, OSError) as error:
            raise _unreachable(self.url, error) from error
        if hashlib.sha256(content).hexdigest() != entry["sha256"]:
            raise FaultError(
                name, FaultKind.UNREADABLE, f"{file} differs from what was pushed; push it again"
            )
        return content

    def copy_from(self, source: EpisodeReader, name: str) -> None:
        """Put the episode `name` of `source` here, byte for byte, its manifest last."""
        self._manifests.pop(name, None)
        entries = {}
        with self._reaching(name):
            for file in source.files(name):
                content = source.content(name, file)
                obstore.put(self._objects, f"{name}/{file}", content)
                digest = hashlib.sha256(content).hexdigest()
                entries[file] = {"bytes": len(content), "sha256": digest}
            manifest = {"format": FORMAT, "schema": SCHEMA, "files": entries}
            obstore.put(self._objects, _manifest_path(name), json.dumps(manifest).encode())

    def drop(self, name: str) -> None:
        """Delete the episode for good, its manifest first; raises StoreError if there is none."""
        if name not in self.names():
            raise no_such_episode(self.url, name)
        self._manifests.pop(name, None)
        with self._reaching(name):
            obstore.delete(self._objects, _manifest_path(name))
            listed = [entry["path"] for page in obstore.list(self._objects, name) for entry in page]
            if listed:
                obstore.delete(self._objects, listed)

    def entry_faults(self) -> list[Fault]:
        """Objects of episodes without a manifest: a push in progress, or one that was cut off."""
        with self._reaching(""):
            folders = obstore.list_with_delimiter(self._objects)["common_prefixes"]
        committed = {*self.names(), MANIFESTS}
        text = "a push in progress or cut off; push the episode again"
        return [
            Fault(folder, FaultKind.LEFTOVER, text)
            for folder in sorted(PurePosixPath(prefix).name for prefix in folders)
            if folder not in committed
        ]

    def _get(self, path: str, most_bytes: int) -> bytes:
        found = obstore.get(self._objects, path)
        if found.meta["size"] > most_bytes:
            raise StoreError(
                f"{self.url} has {found.meta['size']} bytes as {path}, wanted at most {most_bytes}"
            )
        return bytes(found.bytes())

    def _manifest(self, name: str) -> Mapping[str, Any]:
        if name in self._manifests:
            return self._manifests[name]
        if not is_episode_name(name):
            raise no_such_episode(self.url, name)
        try:
            content = self._get(_manifest_path(name), MOST_MANIFEST_BYTES)
        except FileNotFoundError as error:
            raise no_such_episode(self.url, name) from error
        except (BaseError, OSError) as error:
            raise _unreachable(self.url, error) from error
        try:
            manifest = parse_json(content)
            if (manifest["format"], manifest["schema"]) != (FORMAT, SCHEMA):
                raise ValueError("another format or schema")
            files = manifest["files"]
            if not all(_is_entry(file, entry) for file, entry in files.items()):
                raise ValueError("a file without size and digest, or outside the episode")
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise FaultError(
                name, FaultKind.UNREADABLE, f"its manifest is broken ({error}); push it again"
            ) from error
        self._manifests[name] = files
        return files

    @contextmanager
    def _reaching(self, path: str, missing: str = "") -> Iterator[None]:
        """What the object store raises, as one line."""
        try:
            yield
        except FileNotFoundError as error:
            raise StoreError(missing or f"{self.url} has no {path}") from error
        except (BaseError, OSError) as error:
            raise _unreachable(self.url, error) from error


def _opened(url: str) -> Any:
    try:
        # A server that is not there is told within seconds, not minutes.
        retries: Any = {"max_retries": 3, "retry_timeout": timedelta(seconds=30)}
        return from_url(url, retry_config=retries)
    except (BaseError, ValueError, OSError) as error:
        raise _unreachable(url, error) from error


def _manifest_path(name: str) -> str:
    return f"{MANIFESTS}/{name}.json"


def _is_entry(file: str, entry: Any) -> bool:
    path = PurePosixPath(file)
    return (
        # It becomes a path on this machine when the episode is copied here.
        not (path.is_absolute() or ".." in path.parts or "\\" in file)
        and isinstance(entry["bytes"], int)
        and _DIGEST.fullmatch(entry["sha256"]) is not None
    )


def _unreachable(url: str, error: Exception) -> StoreError:
    # What follows is the whole tree of causes in Rust's notation.
    reason = " ".join(str(error).partition("Debug source")[0].split())
    return StoreError(
        f"cannot reach {url} ({reason:.200}); see its URL, AWS_ENDPOINT_URL, AWS_REGION and the "
        "credentials in the environment"
    )

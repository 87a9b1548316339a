"""Open tables: the house's own members by name, and those that installed packages add.

A package adds a member by an entry point in its own pyproject.toml, whose name is the member's:

    [project.entry-points."sheath.policies"]
    ridge = "my_package.ridge:RidgePolicy"

Members are imported one by one, each when it is first used.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Generic, TypeVar

from sheath_manip.exceptions import RegistrationError, UnknownNameError

T = TypeVar("T")

HOUSE = "sheath-manip"
"""the package named as the owner of the house's own members"""


@dataclass(frozen=True)
class _Member:
    name: str
    target: str
    """as in entry points, `module:attribute`"""
    package: str

    def __str__(self) -> str:
        return f"{self.target} of the package {self.package}"


class Registry(Mapping[str, T], Generic[T]):
    """The members of one kind, by name; a mapping that imports a member when it is asked for."""

    def __init__(
        self, kind: str, group: str, own: Mapping[str, str], *, of: type[T] | None = None
    ) -> None:
        """Store where the members are; nothing is imported.

        Args:
            kind: what a member is called in messages, such as `policy`.
            group: of the entry points of other packages, such as `sheath.policies`.
            own: the house's members, `module:attribute` by name, in the order they are listed in.
            of: the class of all members, where they have one.
        """
        self.kind = kind
        self.group = group
        self.own = own
        self.of = of
        self._loaded: dict[str, T] = {}

    def __getitem__(self, name: str) -> T:
        """Import the member.

        Raises:
            UnknownNameError: there is none of that name; it lists those that there are.
            RegistrationError: two packages gave the name, or what it stands for cannot be imported.
        """
        if name not in self._loaded:
            self._loaded[name] = self._load(name)
        return self._loaded[name]

    def __contains__(self, name: object) -> bool:
        return name in self._members

    def __iter__(self) -> Iterator[str]:
        return iter(self._members)

    def __len__(self) -> int:
        return len(self._members)

    def get(self, name: str, default: Any = None) -> Any:
        """Import the member; `default` where there is none of that name."""
        if name not in self:
            return default
        return self[name]

    @contextmanager
    def including(self, name: str, member: T) -> Iterator[None]:
        """Have one member more in this process for a while, such as in a test or a notebook.

        Raises RegistrationError where the name is taken.
        """
        if name in self:
            raise RegistrationError(f"{self.kind} {name!r} is there already; wanted another name")
        self._members[name] = [_Member(name, f"{member!r}", "this process")]
        self._loaded[name] = member
        try:
            yield
        finally:
            del self._members[name], self._loaded[name]

    @cached_property
    def _members(self) -> dict[str, list[_Member]]:
        members = [_Member(name, target, HOUSE) for name, target in self.own.items()]
        members += sorted(map(_member, entry_points(group=self.group)), key=str)
        by_name: dict[str, list[_Member]] = {}
        for member in members:
            by_name.setdefault(member.name, []).append(member)
        return by_name

    def _load(self, name: str) -> T:
        if name not in self._members:
            raise UnknownNameError(self.kind, name, self)
        member, *others = self._members[name]
        if others:
            listed = " and ".join(map(str, (member, *others)))
            raise RegistrationError(
                f"{self.kind} {name!r} is given more than once, by {listed}; "
                f"rename or uninstall all but one"
            )
        try:
            found = _imported(member.target)
            if self.of is not None and not isinstance(found, self.of):
                raise TypeError(f"wanted a {self.of.__name__}, found {found!r}")
            return found
        except Exception as error:
            if member.package == HOUSE:
                raise
            raise RegistrationError(
                f"{self.kind} {name!r} cannot be imported from {member} "
                f"({type(error).__name__}: {error}); repair or uninstall {member.package}"
            ) from error


def working(table: Mapping[str, T], complain: Callable[[str], None]) -> dict[str, T]:
    """Import all members of `table` but those that cannot be; `complain` is told of each why."""
    found: dict[str, T] = {}
    for name in table:
        try:
            found[name] = table[name]
        except RegistrationError as error:
            complain(str(error))
    return found


def _member(point: EntryPoint) -> _Member:
    package = "unknown" if point.dist is None else point.dist.name
    return _Member(point.name, point.value, package)


def _imported(target: str) -> Any:
    module, _, attribute = target.partition(":")
    found: Any = import_module(module)
    for part in attribute.split("."):
        found = getattr(found, part)
    return found

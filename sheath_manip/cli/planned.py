"""Verbs whose options are settings of a plan: their defaults are those of the task's plan.

So the line is read twice: once for which task and plan it names, and then with that plan's values
as the defaults, which the help then prints.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from json import JSONDecodeError, dumps, loads
from typing import Any, get_origin, get_type_hints

import tyro

from sheath_manip.cli.own_tasks import is_reference, referenced
from sheath_manip.cli.session import LoadCatalog, Verb
from sheath_manip.exceptions import ParameterError, SheathError
from sheath_manip.experiments.study import Study
from sheath_manip.learning.config import LearningPlan
from sheath_manip.policies.config import PolicyConfig

HELP = ("-h", "--help")

registry = tyro.constructors.ConstructorRegistry()
"""how options of the command are read that tyro has no rule for"""


class Planned(Verb, ABC):
    """A verb with settings of a plan among its options."""

    task: str

    @classmethod
    def named(cls, name: str) -> type[Verb]:  # noqa: ARG003
        """Return the verb that a line with this name of a task wants."""
        return cls

    @property
    @abstractmethod
    def size(self) -> str:
        """Name of the task's plan, such as `full`."""

    @classmethod
    @abstractmethod
    def settings(cls, plan: LearningPlan) -> Mapping[str, Any]:
        """Return the values of its options that `plan` gives, by name."""


def verb_for(
    verb: type[Planned], catalog: LoadCatalog, argv: Sequence[str]
) -> tuple[type[Verb], Verb | None]:
    """Return the verb that the line wants, and as what it is before the line is read.

    By the plan of the task that `argv` names. Where it names none, or one that there is not, by
    `LearningPlan`'s own defaults. None where the verb has no settings of a plan.
    """
    read = _read(verb, argv)
    wanted = verb if read is None else verb.named(read.task)
    if not issubclass(wanted, Planned):
        return wanted, None
    plan = None if read is None else _plan(read, catalog)
    settings = wanted.settings(plan or LearningPlan())
    return wanted, wanted(**_required(wanted, lambda _: tyro.MISSING), **settings)


def asked_policy(asked: PolicyConfig, plan: LearningPlan) -> PolicyConfig:
    """`asked`, without the settings that the plan has for another policy."""
    other = asked.name != plan.policy.name
    return PolicyConfig(asked.name) if other and asked.settings == plan.policy.settings else asked


def _read(verb: type[Planned], argv: Sequence[str]) -> Planned | None:
    """`verb` by the line and by anybody's defaults; None where the line is wrong."""
    required = _required(verb, lambda kind: kind())
    if "task" in required:
        required["task"] = tyro.MISSING
    words = [word for word in argv if word not in HELP]
    try:
        # What is wrong with the line is told when it is read again, as the verb that it names.
        read, _ = tyro.cli(
            verb,
            args=words,
            default=verb(**required),
            return_unknown_args=True,
            console_outputs=False,
            registry=registry,
        )
        return read
    except (SystemExit, SheathError):
        return None


def _plan(read: Planned, catalog: LoadCatalog) -> LearningPlan | None:
    if is_reference(read.task):
        found = referenced(read.task)
        return found.plans.get(read.size) if isinstance(found, Study) else None
    studies = catalog().studies
    return studies[read.task].plans.get(read.size) if read.task in studies else None


def _required(verb: type, value: Any) -> dict[str, Any]:
    """A value, from its type, for each option that has no default."""
    hints = get_type_hints(verb)
    return {
        each.name: value(hints[each.name])
        for each in fields(verb)
        if each.default is MISSING and each.default_factory is MISSING
    }


@registry.primitive_rule
def _settings(
    info: tyro.constructors.PrimitiveTypeInfo,
) -> tyro.constructors.PrimitiveConstructorSpec | None:
    """Settings by name are written as JSON."""
    if get_origin(info.type) is not Mapping:
        return None
    return tyro.constructors.PrimitiveConstructorSpec(
        nargs=1,
        metavar="JSON",
        instance_from_str=lambda words: _mapping(words[0]),
        is_instance=lambda value: isinstance(value, Mapping),
        str_from_instance=lambda value: [dumps(dict(value))],
    )


def _mapping(text: str) -> dict[str, Any]:
    try:
        value = loads(text)
    except JSONDecodeError as error:
        raise ParameterError(
            f'{text} is no JSON ({error}); wanted like {{"steps": 100}}'
        ) from error
    if not isinstance(value, dict):
        raise ParameterError(f'{text} has no names; wanted like {{"steps": 100}}')
    return value

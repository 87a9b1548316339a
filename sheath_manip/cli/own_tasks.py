"""Tasks that stand in no table: of a file, `cart.py:CART`, or of a module, `carts.own:CART`."""

from sheath_manip.cli.own_modules import module_at
from sheath_manip.exceptions import RegistrationError, UnknownNameError
from sheath_manip.experiments.study import Study
from sheath_manip.task import Task

WANTED = "wanted file.py:TASK, such as examples/own_task.py:CART"


def is_reference(name: str) -> bool:
    """Whether `name` says where a task is found, where others are names in a table."""
    return ":" in name or name.endswith(".py")


def referenced(reference: str) -> Task | Study:
    """Import and return the task, or the study of one, that `reference` names.

    Raises RegistrationError where the file or the module cannot be imported, or what it names is no
    task, and UnknownNameError where it has nothing of that name.
    """
    place, _, attribute = reference.rpartition(":")
    if not place:
        place, attribute = reference, ""
    module = module_at(place, WANTED)
    offered = [name for name, each in vars(module).items() if isinstance(each, Task | Study)]
    if not offered and not hasattr(module, attribute):
        raise RegistrationError(f"{place} holds no Task; wanted one in it, as CART = Task(…)")
    if not attribute:
        raise RegistrationError(
            f"{reference} does not say which task of the file; wanted {place}:{offered[0]}"
        )
    if not hasattr(module, attribute):
        raise UnknownNameError(f"task of {place}", attribute, offered, WANTED)
    found = getattr(module, attribute)
    if not isinstance(found, Task | Study):
        raise RegistrationError(
            f"{reference} is of type {type(found).__name__}; wanted a Task, or a Study of one"
        )
    return found

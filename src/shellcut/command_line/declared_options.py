"""Arguments of a command that are declared where they are used: type, choices, default, help."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any, TypeVar, get_args

from shellcut.arguments import declared

T = TypeVar("T")


def add_options(parser: argparse.ArgumentParser, owner: Callable[..., Any], **flags: str) -> None:
    """Add arguments of a class, by the names of its parameters."""
    for name, flag in flags.items():
        kind, option, default = declared(owner)[name]
        first = (get_args(kind) or (kind,))[0]
        given: dict[str, Any] = {"dest": f"{owner.__name__}.{name}", "default": None}
        unless = "" if default in (None, False) else f" [{default}]"
        if kind is bool:
            given["action"] = "store_true"
        elif isinstance(first, str):
            given |= {"choices": get_args(kind), "metavar": f"{{{','.join(get_args(kind))}}}"}
        else:
            given |= {"type": first, "metavar": "N"}
        parser.add_argument(flag, help=f"{option.text}{unless}", **given)


def made_of(arguments: argparse.Namespace, owner: Callable[..., T], **more: Any) -> T:
    """Return the class called with the arguments that are given."""
    given = {name.partition("."): value for name, value in vars(arguments).items()}
    return owner(
        **{name: v for (of, _, name), v in given.items() if of == owner.__name__ and v is not None},
        **more,
    )

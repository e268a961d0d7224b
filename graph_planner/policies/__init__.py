"""Policies, one file each, registered by name.

Add one by writing a file in this folder with a class decorated by `@register("name")`; the name is
then known to the command line, the evaluator and the report.
"""

import importlib
import pkgutil

from mjforage.graph_planner.policies.registry import (
    create_policy,
    is_upper_bound,
    policy_names,
    register,
)

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")

__all__ = ["create_policy", "is_upper_bound", "policy_names", "register"]

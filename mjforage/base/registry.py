"""Registries of classes by name: ours, installed ones, and those of a user.

A table knows what is registered by decorator, what an installed package brings by an entry point,
and `package.module:Name`, importable from the present folder too. A worker process, to which only
names travel, finds them again by `import_specs` and `add`. A name of a file is checked
first: other code than what ships or is installed is imported only if the user has named it.
"""

import importlib
import inspect
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cached_property
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from traceback import walk_tb
from types import MappingProxyType
from typing import Any, Generic, NamedTuple, TypeVar, cast

from mjforage.base.errors import UserError
from mjforage.base.extras import how_to_install
from mjforage.base.references import Reference, bind, nearest, parse_reference

T = TypeVar("T", bound=Callable[..., Any])
Made = TypeVar("Made")
M = TypeVar("M", bound=Callable[..., Any])
_TRUSTED: set[str] = set()
"""package.module:Name that the user has named in this process, by hand or in code of theirs."""


def trust(*references: str) -> None:
    """Let files name `package.module:Name` from here on: the user's own word, never a file's.

    Raises `UserError` if one is no such reference.
    """
    for reference in references:
        _parts(reference, reference)
        _TRUSTED.add(reference)


def trusted() -> tuple[str, ...]:
    """References that the user has named so far, for processes that work for this one."""
    return tuple(sorted(_TRUSTED))


_BROUGHT: dict[str, str] = {}  # package from outside -> what it was imported for


class ImportSpec(NamedTuple):
    """Import path for another process: a reference, and the folder to import it from."""

    reference: str  # package.module:Name
    folder: str  # "" for what is installed


class Registry(Generic[T]):
    """Classes or functions of one kind, by name.

    Attributes
    ----------
    kind : kind of the parts, for messages
    group : entry points of installed packages that belong to it
    given : arguments that each is called with before its options
    methods : that each class has; what is imported is checked before it is ever called
    """

    def __init__(
        self, kind: str, group: str, given: int = 0, methods: tuple[str, ...] = ()
    ) -> None:
        self.kind, self.group, self.given, self.methods = kind, group, given, methods
        self._registered: dict[str, T] = {}
        self._lent: ContextVar[Mapping[str, T]] = ContextVar(kind, default=MappingProxyType({}))

    @contextmanager
    def lent(self, classes: Mapping[str, T]) -> Iterator[None]:
        """Make classes of this process known by name, for a while and to this thread alone.

        Other processes get them by value, not by their names. Raises `UserError` if a name is one
        that is registered or installed.
        """
        for name in classes:
            if name in self._registered or name in self._entries:
                raise UserError(f"{self.kind} {name}: is the name of another; give yours another")
        before = self._lent.set({**self._lent.get(), **classes})
        try:
            yield
        finally:
            self._lent.reset(before)

    def lent_of(self, names: Iterable[str]) -> dict[str, T]:
        """Those of some names that `lent` has made known."""
        return {name: self._lent.get()[name] for name in names if name in self._lent.get()}

    def register(self, name: str) -> Callable[[M], M]:
        """Decorator that makes something known under a name.

        Raises `ValueError` if the name is taken.
        """

        def add(made: M) -> M:
            if name in self._registered:
                raise ValueError(f"{self.kind} {name!r} is registered already")
            self._registered[name] = cast(T, made)
            return made

        return add

    @cached_property
    def _entries(self) -> dict[str, EntryPoint]:
        return {entry.name: entry for entry in entry_points(group=self.group)}

    def names(self) -> list[str]:
        """All names that are registered or installed, sorted; `package.module:Name` is none."""
        return sorted(name for name in {*self._registered, *self._entries} if ":" not in name)

    def ours(self) -> list[str]:
        """Names of the shipped parts, sorted."""
        return sorted(name for name, made in self._registered.items() if is_ours(made))

    def has(self, name: str) -> bool:
        """True if a name is registered or installed."""
        return name in self._lent.get() or name in self._registered or name in self._entries

    def find(self, name: str) -> T:
        """Part of a name without options; a registered one comes first.

        The name is the user's own word; one of a file goes through `check_trusted` before. Raises
        `UserError` if there is none of that name (the message offers the nearest), it cannot be
        imported, or is no class with the methods of its kind.
        """
        if name in self._lent.get():
            return self._lent.get()[name]
        if name in self._registered:
            return self._registered[name]
        reference = name
        if ":" not in name:
            if name not in self._entries:
                remedy = f"{nearest(name, self.names())} (a class of yours: package.module:Name)"
                raise UserError(f"{self.kind} {name}: unknown; {remedy}")
            reference = self._entries[name].value
        found = self._class(reference, name)
        _TRUSTED.add(reference)
        return found

    def _class(self, reference: str, name: str) -> T:
        """Import a class and check, before anything calls it, that it has its methods."""
        found: T = _imported(reference, f"{self.kind} {name}")
        for method in self.methods:
            if not callable(getattr(found, method, None)):
                raise UserError(f"{self.kind} {name}: has no method {method}; define it")
        return found

    def check_trusted(self, name: str, where: str, reference: str = "") -> None:
        """Refuse a name in a file if its code is not trusted.

        What ships, what an installed package brings and what the user has named is taken. Raises
        `UserError`, naming the ways by which the user may say so.

        Parameters
        ----------
        name : without options
        where : the file, for the message
        reference : where the file says that it is, if not by its name
        """
        for code in (reference, name):
            if ":" in code and not self.has(name) and code not in _TRUSTED:
                raise UserError(
                    f"{where}: names {self.kind} {code}, code that neither ships nor is installed; "
                    f"if you know it, add --trust {code} (in Python first call "
                    f"mjforage.base.registry.trust({code!r}))"
                )

    def bound(self, text: str) -> tuple[Reference, T, dict[str, Any]]:
        """A reference in canonical form, the named part, and its options as keyword arguments.

        Raises `UserError` as `find`, and for options that it does not take.
        """
        reference = parse_reference(text, self.kind)
        made = self.find(reference.name)
        ours = [name for name, one in self._registered.items() if one is made and is_ours(made)]
        if ours:
            reference = Reference(ours[0], reference.options)
        spelt, values = bind(made, reference, self.kind, self.given)
        return spelt, made, values

    def origin(self, name: str) -> str:
        """Origin of a name: a distribution and its version, a module; "" for ours."""
        entry = self._entries.get(name) if name not in self._registered else None
        if entry is not None and entry.dist is not None:
            return f"{entry.dist.name} {entry.dist.version}"
        made = self.find(name)
        return "" if is_ours(made) else str(made.__module__)

    def import_specs(self, names: Iterable[str]) -> dict[str, ImportSpec]:
        """Import paths, for another process, of those names that are not ours.

        Raises `UserError` if one is of the script itself, which another process cannot import.
        """
        found = {name: self.find(name) for name in names if name not in self._lent.get()}
        return {
            name: self.import_spec(name, made) for name, made in found.items() if not is_ours(made)
        }

    def import_spec(self, name: str, made: T) -> ImportSpec:
        """Import path, for another process, of a named part; raises as `import_specs`."""
        module, path = made.__module__, getattr(made, "__qualname__", "<none>")
        if module == "__main__" or "<" in path:
            raise UserError(
                f"{self.kind} {name}: {path} is defined in the script itself or within a function, "
                "where worker processes cannot import it; move it to the top of a module and give "
                f"MODULE:{path.rpartition('.')[2]}, or compute with one process"
            )
        root = getattr(sys.modules[module.partition(".")[0]], "__file__", None)
        folder = Path(root).resolve().parent if root else None
        if folder is not None and Path(str(root)).name == "__init__.py":
            folder = folder.parent
        return ImportSpec(f"{module}:{path}", str(folder or ""))

    def add(self, name: str, spec: ImportSpec) -> None:
        """Make a name known that another process found, by its import spec.

        Raises `UserError` if it cannot be imported here.
        """
        if name not in self._registered:
            made = self.resolve(spec)
            self._registered.setdefault(name, made)  # its module may have registered it itself

    def resolve(self, spec: ImportSpec) -> T:
        """The class of an import spec; it gets no name here.

        Raises `UserError` if it cannot be imported here.
        """
        _reach(spec.folder)
        return self._class(spec.reference, spec.reference)


def is_ours(made: Any) -> bool:
    """True if a class or function ships with mjforage."""
    return getattr(made, "__module__", "").partition(".")[0] == "mjforage"


def built(what: str, make: Callable[..., Made], *given: Any, **options: Any) -> Made:
    """Call a class or function, and turn a `ValueError` into an error about its options.

    Raises `UserError` of that `ValueError`, after `what`; of whatever else one raises that is not
    ours.
    """
    try:
        return make(*given, **options)
    except ValueError as error:
        raise UserError(f"{what}: {error}") from error
    except (Exception, SystemExit) as error:
        if isinstance(error, UserError) or is_ours(make):
            raise
        raise UserError(f"{what}: cannot be made, it raised {fault(error)}; mend it") from error


def fault(error: BaseException, package: str = "") -> str:
    """Error of a package's code, with its line: "IndexError: ... (file, line 3)"; "" of other code.

    Without a package, of any code but ours and Python's own, and without a line if there is none.
    """
    lines = [
        f"{Path(frame.f_code.co_filename).name}, line {line}"
        for frame, line in walk_tb(error.__traceback__)
        if _is_of(frame.f_globals.get("__name__", ""), package)
    ]
    if package and not lines:
        return ""
    return f"{type(error).__name__}: {error}" + (f" ({lines[-1]})" if lines else "")


def _is_of(module: str, package: str) -> bool:
    top = module.partition(".")[0]
    return top == package if package else top not in ("mjforage", "_sitebuiltins")


def blamed(error: BaseException) -> str:
    """Message about an error in code from outside: the part, the error and its line.

    Empty for an error of other code.
    """
    for package, what in _BROUGHT.items():
        if words := fault(error, package):
            return (
                f"{what}: raised {words}; mend it (the checks of mjforage.testing show the whole "
                "traceback)"
            )
    return ""


def _reach(folder: str) -> None:
    """Let modules of a folder be imported, after all that is installed, which they never hide."""
    if folder and folder not in sys.path and Path(folder).is_dir():
        sys.path.append(folder)


def _imported(reference: str, what: str) -> Any:
    """Import `package.module:Name`.

    Raises `UserError` if there is no such module or class, or the module itself does not import.
    """
    module_name, path = _parts(reference, what)
    _reach(str(Path.cwd()))
    try:
        found: Any = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if not error.name or not f"{module_name}.".startswith(f"{error.name}."):
            remedy = how_to_install(str(error.name))
            raise UserError(f"{what}: module {module_name} needs {error.name}; {remedy}") from error
        raise UserError(
            f"{what}: no module {error.name} is installed or in {Path.cwd()}; go to its folder or "
            "name it in PYTHONPATH"
        ) from error
    except SyntaxError as error:
        raise UserError(f"{what}: {error.filename}, line {error.lineno}: {error.msg}") from error
    except Exception as error:
        raise UserError(
            f"{what}: module {module_name} cannot be imported ({type(error).__name__}: {error}); "
            "mend it"
        ) from error
    except SystemExit as error:
        raise UserError(
            f"{what}: module {module_name} ends the process; let it only define"
        ) from error
    for name in path.split("."):
        if not hasattr(found, name):
            classes = {one: value for one, value in vars(found).items() if isinstance(value, type)}
            package = module_name.partition(".")[0]
            names = [n for n, one in classes.items() if one.__module__.partition(".")[0] == package]
            raise UserError(f"{what}: {module_name} has no {path}; {nearest(name, names)}")
        found = getattr(found, name)
    if not inspect.isclass(found):
        raise UserError(f"{what}: is a {type(found).__name__}; give a class")
    if not is_ours(found):
        _BROUGHT.setdefault(module_name.partition(".")[0], what)
    return found


def _parts(reference: str, what: str) -> tuple[str, str]:
    """Module and path of `package.module:Name`; raises `UserError` if it is none."""
    module, _, path = reference.partition(":")
    if not all(part.isidentifier() for part in (*module.split("."), *path.split("."))):
        raise UserError(f"{what}: expected package.module:Name, letters, digits and underscores")
    return module, path

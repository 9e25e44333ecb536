"""The definitions of the Python module, read from its sources and stubs without importing them."""

import ast
import copy
import inspect
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

_Function = ast.FunctionDef | ast.AsyncFunctionDef
# Aliases of the stubs, by names that a reader knows.
_ALIASES = {
    "_Number": "float",
    "_Numbers": "ArrayLike",
    "_Array": "NDArray[float64]",
    "_Values": "float | NDArray[float64]",
}


def _typed(node: ast.expr | None) -> str:
    if node is None:
        return ""
    text = ast.unparse(node)
    for alias, known in _ALIASES.items():
        text = re.sub(rf"\b{alias}\b", known, text)
    return text


def _decorated(node: _Function | ast.ClassDef, name: str) -> bool:
    return any(re.search(rf"\b{name}\b", ast.unparse(each)) for each in node.decorator_list)


def _docstring(node: _Function | ast.ClassDef | ast.Module) -> str:
    return inspect.cleandoc(ast.get_docstring(node, clean=False) or "")


@dataclass(frozen=True)
class Definition:
    """A class or a function: its name, its nodes (overloads are several) and the module that it stands in."""

    name: str
    nodes: tuple[_Function | ast.ClassDef, ...]
    module: "Module"

    @property
    def is_class(self) -> bool:
        """True for a class."""
        return isinstance(self.nodes[0], ast.ClassDef)

    @property
    def docstring(self) -> str:
        """Docstring of the node that has one."""
        return next((doc for node in self.nodes if (doc := _docstring(node))), "")

    def signature(self, name: str) -> str:
        """Return the signature; overloads are one, whose types are any of theirs."""
        functions = [node for node in self.nodes if not isinstance(node, ast.ClassDef)]
        overloads = [node for node in functions if _decorated(node, "overload")]
        return _signature(_merged(overloads or functions[:1]), name)

    def constructor(self) -> str:
        """Return the signature of the constructor as that of `__new__`; an empty text where a class has none."""
        for node in self._members():
            if isinstance(node, _Function) and node.name in ("__new__", "__init__"):
                documented = any(argument.arg == "core" for argument in node.args.args)
                return "" if documented else _signature(node, "__new__", returns=False)
        return ""

    def _members(self) -> Iterator[ast.stmt]:
        """Yield the members, those of bases within the package too."""
        seen: set[str] = set()
        for owner in self._line():
            names = set()
            for member in owner.nodes[0].body:
                name = getattr(member, "name", None) or ast.unparse(getattr(member, "target", ast.Constant("")))
                if name not in seen:
                    names.add(name)
                    yield member
            seen |= names

    def _line(self) -> Iterator["Definition"]:
        yield self
        node = self.nodes[0]
        for base in node.bases if isinstance(node, ast.ClassDef) else ():
            found = self.module.sources.find(ast.unparse(base), self.module)
            if found is not None and found.is_class:
                yield from found._line()

    def methods(self) -> Iterator["Definition"]:
        """Yield the public methods."""
        found: dict[str, list[_Function]] = {}
        for member in self._members():
            if isinstance(member, _Function) and not member.name.startswith("_") and not _decorated(member, "property"):
                found.setdefault(member.name, []).append(member)
        for name, nodes in found.items():
            if not any(_decorated(node, "deprecated") for node in nodes):
                yield Definition(name, tuple(nodes), self.module)

    def attributes(self) -> Iterator[tuple[str, str, str]]:
        """Yield name, type and meaning of each field and property."""
        for member in self._members():
            if isinstance(member, ast.AnnAssign) and isinstance(member.target, ast.Name):
                if not member.target.id.startswith("_"):
                    yield member.target.id, _typed(member.annotation), self.module.comment(member.lineno)
            elif isinstance(member, ast.FunctionDef) and _decorated(member, "property"):
                told = _docstring(member)
                former = _decorated(member, "deprecated") or told.startswith("Deprecated")
                if not member.name.startswith("_") and not former:
                    yield member.name, _typed(member.returns), told


def _merged(overloads: list[_Function]) -> _Function:
    """Return one function that takes what any of the overloads takes."""
    merged = copy.deepcopy(overloads[0])
    defaults = dict(zip((each.arg for each in merged.args.kwonlyargs), merged.args.kw_defaults, strict=True))
    annotations = {each.arg: each for each in _arguments(merged)}
    for other in overloads[1:]:
        for each in _arguments(other):
            mine = annotations.get(each.arg)
            if mine is not None and each.annotation is not None and mine.annotation is not None:
                mine.annotation = _either(mine.annotation, each.annotation)
        for each, default in zip(other.args.kwonlyargs, other.args.kw_defaults, strict=True):
            # An argument that one of them can do without is optional.
            defaults[each.arg] = defaults.get(each.arg) or default
        if merged.returns is not None and other.returns is not None:
            merged.returns = _either(merged.returns, other.returns)
    merged.args.kw_defaults = [defaults[each.arg] for each in merged.args.kwonlyargs]
    return merged


def _arguments(node: _Function) -> list[ast.arg]:
    return [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]


def _either(one: ast.expr, other: ast.expr) -> ast.expr:
    """Return the type that is either, each alternative once and None last."""
    words = list(dict.fromkeys([*_alternatives(one), *_alternatives(other)]))
    if "None" in words:
        words = [word for word in words if word != "None"] + ["None"]
    return ast.parse(" | ".join(words), mode="eval").body


def _alternatives(node: ast.expr) -> list[str]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitOr):
        return [*_alternatives(node.left), *_alternatives(node.right)]
    return [ast.unparse(node)]


def _signature(node: _Function, name: str, *, returns: bool = True) -> str:
    listed = node.args
    each = [*listed.posonlyargs, *listed.args]
    padded = [*[None] * (len(each) - len(listed.defaults)), *listed.defaults]
    pairs = [pair for pair in zip(each, padded, strict=True) if pair[0].arg not in ("self", "cls")]
    parts = [_argument(*pair) for pair in pairs]
    if listed.vararg:
        parts.append("*" + _argument(listed.vararg, None))
    elif listed.kwonlyargs:
        parts.append("*")
    parts += [_argument(*pair) for pair in zip(listed.kwonlyargs, listed.kw_defaults, strict=True)]
    if listed.kwarg:
        parts.append("**" + _argument(listed.kwarg, None))
    end = f" -> {_typed(node.returns)}" if returns and node.returns is not None else ""
    whole = f"{name}({', '.join(parts)}){end}"
    if len(whole) > 100:
        whole = f"{name}(\n" + "".join(f"    {part},\n" for part in parts) + f"){end}"
    return ("async " if isinstance(node, ast.AsyncFunctionDef) else "") + whole


def _argument(argument: ast.arg, default: ast.expr | None) -> str:
    typed = f": {_typed(argument.annotation)}" if argument.annotation else ""
    if default is None:
        return argument.arg + typed
    equals = " = " if typed else "="
    return f"{argument.arg}{typed}{equals}{ast.unparse(default)}"


@dataclass
class Module:
    """A file of the package: its lines, and what it defines at its top."""

    sources: "Sources"
    tree: ast.Module
    lines: list[str]
    defined: dict[str, Definition] = field(default_factory=dict)

    def comment(self, line: int) -> str:
        """Return the comment `#:` that stands above a line."""
        words: list[str] = []
        for text in reversed(self.lines[: line - 1]):
            if not (stripped := text.strip()).startswith("#:"):
                break
            words.insert(0, stripped.removeprefix("#:").strip())
        return " ".join(words)


class Sources:
    """All modules of the package, stubs in place of what is compiled."""

    def __init__(self, folder: Path) -> None:
        """Read every source and stub below the folder."""
        self.modules: dict[str, Module] = {}
        for file in sorted([*folder.rglob("*.py"), *folder.rglob("*.pyi")]):
            text = file.read_text(encoding="utf-8")
            module = Module(self, ast.parse(text), text.splitlines())
            groups: dict[str, list[_Function | ast.ClassDef]] = {}
            for node in module.tree.body:
                if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
                    groups.setdefault(node.name, []).append(node)
            module.defined = {name: Definition(name, tuple(nodes), module) for name, nodes in groups.items()}
            path = file.relative_to(folder).with_suffix("")
            parts = [part for part in path.parts if part != "__init__"]
            self.modules[".".join(["pumpmodel", *parts])] = module

    def find(self, name: str, near: Module) -> Definition | None:
        """Return what a name means in a module: defined there, or imported from within the package."""
        if name in near.defined:
            return near.defined[name]
        for node in near.tree.body:
            if isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    if (alias.asname or alias.name) == name and (target := self._target(node, near)):
                        return self.find(alias.name, target)
        return None

    def _target(self, node: ast.ImportFrom, near: Module) -> Module | None:
        if not node.level:
            found = self.modules.get(node.module or "")
            # A package that imports a module of its own defines nothing by that.
            return None if found is near else found
        own = next(name for name, module in self.modules.items() if module is near)
        # The stubs are one package, whose parts import one another.
        folder = own if own == "pumpmodel._pumpmodel" else own.rpartition(".")[0]
        return self.modules.get(f"{folder}.{node.module}")

    def public(self, package: str) -> dict[str, Definition]:
        """Return the public names of a package that are classes or functions, in their order."""
        module = self.modules[package]
        listed = next(
            node.value
            for node in module.tree.body
            if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
        )
        names: list[str] = ast.literal_eval(listed)
        return {name: found for name in names if (found := self.find(name, module)) is not None}

    def docstring(self, module: str) -> str:
        """Return the docstring of a module of the package."""
        return _docstring(self.modules[f"pumpmodel.{module}"].tree)

    def choices(self) -> Iterator[tuple[str, str, str]]:
        """Yield name, words and meaning of each type of words."""
        module = self.modules["pumpmodel.choices"]
        for node in module.tree.body:
            if isinstance(node, ast.AnnAssign) and isinstance(node.value, ast.Subscript):
                words = node.value.slice
                listed = words.elts if isinstance(words, ast.Tuple) else [words]
                told = " | ".join(ast.unparse(word) for word in listed)
                yield ast.unparse(node.target), told, module.comment(node.lineno)

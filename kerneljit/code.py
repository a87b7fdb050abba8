"""How kernels that call each other become machine code.

numba makes every function a library of its own: optimised, made machine code, and optimised again
as part of every caller, every caller's caller, and so on. Here a kernel that another one calls is
only typed and written down as LLVM's text (`Callee`). What Python calls (`entries`) gathers that
text of all it needs, each once, and is optimised and made machine code as a whole.
"""

import contextlib
import copy
import functools
import gc
import itertools
from collections.abc import Callable, Iterator
from typing import Any

from numba.core import ir
from numba.core.codegen import CPUCodegen, JITCodeLibrary, ll
from numba.core.compiler import Compiler, CompileResult
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import LoweringPass, register_pass
from numba.core.cpu import CPUContext
from numba.core.datamodel.models import StructModel
from numba.core.environment import Environment
from numba.core.postproc import PostProcessor, VariableLifetime
from numba.core.registry import CPUDispatcher
from numba.core.transforms import canonicalize_cfg
from numba.core.typed_passes import IRLegalization, NativeLowering
from numba.core.types.functions import BaseFunction

from kerneljit.boxing import box_without_python
from kerneljit.records import Lowering

NO_WRAPPERS = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
VIEWS = {
    "getattr", "getitem", "static_getitem", "typed_getitem", "build_tuple", "exhaust_iter", "cast",
    "phi",
}  # fmt: skip
"""Expressions whose arrays are parts of others, and live as long as those do."""


class _NoMachineCode:
    """Where numba would note addresses of machine code: a `Text` has none."""

    def set_env(self, env_name, env):
        pass


class Text(JITCodeLibrary):
    """A function as LLVM's text, for whoever calls it."""

    codegen = _NoMachineCode()

    def _optimize_functions(self, ll_module):
        ll_module.data_layout = self._codegen._data_layout

    def finalize(self):
        self._raise_if_finalized()
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "external":
                function.linkage = "linkonce_odr"  # several callers may bring it along
        self._finalized = True

    def get_pointer_to_function(self, name):
        self._ensure_finalized()
        return 0

    def text(self):
        """Its own function alone."""
        return self._final_module

    def _get_module_for_linking(self):
        """For a library of numba's own kind: with all that it calls."""
        if self._shared_module is None:
            self._ensure_finalized()
            module = self._final_module.clone()
            link(module, callers_first([self])[1:])
            self._shared_module = module
        return self._shared_module


def callers_first(libraries):
    """Libraries and all that they need, each before those that it calls."""
    found: dict = {}

    def visit(library):
        if library not in found:
            for callee in library._linking_libraries if isinstance(library, Text) else ():
                visit(callee)
            found[library] = None

    for library in libraries:
        visit(library)
    return list(reversed(found))


def link(module, libraries):
    """Add the functions of libraries to a module; a caller stands before what it calls."""
    for library in libraries:
        text = library.text() if isinstance(library, Text) else library._get_module_for_linking()
        module.link_in(text, preserve=True)


@contextlib.contextmanager
def written_as_text(codegen) -> Iterator[None]:
    """What numba compiles meanwhile becomes `Text`, its own helpers included."""
    with global_compiler_lock:
        before, codegen._library_class = codegen._library_class, Text
        try:
            yield
        finally:
            codegen._library_class = before


@register_pass(mutates_CFG=False, analysis_only=False)
class Borrow(LoweringPass):
    """Counts no references to arrays in a function that only looks at its caller's.

    Counting made up a third of the text, and of the time of a step. A function may do without
    where it makes no array (nor gets a new one from a call, nor assigns one to another, which may
    take a copy) and returns none: the caller's references outlast the call.
    """

    _name = "borrow"

    def __init__(self):
        LoweringPass.__init__(self)

    def run_pass(self, state):
        models, typemap = state.targetctx.data_model_manager, state.typemap

        def holds_array(name):
            return models[typemap[name]].contains_nrt_meminfo()

        def makes_array(statement):
            if isinstance(statement, ir.SetItem | ir.StaticSetItem):
                return holds_array(statement.value.name)
            if not isinstance(statement, ir.Assign) or not isinstance(statement.value, ir.Expr):
                return False
            return statement.value.op not in VIEWS and holds_array(statement.target.name)

        statements = (s for block in state.func_ir.blocks.values() for s in block.body)
        if not models[state.return_type].contains_nrt_meminfo() and not any(
            makes_array(statement) for statement in statements
        ):
            state.targetctx = state.targetctx.subtarget(enable_nrt=False)
        return False


class _CalleeCompiler(Compiler):
    def define_pipelines(self):
        (steps,) = super().define_pipelines()
        steps._finalized = False
        steps.add_pass_after(Borrow, IRLegalization)
        steps.passes = [
            (Lowering if kind is NativeLowering else kind, text) for kind, text in steps.passes
        ]
        steps.finalize()
        return [steps]


class Callee(CPUDispatcher):
    """A kernel as other kernels call it."""

    def __init__(self, function, options):
        super().__init__(
            function, targetoptions=options | NO_WRAPPERS, pipeline_class=_CalleeCompiler
        )

    def compile(self, sig):
        with written_as_text(self.targetctx.codegen()):
            return super().compile(sig)


@functools.cache
def _parts(kind):
    """How the parts of a value of this kind, which may be variables, are found; or None."""
    if kind is ir.Expr:
        return lambda value: value._kws.values()
    if issubclass(kind, ir.Inst):
        return kind.list_vars
    return {dict: dict.values, list: iter, tuple: iter}.get(kind)


def _list_variables(values, found: list) -> None:
    """Append the variables among values and their parts, in their order."""
    for value in values:
        kind = type(value)
        if kind is ir.Var:
            found.append(value)
        elif (parts := _parts(kind)) is not None:
            _list_variables(parts(value), found)


def _variables(_, value) -> list:
    found: list = []
    _list_variables((value,), found)
    return found


@contextlib.contextmanager
def _without_garbage_collection() -> Iterator[None]:
    """Python looks for no garbage meanwhile; afterwards new objects count as its oldest ones."""
    often = gc.get_threshold()
    gc.set_threshold(0)
    try:
        yield
    finally:
        gc.freeze()
        gc.unfreeze()
        gc.set_threshold(*often)


def _replacements() -> tuple[tuple[Any, str, Callable], ...]:
    """Functions of numba that `quick_typing` replaces: owner, name, and what stands there."""
    resolve, known = BaseFunction.get_call_type, {}

    def get_call_type(self, context, args, kws):
        key = id(self), context, tuple(args), tuple(kws.items())
        if key not in known:
            known[key] = self, resolve(self, context, args, kws)  # it lives on, and so does its id
        return known[key][1]

    return (
        (BaseFunction, "get_call_type", get_call_type),
        (CPUContext, "create_cfunc_wrapper", _do_nothing),
        (StructModel, "as_return", _as_return),
        (StructModel, "from_return", _from_return),
        (ir.Inst, "_rec_list_vars", _variables),
        (PostProcessor, "run", _post_process),
        (CPUCodegen, "_pass_builder", _pass_builder),
    )


@contextlib.contextmanager
def quick_typing() -> Iterator[None]:
    """Shortens numba's part of the work and changes nothing in what the code does.

    What an operator or a NumPy function returns for some types is asked for at each call, and found
    by trying dozens of signatures: here once. The variables of a statement are found without making
    lists of what has none, and Python looks for no garbage.
    A record is returned as it is, not number by number, and NumPy's functions get no wrapper for C.
    """
    with global_compiler_lock, contextlib.ExitStack() as stack:
        stack.enter_context(_without_garbage_collection())
        for owner, name, quick in _replacements():
            stack.callback(setattr, owner, name, getattr(owner, name))
            setattr(owner, name, quick)
        yield


def _post_process(self, emit_dels=False, extend_lifetimes=False, in_full=PostProcessor.run):
    """Without live variables of blocks, which generators alone ask for."""
    function = self.func_ir
    if function.is_generator:
        in_full(self, emit_dels, extend_lifetimes)
        return
    function.blocks = canonicalize_cfg(function.blocks)
    function.variable_lifetime, function.generator_info = VariableLifetime(function.blocks), None
    if emit_dels:
        self._insert_var_dels(extend_lifetimes=extend_lifetimes)


def _pass_builder(self, by_numba=CPUCodegen._pass_builder, **options):
    """Of the level of `entries`, where numba does not say another one."""
    return by_numba(self, **({"opt": getattr(self, "level", 3)} | options))


def _is_data(model) -> bool:
    """Whether a structure is the same in memory and as a value."""
    found = model.__dict__.get("_is_data")
    if found is None:
        found = model._is_data = model.get_data_type() == model.get_value_type()
    return found


def _as_return(self, builder, value, by_parts=StructModel.as_return):
    return value if _is_data(self) else by_parts(self, builder, value)


def _from_return(self, builder, value, by_parts=StructModel.from_return):
    return value if _is_data(self) else by_parts(self, builder, value)


def _do_nothing(*_, **__) -> None:
    pass


@quick_typing()
def entries(kernels: list[tuple[Callee, tuple]], level: int) -> list[CompileResult]:
    """Kernels as Python calls them, with arguments of these types, in one library.

    LLVM optimises it by this level, 1 to 3.
    """
    box_without_python()
    for callee, args in kernels:
        callee.compile(args)
    found = [callee.overloads[args] for callee, args in kernels]
    target = kernels[0][0].targetctx
    codegen = target.codegen()
    codegen.level = level
    library = codegen.create_library(found[0].fndesc.qualname)
    library.enable_object_caching()
    named = []
    for inner in found:
        # An environment of its own: numba finds them by name, and the callee's lacks what the
        # wrapper for Python keeps there.
        name = copy.copy(inner.fndesc)
        name.env_name += "$entry"
        env = Environment.from_fndesc(name)
        context = target.subtarget(enable_nrt=True, error_model=inner.target_context.error_model)
        with context.push_code_library(library):
            context.create_cpython_wrapper(library, name, env, inner.call_helper)
        named.append((context, name, env))
    parts = callers_first([inner.library for inner in found])
    link(library._final_module, parts)
    for part in parts:
        library._reload_init.update(part._reload_init)
    # Nothing else calls them from here on: LLVM drops what they are given and do not use, which is
    # most of the records of arrays.
    for function in library._final_module.functions:
        if not function.is_declaration and function.linkage.name == "linkonce_odr":
            function.linkage = "internal"
    results = [
        inner._replace(
            library=library,
            entry_point=context.get_executable(library, name, env),
            fndesc=name,
            environment=env,
            metadata={},
            reload_init=list(library._reload_init),
        )
        for inner, (context, name, env) in zip(found, named, strict=True)
    ]
    names = [name.llvm_cpython_wrapper_name for _, name, _ in named]
    used_by = (result._find_referenced_environments() for result in results)
    for used in dict.fromkeys(itertools.chain(*used_by)):
        codegen.set_env(used.env_name, used)
        names.append(used.env_name)
    # numba would keep its text on disk for callers, who have their own here; it reads the names.
    library._shared_module = ll.parse_assembly("\n".join(f'@"{n}" = global i8 0' for n in names))
    return results

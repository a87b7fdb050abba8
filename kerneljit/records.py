"""Records between kernels: by their address, and read where they are.

numba passes a record as one argument for each number in it, some hundreds, and copies it whole from
one variable to another. That was most of the text of a kernel. A record never changes, so that an
address in the caller's memory is as good as a copy, for as long as the call lasts.
"""

from numba.core import ir, types
from numba.core.codegen import llvmir as llvm
from numba.core.compiler_machinery import register_pass
from numba.core.datamodel import default_manager
from numba.core.datamodel.models import TupleModel, UniTupleModel
from numba.core.lowering import Lower
from numba.core.typed_passes import NativeLowering

PACKAGES: set[str] = set()
"""Packages, each with a dot behind its name, whose records are passed by address."""

_BY_VALUE = 8
"""Numbers and addresses in a record that is passed by value, at most."""


def _count(kind) -> int:
    """Numbers and addresses in a value."""
    if isinstance(kind, llvm.ArrayType):
        return kind.count * _count(kind.element)
    return sum(map(_count, kind.elements)) if isinstance(kind, llvm.Aggregate) else 1


def _root(pointer):
    while isinstance(pointer, llvm.instructions.GEPInstr):
        pointer = pointer.operands[0]
    return pointer


def _place(builder, value):
    """Address that a record was loaded from, if it is still there; or None."""
    if not isinstance(value, llvm.LoadInstr):
        return None
    pointer = value.operands[0]
    root = _root(pointer)
    if isinstance(root, llvm.Argument):
        return pointer
    if isinstance(root, llvm.AllocaInstr):
        for later in reversed(builder.block.instructions):
            if later is value:
                return pointer
            if isinstance(later, llvm.StoreInstr) and _root(later.operands[1]) is root:
                return None
    return None


def _room(builder, kind):
    with builder.goto_entry_block():
        return builder.alloca(kind)


def _record(model):
    """A model of named tuples that passes large ones of `PACKAGES` by their address."""

    class Record(model):
        def __init__(self, manager, kind):
            super().__init__(manager, kind)
            self.is_large = (
                kind.instance_class.__module__.startswith(tuple(PACKAGES))
                and _count(self.get_value_type()) > _BY_VALUE
            )

        def get_argument_type(self):
            if self.is_large:
                return llvm.PointerType(self.get_value_type())
            return super().get_argument_type()

        def as_argument(self, builder, value):
            if not self.is_large:
                return super().as_argument(builder, value)
            place = _place(builder, value)
            if place is None:
                place = _room(builder, value.type)
                builder.store(value, place)
            return place

        def from_argument(self, builder, value):
            return builder.load(value) if self.is_large else super().from_argument(builder, value)

    return Record


default_manager.register(types.NamedTuple, _record(TupleModel))
default_manager.register(types.NamedUniTuple, _record(UniTupleModel))


class _Lower(Lower):
    """Reads a record where it lies, and clears no variable that holds no array."""

    def extract_function_arguments(self):
        values = super().extract_function_arguments()
        for argument in self.function.args[2:]:
            kind = argument.type
            if isinstance(kind, llvm.PointerType) and isinstance(kind.pointee, llvm.Aggregate):
                argument.add_attribute("noalias")
                argument.attributes.dereferenceable = self.context.get_abi_sizeof(kind.pointee)
        self._borrowed = set()
        self._borrow(values)
        return values

    def _borrow(self, values) -> None:
        """Let variables that are an argument, or a part of one, be the caller's memory."""
        statements = [
            statement
            for _, block in sorted(self.blocks.items())
            for statement in block.find_insts(ir.Assign)
        ]
        times: dict = {}
        for statement in statements:
            times[statement.target.name] = times.get(statement.target.name, 0) + 1
        for statement in statements:
            name = statement.target.name
            place = self._borrowed_place(statement.value, values) if times[name] == 1 else None
            if place is not None and place.type.pointee == self.context.get_value_type(
                self.typeof(name)
            ):
                self.varmap[name] = place
                self._singly_assigned_vars.discard(name)
                self._borrowed.add(name)

    def _borrowed_place(self, value, values):
        if isinstance(value, ir.Arg):
            kind = self.typeof("arg." + value.name)
            if isinstance(kind, types.BaseTuple):
                return _place(self.builder, values[value.index])
        elif isinstance(value, ir.Var):
            return self.varmap[value.name] if value.name in self._borrowed else None
        elif isinstance(value, ir.Expr) and value.op in ("getattr", "static_getitem"):
            index = self._field(value)
            if index is not None and value.value.name in self._borrowed:
                if isinstance(self.typeof(value.value.name)[index], types.BaseTuple):
                    return self._part(self.varmap[value.value.name], index)
        return None

    def _field(self, expr):
        """Number of the field of a record that an expression reads, or None."""
        kind = self.typeof(expr.value.name)
        if expr.op == "getattr" and isinstance(kind, types.BaseNamedTuple):
            return kind.fields.index(expr.attr) if expr.attr in kind.fields else None
        if expr.op == "static_getitem" and isinstance(kind, types.BaseTuple):
            return expr.index % len(kind) if isinstance(expr.index, int) else None
        return None

    def _part(self, place, index):
        zero, number = (llvm.Constant(llvm.IntType(32), i) for i in (0, index))
        return self.builder.gep(place, [zero, number], inbounds=True)

    def lower_expr(self, resty, expr):
        index = self._field(expr) if expr.op in ("getattr", "static_getitem") else None
        if index is not None:
            name = expr.value.name
            if name in self._blk_local_varmap:
                place = _place(self.builder, self._blk_local_varmap[name])
            else:
                place = self.getvar(name)
            if place is not None:
                kind = self.typeof(name)[index]
                value = self.builder.load(self._part(place, index))
                self.incref(kind, value)
                return self.context.cast(self.builder, value, kind, resty)
        return super().lower_expr(resty, expr)

    def lower_inst(self, inst):
        if not isinstance(inst, ir.Assign) or inst.target.name not in self._borrowed:
            super().lower_inst(inst)

    def _is_counted(self, name) -> bool:
        if name in self._borrowed or not self.context.enable_nrt:
            return False
        return self.context.data_model_manager[self.typeof(name)].contains_nrt_meminfo()

    def alloca(self, name, type):
        if self._is_counted(name):
            return super().alloca(name, type)
        return _room(self.builder, self.context.get_value_type(type))

    def storevar(self, value, name, argidx=None):
        self._alloca_var(name, self.typeof(name))
        if name in self._singly_assigned_vars or self._is_counted(name):
            super().storevar(value, name, argidx)
        else:
            self.builder.store(value, self.varmap[name])

    def delvar(self, name):
        if self._is_counted(name):
            super().delvar(name)
        elif name not in self._blk_local_varmap:
            self._singly_assigned_vars.discard(name)


@register_pass(mutates_CFG=True, analysis_only=False)
class Lowering(NativeLowering):
    _name = "lowering"

    @property
    def lowering_class(self):
        return _Lower

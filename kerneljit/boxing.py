"""Results of kernels as Python objects, made without running Python code.

numba unpickles the classes of arrays and named tuples at every call, in Python. Ctrl-C can raise
an exception there; numba goes on without the class, and the process crashes.
"""

from numba.core import boxing, types
from numba.core.pythonapi import _boxers


def _constant(c, value):
    """A new reference to a Python object that is kept beside the code."""
    found = c.env_manager.read_const(c.env_manager.add_const(value))
    c.pyapi.incref(found)
    return found


def _box_named_tuple(typ, val, c):
    # the class itself would be called in Python
    make, kind = _constant(c, tuple.__new__), _constant(c, typ.instance_class)
    values = boxing.box_tuple(typ, val, c)
    made = c.pyapi.call_function_objargs(make, (kind, values))
    for one in (make, kind, values):
        c.pyapi.decref(one)
    return made


def _box_array(typ, val, c):
    api = c.pyapi
    api.serialize_object, api.unserialize = (lambda value: value), (lambda one: _constant(c, one))
    try:
        return boxing.box_array(typ, val, c)
    finally:
        del api.serialize_object, api.unserialize


def box_without_python() -> None:
    """Let what is compiled from here on, in this process, make its results so."""
    _boxers.functions |= {
        types.NamedTuple: _box_named_tuple,
        types.NamedUniTuple: _box_named_tuple,
        types.Array: _box_array,
    }

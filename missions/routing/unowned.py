"""Arrays that compiled code need not count the references to.

numba counts the references to each array that a function is given, in a tuple or alone, with an atomic operation: of a small function that
is given a plan, this is most of the time. What is taken here keeps no count; whoever calls the compiled code keeps the arrays alive.
"""

from typing import TypeVar

from llvmlite import ir
from numba.core import types
from numba.core.base import BaseContext
from numba.core.typing import Signature
from numba.extending import intrinsic

T = TypeVar("T")


def _without_owner(context: BaseContext, builder: ir.IRBuilder, kind: types.Type, value: ir.Value) -> ir.Value:
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = ir.Constant(array.meminfo.type, None)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        parts = [_without_owner(context, builder, part, builder.extract_value(value, at)) for at, part in enumerate(kind)]
        return context.make_tuple(builder, kind, parts)
    return value


@intrinsic
def unowned(typing_context: object, arrays: types.Type):  # type: ignore[no-untyped-def]
    """The same array, or tuple of arrays and tuples, for use while the caller keeps it alive."""

    def code(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
        return _without_owner(context, builder, arrays, arguments[0])

    return arrays(arrays), code

"""Arrays that compiled code need not count the references to.

numba counts the references to each array that a function is given, in a tuple or alone, with an atomic operation: of a small function that
is given a plan, this is most of the time. What is taken here keeps no count; whoever calls the compiled code keeps the arrays alive.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


def _without_owner(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = ir.Constant(array.meminfo.type, None)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        members: Any = kind
        parts = [_without_owner(context, builder, member, builder.extract_value(value, at)) for at, member in enumerate(members)]
        return context.make_tuple(builder, kind, parts)
    return value


@intrinsic
def unowned(typing_context: Any, arrays: Any) -> Any:
    """The same array, or tuple of arrays and tuples, for use while the caller keeps it alive."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _without_owner(context, builder, arrays, arguments[0])

    return arrays(arrays), code

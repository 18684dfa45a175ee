"""Exact distances over the core from hub labels: each core node knows the way to a few hubs, and two nodes meet at one of them.

Pruned landmark labelling (Akiba, Iwata and Yoshida 2013): Dijkstra's search from one node after the other, which turns back wherever
the hubs of earlier searches know a way that is not worse. The order decides how few hubs are enough; as in Delling, Goldberg, Pajor
and Werneck 2014, the next hub is the node that covers the most pairs of sampled trees of shortest ways that are not covered yet.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.network.paths.contracted_graph import ContractedGraph, FloatArray, NumberArray, edges_of_nodes

SAMPLED_TREES = 48
MAX_SAMPLED_NODES = 4_000_000  # in all trees together
MIN_TREES = 4
BLOCK = 16  # entries that a node gets room for at a time
FIRST_BLOCKS = 5  # for each node, before the pool grows
SEED = 20_130_622  # of the sample; the same graph always gives the same labels

IntArray = NDArray[np.int64]


class HubLabels(NamedTuple):
    """k core nodes, e entries; the entries of a node are sorted by hub.

    label_first  int64 (k + 1,)  where each core node's entries begin
    label_hub    int32 (e,)      the hub's place in the order
    label_chain  int32 (e,)      the first chain on the way to the hub, -1 at the hub itself
    label_cost   float64 (e,)    of the way to the hub
    label_m      float64 (e,)    metres of it
    component    int32 (k,)      number of the connected component
    """

    label_first: IntArray
    label_hub: NumberArray
    label_chain: NumberArray
    label_cost: FloatArray
    label_m: FloatArray
    component: NumberArray


def label(contracted: ContractedGraph) -> HubLabels:
    """Labels of the core's nodes by the cost of the chains."""
    tail, head, cost, length_m = contracted.chain_tail, contracted.chain_head, contracted.chain_cost, contracted.chain_m
    first, chain_at = edges_of_nodes(contracted.core_count, tail, head)
    trees = max(MIN_TREES, min(SAMPLED_TREES, MAX_SAMPLED_NODES // max(1, contracted.core_count)))
    draw = np.random.default_rng(SEED)
    roots = np.empty((trees, contracted.core_count), dtype=np.int32)
    for tree in range(trees):
        roots[tree] = draw.permutation(contracted.core_count)
    order, component = _order(first, chain_at, tail, head, cost, roots)
    arrays = (*_label(first, chain_at, tail, head, cost, length_m, order), component)
    for array in arrays:
        array.setflags(write=False)
    return HubLabels(*arrays)


@njit(cache=True, nogil=True)
def entry_at(labels: HubLabels, core: int, hub: int) -> int:
    """Return the entry of a core node that has this hub; there is one."""
    label_hub = labels.label_hub
    low: int = labels.label_first[core]
    high: int = labels.label_first[core + 1]
    while low < high:
        middle = (low + high) // 2
        if label_hub[middle] < hub:
            low = middle + 1
        else:
            high = middle
    return low


@njit(cache=True, nogil=True)
def _push(heap_key: FloatArray, heap_node: NumberArray, size: int, key: float, node: int) -> int:
    """Add to a binary heap whose least key comes first; returns the new size."""
    at = size
    while at > 0:
        above = (at - 1) >> 1
        if heap_key[above] <= key:
            break
        heap_key[at], heap_node[at] = heap_key[above], heap_node[above]
        at = above
    heap_key[at], heap_node[at] = key, node
    return size + 1


@njit(cache=True, nogil=True)
def _drop_first(heap_key: FloatArray, heap_node: NumberArray, size: int) -> int:
    """Take the first out of a binary heap; returns the new size."""
    size -= 1
    key, node = heap_key[size], heap_node[size]
    at = 0
    while True:
        below = 2 * at + 1
        if below >= size:
            break
        if below + 1 < size and heap_key[below + 1] < heap_key[below]:
            below += 1
        if heap_key[below] >= key:
            break
        heap_key[at], heap_node[at] = heap_key[below], heap_node[below]
        at = below
    heap_key[at], heap_node[at] = key, node
    return size


@njit(cache=True, nogil=True)
def _order(
    first: NumberArray, chain_at: NumberArray, tail: NumberArray, head: NumberArray, cost: FloatArray, roots: NumberArray
) -> tuple[NumberArray, NumberArray]:
    """The core's nodes, the best hub first, and the component of each.

    roots has a row for each sample: in each component the tree grows from the node that the row names first.
    """
    component, trees = _sampled_trees(first, chain_at, tail, head, cost, roots)
    return _covering_order(first, trees), component


class Trees(NamedTuple):
    """Sampled trees of shortest ways, (trees, nodes): each node's parent, its first child, the next child of its parent; -1 for none.

    below: nodes of the subtree that are not covered yet.
    """

    parent: NumberArray
    child: NumberArray
    sibling: NumberArray
    below: NumberArray


@njit(cache=True, nogil=True)
def _sampled_trees(
    first: NumberArray, chain_at: NumberArray, tail: NumberArray, head: NumberArray, cost: FloatArray, roots: NumberArray
) -> tuple[NumberArray, Trees]:
    """The component of each node, and the trees, nothing of which is covered."""
    trees, nodes = roots.shape
    component = np.full(nodes, -1, dtype=np.int32)
    parent = np.empty((trees, nodes), dtype=np.int32)
    child = np.full((trees, nodes), -1, dtype=np.int32)
    sibling = np.full((trees, nodes), -1, dtype=np.int32)
    below = np.ones((trees, nodes), dtype=np.int32)
    heap_key = np.empty(2 * len(chain_at) + nodes + 1)
    heap_node = np.empty(2 * len(chain_at) + nodes + 1, dtype=np.int32)
    reached = np.empty(nodes)
    settled = np.empty(nodes, dtype=np.int32)
    components = 0
    for tree in range(trees):
        reached[:] = np.inf
        is_settled = np.zeros(nodes, dtype=np.bool_)
        count = 0
        for root in roots[tree]:
            if is_settled[root]:
                continue
            reached[root] = 0.0
            parent[tree, root] = -1
            size = _push(heap_key, heap_node, 0, 0.0, root)
            while size:
                node = heap_node[0]
                size = _drop_first(heap_key, heap_node, size)
                if is_settled[node]:
                    continue
                is_settled[node] = True
                settled[count] = node
                count += 1
                if tree == 0:
                    component[node] = components
                for at in range(first[node], first[node + 1]):
                    chain = chain_at[at]
                    other = head[chain] if tail[chain] == node else tail[chain]
                    key = reached[node] + cost[chain]
                    if key < reached[other]:
                        reached[other] = key
                        parent[tree, other] = node
                        size = _push(heap_key, heap_node, size, key, other)
            components += 1
        for place in range(nodes - 1, -1, -1):
            node = settled[place]
            above = parent[tree, node]
            if above >= 0:
                below[tree, above] += below[tree, node]
                sibling[tree, node] = child[tree, above]
                child[tree, above] = node
    return component, Trees(parent, child, sibling, below)


@njit(cache=True, nogil=True)
def _covering_order(first: NumberArray, sampled: Trees) -> NumberArray:
    """Cover the trees greedily: next comes the node that the most pairs of nodes not covered yet lead over."""
    parent, child, sibling, below = sampled
    trees, nodes = parent.shape
    # A node's worth only falls: one that has fallen since it was put on the heap goes back with what it is worth now.
    worth = np.zeros(nodes, dtype=np.int64)
    for tree in range(trees):
        for node in range(nodes):
            worth[node] += below[tree, node]
    tie = np.empty(nodes)  # of nodes that are worth the same, the one with more chains comes first
    heap_key, heap_node = np.empty(2 * nodes + 1), np.empty(2 * nodes + 1, dtype=np.int32)
    size = 0
    for node in range(nodes):
        tie[node] = 0.5 - 0.5 / (1.0 + first[node + 1] - first[node])
        size = _push(heap_key, heap_node, size, -(worth[node] + tie[node]), node)
    order = np.empty(nodes, dtype=np.int32)
    ordered = 0
    stack = np.empty(nodes + 1, dtype=np.int32)
    while size:
        key, node = heap_key[0], heap_node[0]
        size = _drop_first(heap_key, heap_node, size)
        if -key != worth[node] + tie[node]:
            size = _push(heap_key, heap_node, size, -(worth[node] + tie[node]), node)
            continue
        order[ordered] = node
        ordered += 1
        for tree in range(trees):
            covered = below[tree, node]
            if covered == 0:
                continue
            above = parent[tree, node]
            while above >= 0:
                below[tree, above] -= covered
                worth[above] -= covered
                above = parent[tree, above]
            stack[0] = node
            height = 1
            while height:
                height -= 1
                inner = stack[height]
                if below[tree, inner] == 0:
                    continue
                worth[inner] -= below[tree, inner]
                below[tree, inner] = 0
                inner = child[tree, inner]
                while inner >= 0:
                    stack[height] = inner
                    height += 1
                    inner = sibling[tree, inner]
    return order


@njit(cache=True, nogil=True)
def _label(
    first: NumberArray,
    chain_at: NumberArray,
    tail: NumberArray,
    head: NumberArray,
    cost: FloatArray,
    length_m: FloatArray,
    order: NumberArray,
) -> tuple[IntArray, NumberArray, NumberArray, FloatArray, FloatArray]:
    nodes = len(order)
    # Each node's entries lie in a list of blocks of a pool. What the pool has not used yet takes no memory.
    blocks = nodes * FIRST_BLOCKS + 1
    used = 0
    hub, chain_of = np.empty(blocks * BLOCK, dtype=np.int32), np.empty(blocks * BLOCK, dtype=np.int32)
    entry_cost, entry_m = np.empty(blocks * BLOCK), np.empty(blocks * BLOCK)
    next_block = np.empty(blocks, dtype=np.int32)
    first_block, last_block = np.full(nodes, -1, dtype=np.int32), np.full(nodes, -1, dtype=np.int32)
    count = np.zeros(nodes, dtype=np.int32)

    heap_key, heap_node = np.empty(len(chain_at) + 2), np.empty(len(chain_at) + 2, dtype=np.int32)
    reached, flown_m = np.full(nodes, np.inf), np.empty(nodes)
    by_chain, touched = np.empty(nodes, dtype=np.int32), np.empty(nodes, dtype=np.int32)
    is_settled = np.zeros(nodes, dtype=np.bool_)
    of_root = np.full(nodes, np.inf)  # the root's cost to each hub
    for rank in range(nodes):
        root = order[rank]
        _write_root(of_root, first_block[root], count[root], next_block, hub, entry_cost, 0.0)
        reached[root], flown_m[root], by_chain[root] = 0.0, 0.0, -1
        touched[0] = root
        touches = 1
        size = _push(heap_key, heap_node, 0, 0.0, root)
        while size:
            node = heap_node[0]
            size = _drop_first(heap_key, heap_node, size)
            if is_settled[node]:
                continue
            is_settled[node] = True
            if _is_known(reached[node], first_block[node], count[node], next_block, hub, entry_cost, of_root):
                continue
            if count[node] % BLOCK == 0:
                if used == blocks:
                    blocks *= 2
                    hub, chain_of = _grown(hub, blocks * BLOCK), _grown(chain_of, blocks * BLOCK)
                    entry_cost, entry_m = _grown(entry_cost, blocks * BLOCK), _grown(entry_m, blocks * BLOCK)
                    next_block = _grown(next_block, blocks)
                if count[node] == 0:
                    first_block[node] = used
                else:
                    next_block[last_block[node]] = used
                last_block[node] = used
                next_block[used] = -1
                used += 1
            entry = last_block[node] * BLOCK + count[node] % BLOCK
            hub[entry], chain_of[entry], entry_cost[entry], entry_m[entry] = rank, by_chain[node], reached[node], flown_m[node]
            count[node] += 1
            for at in range(first[node], first[node + 1]):
                chain = chain_at[at]
                other = head[chain] if tail[chain] == node else tail[chain]
                key = reached[node] + cost[chain]
                if key < reached[other]:
                    if np.isinf(reached[other]):
                        touched[touches] = other
                        touches += 1
                    reached[other] = key
                    flown_m[other] = flown_m[node] + length_m[chain]
                    by_chain[other] = chain
                    size = _push(heap_key, heap_node, size, key, other)
        for at in range(touches):
            reached[touched[at]] = np.inf
            is_settled[touched[at]] = False
        _write_root(of_root, first_block[root], count[root], next_block, hub, entry_cost, np.inf)

    label_first = np.zeros(nodes + 1, dtype=np.int64)
    label_first[1:] = np.cumsum(count)
    # One array of the pool after the other, each of which is let go as soon as it has been copied.
    out_cost = _together(entry_cost, first_block, next_block, label_first)
    out_m = _together(entry_m, first_block, next_block, label_first)
    out_hub = _together(hub, first_block, next_block, label_first)
    out_chain = _together(chain_of, first_block, next_block, label_first)
    return label_first, out_hub, out_chain, out_cost, out_m


@njit(cache=True, nogil=True)
def _write_root(
    of_root: FloatArray,
    block: int,
    left: int,
    next_block: NumberArray,
    hub: NumberArray,
    entry_cost: FloatArray,
    added: float,
) -> None:
    """Write the cost of each entry of the root, whose entries begin in this block, plus what is added."""
    while left > 0:
        for entry in range(block * BLOCK, block * BLOCK + min(left, BLOCK)):
            of_root[hub[entry]] = entry_cost[entry] + added
        left -= BLOCK
        block = next_block[block]


@njit(cache=True, nogil=True, inline="always")
def _is_known(
    cost: float, block: int, count: int, next_block: NumberArray, hub: NumberArray, entry_cost: FloatArray, of_root: FloatArray
) -> bool:
    """Whether a node whose entries begin in this block knows a way to the root that costs no more."""
    left = count
    is_known = False
    while left > 0 and not is_known:
        for entry in range(block * BLOCK, block * BLOCK + min(left, BLOCK)):
            if of_root[hub[entry]] + entry_cost[entry] <= cost:
                is_known = True
                break
        left -= BLOCK
        block = next_block[block]
    return is_known


@njit(cache=True, nogil=True)
def _together(pool: Any, first_block: NumberArray, next_block: NumberArray, label_first: IntArray) -> Any:
    """What each node has in its blocks of the pool, one node after another."""
    entries = np.empty(label_first[-1], dtype=pool.dtype)
    for node in range(len(first_block)):
        to, end, block = label_first[node], label_first[node + 1], first_block[node]
        while to < end:
            for entry in range(block * BLOCK, block * BLOCK + min(end - to, BLOCK)):
                entries[to] = pool[entry]
                to += 1
            block = next_block[block]
    return entries


@njit(cache=True, nogil=True)
def _grown(array: Any, size: int) -> Any:
    larger = np.empty(size, dtype=array.dtype)
    larger[: len(array)] = array
    return larger

"""A mission as a manoeuvre: the orders of its items, flown in runs between two stops."""

from simulation.flight import orders as flown
from simulation.flight.course import Via
from simulation.flight.events import ItemReached, MissionEnded
from simulation.flight.guidance import Gate
from simulation.flight.manoeuvre_context import ManoeuvreContext
from simulation.flight.manoeuvres import AroundManoeuvre, Land, Manoeuvre, Return, TakeOffManoeuvre
from simulation.flight.states import FlightMode

MIN_RADIUS_M = 1.0  # corners are rounded: a waypoint is not always passed closer
STOPPED_WITHIN_M = 0.5
MAX_ORDERS_A_STEP = 50  # a list may loop by jumps without flying


class MissionManoeuvre:
    """Flies the orders from `index` on. `index` is the first that is not done; one past the last when all are."""

    mode = FlightMode.MISSION
    lifts_off = True

    def __init__(self, orders: tuple[flown.Order, ...], index: int) -> None:
        self.orders, self.index = orders, index
        self.is_done = False
        self._jumped: dict[int, int] = {}
        self._part: Manoeuvre | None = None
        self._waits_until_s: float | None = None
        self._run_end: int | None = None  # the item at which this run stops
        self._stuck: int | None = None

    @property
    def is_landing(self) -> bool:
        return self._part is not None and self._part.is_landing

    def begin(self, context: ManoeuvreContext) -> None:
        """Begin at the UAV's position. An interrupted item is started again, with the view direction of the items before it.

        Angles that an item leaves open are those of the items before.
        """
        self._part, self._waits_until_s, self._run_end = None, None, None
        done = self.orders[: self.index]
        last_target = max((index for index, order in enumerate(done) if isinstance(order, flown.LookAt)), default=0)
        for order in done[last_target:]:
            if isinstance(order, flown.LookAt | flown.PointCamera):
                self._do(context, order)
        if context.is_in_air:
            context.stand()

    def step(self, context: ManoeuvreContext) -> None:
        if self._stuck != context.faults.stuck_item and self._run_end is not None:
            self._run_end = None  # flown again from here, with another end
        for _ in range(MAX_ORDERS_A_STEP):
            if self.is_done or not self._advances(context):
                return

    def _advances(self, context: ManoeuvreContext) -> bool:
        """Advance the present order; return whether the next can begin in this step."""
        if self.index >= len(self.orders):
            self.is_done = True
            context.events.append(MissionEnded(context.now_s))
            return False
        if self._part is not None:
            return self._goes_on(context, self._part)
        if self._run_end is not None:
            return self._runs(context)
        if self._waits_until_s is not None:
            if context.now_s < self._waits_until_s - 1e-6:
                return False
            return self._reached(context)
        return self._begins(context, self.orders[self.index])

    def _begins(self, context: ManoeuvreContext, order: flown.Order) -> bool:
        if isinstance(order, flown.FlyTo | flown.FlyAround) and not context.is_in_air:
            return self._starts(context, TakeOffManoeuvre(max(context.vector_of(order.place)[2], context.settings.take_off_height_m)))
        if isinstance(order, flown.FlyTo):
            self._begin_run(context)
            return True
        if isinstance(order, flown.FlyAround):
            return self._starts(context, AroundManoeuvre(context.vector_of(order.place), order.turns, order.radius_m))
        if isinstance(order, flown.TakeOffOrder):
            height_m = context.settings.take_off_height_m if order.place.height_m is None else context.vector_of(order.place)[2]
            return self._starts(context, TakeOffManoeuvre(max(height_m, 1.0)))
        if isinstance(order, flown.LandAt | flown.ReturnHome) and not context.is_in_air:
            return self._reached(context)
        if isinstance(order, flown.LandAt):
            return self._starts(context, Land(None if order.place.position is None else context.vector_of(order.place)))
        if isinstance(order, flown.ReturnHome):
            return self._starts(context, Return())
        if isinstance(order, flown.Wait):
            self._waits_until_s = context.now_s + order.seconds
            return True
        if isinstance(order, flown.Jump):
            return self._jump(context, order)
        self._do(context, order)
        return self._reached(context)

    def _starts(self, context: ManoeuvreContext, part: Manoeuvre) -> bool:
        self._part = part
        part.begin(context)
        return False

    def _goes_on(self, context: ManoeuvreContext, part: Manoeuvre) -> bool:
        part.step(context)
        if not part.is_done:
            return False
        self._part = None
        if isinstance(part, TakeOffManoeuvre) and not isinstance(self.orders[self.index], flown.TakeOffOrder):
            return True  # an item begun on the ground is now flown to
        return self._reached(context)

    def _begin_run(self, context: ManoeuvreContext) -> None:
        """Fly through all waypoints up to the next stop, with the speeds set in between."""
        vias, gates = [], {}
        self._stuck = context.faults.stuck_item
        speed_mps, end = context.speed_mps, self.index
        for index in range(self.index, len(self.orders)):
            order = self.orders[index]
            if index == self._stuck and not isinstance(order, flown.FlyTo):
                break
            if isinstance(order, flown.FlyTo):
                place = context.vector_of(order.place)
                vias.append(Via(place, speed_mps, index))
                gates[index] = Gate(place, max(order.radius_m or context.settings.acceptance_m, MIN_RADIUS_M))
                end = index
                if order.hold_s > 0.0 or index == self._stuck or order.place.height_m is None or order.place.position is None:
                    break
            elif isinstance(order, flown.SetSpeed):
                speed_mps = min(order.speed_mps, context.airframe.max_speed_mps)
            elif isinstance(order, flown.TakeOffOrder | flown.FlyAround | flown.LandAt | flown.ReturnHome | flown.Wait | flown.Jump):
                break
        self._run_end = end
        self._turn_for(context, self.orders[self.index])
        context.fly_through(vias, gates)

    def _runs(self, context: ManoeuvreContext) -> bool:
        for mark in context.guidance.marks:
            if mark == self._run_end:
                break
            self._pass(context, mark)
        if not context.is_there(STOPPED_WITHIN_M) or self.index == context.faults.stuck_item:
            return False
        assert self._run_end is not None  # noqa: S101 - checked by the caller
        self._pass(context, self._run_end - 1)
        self._run_end = None
        order = self.orders[self.index]
        hold_s = order.hold_s if isinstance(order, flown.FlyTo) else 0.0
        if hold_s > 0.0:
            self._waits_until_s = context.now_s + hold_s
            return True
        return self._reached(context)

    def _pass(self, context: ManoeuvreContext, mark: int) -> None:
        """Complete all items up to this one, including those without a stop, then immediate items that follow."""
        while self.index <= mark:
            self._do(context, self.orders[self.index])
            if not self._reached(context):
                return
        while self.index < len(self.orders) and self._run_end is not None and self.index < self._run_end:
            order = self.orders[self.index]
            if isinstance(order, flown.FlyTo):
                self._turn_for(context, order)
                return
            self._do(context, order)
            if not self._reached(context):
                return

    def _turn_for(self, context: ManoeuvreContext, order: flown.Order) -> None:
        if isinstance(order, flown.FlyTo):
            context.heading_deg = order.heading_deg

    def _do(self, context: ManoeuvreContext, order: flown.Order) -> None:
        """Carry out an order that takes no time."""
        if isinstance(order, flown.SetSpeed):
            context.speed_mps = min(order.speed_mps, context.airframe.max_speed_mps)
        else:
            context.do(order, self.index)

    def _jump(self, context: ManoeuvreContext, order: flown.Jump) -> bool:
        done = self._jumped.get(self.index, 0)
        if order.times >= 0 and done >= order.times:
            return self._reached(context)
        self._jumped[self.index] = done + 1
        context.events.append(ItemReached(context.now_s, self.index))
        self.index = order.index
        return True

    def _reached(self, context: ManoeuvreContext) -> bool:
        if self.index == context.faults.stuck_item:
            return False
        context.events.append(ItemReached(context.now_s, self.index))
        self.index += 1
        self._waits_until_s = None
        return True


def first_to_fly(orders: tuple[flown.Order, ...], *, is_home_first: bool) -> int:
    return 1 if is_home_first and orders else 0

"""The search itself: differential evolution from the circuit's own values, with every point and the best so far told as it goes."""
import sys
import time

import numpy
from scipy.optimize import differential_evolution
from scipy.stats import qmc


class Search:
    def __init__(self, parameters, objectives, evaluations, planned, out=sys.stderr):
        self.parameters, self.objectives, self.evaluations = parameters, objectives, evaluations
        self.planned, self.out = planned, out
        self.own_cost = self.best_cost = None
        self.best_point = {}
        self.done = 0

    def own_point(self):
        """As the circuit has it."""
        measures = self.evaluations.measures({parameter.name: parameter.own_text for parameter in self.parameters})
        for objective in self.objectives:
            objective.check_against(measures[objective.protocol])
        self.own_cost = self.best_cost = self.cost_of(measures)
        return measures

    def cost_of(self, measures):
        if any(found is None for found in measures.values()):
            return float("inf")
        return sum(objective.cost(measures[objective.protocol]) for objective in self.objectives)

    def point(self, positions):
        return {parameter.name: parameter.text(position) for parameter, position in zip(self.parameters, positions)}

    def cost(self, positions):
        point = self.point(positions)
        was_known = self.evaluations.is_known(point)
        begin = time.monotonic()
        cost = self.cost_of(self.evaluations.measures(point))
        self.done += 1
        if cost < self.best_cost:
            self.best_cost, self.best_point = cost, point
        self.tell(point, cost, None if was_known else time.monotonic() - begin)
        return cost

    def tell(self, point, cost, seconds):
        values = "  ".join(f"{name}={value}" for name, value in point.items())
        took = "from the log" if seconds is None else f"{seconds:.1f} s"
        seen = "refused by the compiler" if cost == float("inf") else f"{cost:.4g}"
        print(f"{self.done}/{self.planned}  {seen}  (best {self.best_cost:.4g}, own {self.own_cost:.4g})  {values}  [{took}]",
              file=self.out, flush=True)

    def run(self, population, generations, seed):
        """True when it ran to its end, False when the population came to agree before."""
        start = qmc.LatinHypercube(d=len(self.parameters), seed=seed).random(population)
        start[0] = [parameter.own_position() for parameter in self.parameters]
        result = differential_evolution(self.cost, [(0.0, 1.0)] * len(self.parameters), init=numpy.array(start), seed=seed,
                                        maxiter=generations, polish=False)
        return not result.success

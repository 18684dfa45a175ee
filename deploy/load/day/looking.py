"""The sampler of an installation under load: a sample each time it is asked, and how often a program was another process than before."""

from deploy.load.day.sampling import Sample, sample
from deploy.load.installation import Installation


class Looking:
    def __init__(self, site: Installation) -> None:
        self._site = site
        self._pids: dict[str, int] = {}
        self.samples: list[Sample] = []
        self.restarts = 0

    def look(self) -> None:
        pids = {state.name: state.pid for state in self._site.supervisor.states() if state.pid}
        self.restarts += sum(pids.get(name) not in {None, pid} for name, pid in self._pids.items())
        self._pids = pids
        self.samples.append(sample(pids, self._site.settings["DATABASE_URL"], self._site.settings["REDIS_URL"]))

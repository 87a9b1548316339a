"""What a worker does once nobody waits for it any more: it ends, and says nothing."""

from multiprocessing import Pipe

from sheath_manip.rollout import worker
from sheath_manip.rollout.worker import Answer, serve


def test_who_asked_may_be_gone_before_the_answer(monkeypatch):
    done: list[str] = []

    def run(errand: str, workplace: object) -> Answer:
        del workplace
        done.append(errand)
        return Answer()

    monkeypatch.setattr(worker, "run_errand", run)
    monkeypatch.setattr(worker, "end_with_parent", lambda: None)
    here, theirs = Pipe()
    here.send("an errand")
    here.close()
    serve(theirs)
    assert done == ["an errand"]

"""The gate of a policy that is kept elsewhere: fitted, saved, loaded."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from sheath_manip.adapters.from_callable import from_callable
from sheath_manip.exceptions import CheckpointError, ParameterError, SheathError
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import Sources
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.learning.checkpoint_file import read_arrays, write_arrays
from sheath_manip.learning.frozen import fit_frozen_gate
from sheath_manip.learning.frozen_settings import FROZEN
from sheath_manip.learning.gate_file import gate_facts, load_gate
from sheath_manip.policies.looking_along import look_along
from sheath_manip.support.config import SupportConfig
from sheath_manip.types import Episode
from tests import frozen
from tests.blobs import SPEC as BLOBS

FAR = [6.0, -6.0]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return frozen.saved(tmp_path)


def rewritten(path: Path, **changes) -> Path:
    header, arrays = read_arrays(path)
    header.pop("digest")
    with path.open("wb") as file:
        write_arrays(file, {**header, **changes}, arrays)
    return path


class TestFit:
    def test_what_suits_is_the_latent_and_for_precedents_what_is_observed(self) -> None:
        config = frozen.fitted().fitted.config
        assert (config.signal, config.embedding) == ("near-joined", "latent")
        assert config.precedent_embedding == "scaled-features"
        observed = frozen.fitted(embed=None).fitted.config
        assert observed.embedding == "scaled-features"

    def test_new_episodes_alarm_as_often_as_asked_also_for_what_acts_in_chunks(self) -> None:
        chunks = from_callable(
            lambda o: np.repeat(frozen.steered(o.features)[None], 5, axis=0),
            action=frozen.SPEC.action,
        )
        gate = fit_frozen_gate(
            chunks,
            map(frozen.demonstration, range(8)),
            map(frozen.demonstration, range(8, 48)),
            FROZEN,
            frozen.SPEC,
            sources=Sources(),
        ).gate
        new = [look_along(chunks, frozen.demonstration(n), gate.readers) for n in range(50, 90)]
        alarms = np.concatenate([gate.scores_of(each) < gate.threshold for each in new])
        assert abs(alarms.mean() - gate.config.threshold.false_alarm_rate) < 0.04
        for seen in (frozen.seen(FAR), frozen.seen([-4, 0])):
            assert gate.judge(seen, chunks.propose(seen.alone), np.inf).score < gate.threshold

    def test_a_policy_of_chunks_looks_along_as_it_drives(self) -> None:
        calls: list[float] = []

        def act(observation):
            calls.append(float(observation.features[0]))
            return np.repeat(frozen.steered(observation.features)[None], 5, axis=0)

        episode = frozen.demonstration(3)
        seen = look_along(from_callable(act), episode)
        assert len(calls) == frozen.STEPS / 5
        shown = [step.observation.features for step in episode.steps]
        expected = np.concatenate([np.repeat(frozen.steered(x)[None], 5, 0) for x in shown[::5]])
        np.testing.assert_array_equal(seen.actions, expected)

    def test_only_labelled_steps_are_fitted_to_and_the_policy_sees_the_others_too(self) -> None:
        episode = frozen.demonstration(0)
        unasked = replace(episode.steps[1].decision, query=False)
        steps = list(episode.steps)
        steps[1] = replace(steps[1], decision=unasked)
        counted: list[object] = []
        policy = from_callable(lambda o: counted.append(o) or np.zeros(2))
        seen = look_along(policy, replace(episode, steps=tuple(steps)))
        assert (len(seen), len(counted)) == (frozen.STEPS - 1, frozen.STEPS)
        assert seen.losses is not None
        assert len(seen.losses) == len(seen)

    def test_an_instruction_of_the_recording_is_shown(self) -> None:
        told: set[str] = set()
        policy = from_callable(lambda o: told.add(o.instruction) or np.zeros(2))
        look_along(policy, frozen.demonstration(0, "to the middle"))
        assert told == {"to the middle"}

    @pytest.mark.parametrize(
        ("config", "says"),
        [
            (replace(FROZEN, kind="mixture"), "kind 'mixture' judges by nothing"),
            (replace(FROZEN, embedding="convolutions-and-pixels"), "convolutions of the house's"),
            (replace(FROZEN, embedding="pixels"), "there is no camera"),
            (replace(FROZEN, support=SupportConfig("agreeing-svm")), "where the policy is right"),
        ],
    )
    def test_what_cannot_be_fitted_is_said(self, config: GateConfig, says: str) -> None:
        with pytest.raises(ParameterError, match=says):
            frozen.fitted(config)

    def test_episodes_in_which_nothing_is_observed_are_said(self) -> None:
        def bare(number: int) -> Episode:
            episode = frozen.demonstration(number)
            nothing = np.zeros(0, np.float32)
            steps = [
                replace(step, observation=replace(step.observation, features=nothing))
                for step in episode.steps
            ]
            return replace(episode, steps=tuple(steps))

        episodes = [bare(0)]
        with pytest.raises(ParameterError, match=r"nothing that is observed.*--keys features=KEY"):
            fit_frozen_gate(
                frozen.policy(), episodes, episodes, FROZEN, frozen.SPEC, sources=Sources()
            )

    def test_a_policy_that_breaks_down_or_answers_another_size_is_said(self) -> None:
        def fit(act) -> None:
            episodes = [frozen.demonstration(0)]
            fit_frozen_gate(
                from_callable(act), episodes, episodes, FROZEN, frozen.SPEC, sources=Sources()
            )

        with pytest.raises(SheathError, match=r"the policy broke down .ZeroDivisionError: oh no"):
            fit(lambda _: exec("raise ZeroDivisionError('oh no')"))
        with pytest.raises(ParameterError, match=r"proposes \(1, 3\) where the episode's labels"):
            fit(lambda _: np.zeros(3))


class TestFile:
    def test_what_is_loaded_judges_as_what_was_saved(self, path: Path) -> None:
        made, loaded = frozen.fitted().fitted, load_gate(path, frozen.policy())
        assert loaded.fitted.config == made.config
        assert loaded.fitted.threshold == made.threshold
        assert loaded.fitted.sources == Sources(("a",), ("b", "c"))
        policy = loaded.fitted.policy
        for place in ([0.2, 0.3], FAR):
            seen = frozen.seen(place)
            proposal = policy.propose(seen.alone)
            score = made.judge(seen, proposal, np.inf).score
            assert loaded.decide(seen, proposal).score == score
        facts = gate_facts(path)
        assert facts.external == frozen.EXTERNAL
        assert facts.knows_policy
        assert facts.threshold == made.threshold

    def test_equal_content_gives_equal_bytes(self, path: Path, tmp_path: Path) -> None:
        again = frozen.fitted().save(tmp_path / "again.npz")
        assert path.read_bytes() == again.read_bytes()

    def test_another_policy_is_noticed_and_one_that_rounds_otherwise_is_none(self, path) -> None:
        with pytest.raises(CheckpointError, match="is the gate of another policy, or of other wei"):
            load_gate(path, frozen.policy(seed=1))
        with pytest.raises(CheckpointError, match="the embedding reads a latent of the policy"):
            load_gate(path, frozen.policy(embed=None))
        with pytest.raises(CheckpointError, match=r"proposes actions of shape \(3, 3\)"):
            load_gate(path, from_callable(lambda _: np.zeros(3)))
        nearly = frozen.policy()
        with torch.no_grad():
            nearly.act.module[0].weight.mul_(1 + 1e-5)  # pyright: ignore
        load_gate(path, nearly)

    def test_one_that_answers_otherwise_each_time_is_not_known_again(self, tmp_path) -> None:
        rng = np.random.default_rng(0)
        drawing = from_callable(lambda _: rng.uniform(-1, 1, 2))
        made = frozen.fitted(embed=None)
        unknown = replace(made, fitted=replace(made.fitted, policy=drawing))
        path = unknown.save(tmp_path / "drawn.npz")
        assert not gate_facts(path).knows_policy
        load_gate(path, drawing)

    def test_a_run_is_told_what_the_file_is_and_a_loop_what_a_checkpoint_is(self, path) -> None:
        with pytest.raises(CheckpointError, match=r"holds a gate alone, .*load_gate\(path, pol"):
            load_checkpoint(path, BLOBS)
        policy = {"name": "cnn", "hyper": {}}
        with pytest.raises(CheckpointError, match=r"with the policy 'cnn' in it; .* gate fit"):
            load_gate(rewritten(path, policy=policy), frozen.policy())

    @pytest.mark.parametrize(
        ("changes", "says"),
        [
            ({"external": None}, "broken: wanted fields"),
            ({"external": {}}, "broken: it has no field"),
            ({"external": {"cameras": {"top": [9]}}}, "height and a width"),
            ({"external": {"cameras": {"top": [1 << 14, 1 << 14]}}}, "wanted at most"),
            ({"external": {"feature_size": 3}}, "as many names as there are"),
            ({"external": {"space": None, "action_size": 3}}, "wanted .3, 3"),
            ({"policy": {"name": "external", "hyper": {"a": 1}}}, "hyperparameters of a policy"),
            ({"has_signal": False}, "it holds no signal"),
        ],
    )
    def test_headers_that_do_not_fit(self, changes, says, path) -> None:
        header, _ = read_arrays(path)
        if changes.get("external"):
            changes = {"external": header["external"] | changes["external"]}
        with pytest.raises(CheckpointError, match=says) as caught:
            load_gate(rewritten(path, **changes), frozen.policy())
        assert "\n" not in str(caught.value)

"""What every embedding of the table must do."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from sklearn.metrics import roc_auc_score

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.policies import (
    EMBEDDINGS,
    ENCODER_EMBEDDINGS,
    FEATURE_EMBEDDINGS,
    IMAGE_EMBEDDINGS,
    LATENT_EMBEDDINGS,
    MEASURED_EMBEDDINGS,
    SPATIAL_EMBEDDINGS,
    TOOL_EMBEDDINGS,
    embeddings_like,
    make_embedding,
    make_policy,
)
from sheath_manip.policies.looking import look
from sheath_manip.policies.spatial_embeddings import CameraConvolutions
from sheath_manip.protocols import PredictingPolicy, TrainablePolicy
from sheath_manip.support.one_class_svm import OneClassSupport
from sheath_manip.types.samples import Samples
from tests import buttons, line, reach, servo
from tests.blobs import fitted_policy, held_out, hidden_layer, training
from tests.looks import fitted_embedding, vectors_of

SPATIAL = (
    "two-scale-contrasts",
    "convolutions-and-pixels",
    "two-scale-convolutions",
    "pooled-convolutions",
    "pooled-convolutions-whitened",
    "random-convolutions",
    "pixels",
    "pixels-whitened",
)


def linear_policy() -> TrainablePolicy:
    return make_policy("linear-svm", buttons.SPEC, penalty=0.1).fit(buttons.training())


def policy_and_states(name: str) -> tuple[PredictingPolicy, Samples, Samples]:
    """What an embedding of that name looks through, is fitted to and is judged on."""
    if name in FEATURE_EMBEDDINGS:
        return linear_policy(), buttons.training(), buttons.held_out()
    if name in MEASURED_EMBEDDINGS:
        return servo.fitted_policy(), servo.training(), servo.held_out()
    if name in SPATIAL_EMBEDDINGS:
        return reach.fitted_policy(), reach.training(), reach.held_out()
    if name in TOOL_EMBEDDINGS:
        return line.fitted_policy(), line.training(), line.held_out()
    if name in LATENT_EMBEDDINGS | ENCODER_EMBEDDINGS:
        return hidden_layer(), training(), held_out()
    return fitted_policy("cnn"), training(), held_out()


@cache
def fitted(name: str):
    """The embedding of that name, fitted to the training states of its policy."""
    policy, states, _ = policy_and_states(name)
    return fitted_embedding(make_embedding(name), policy, states)


@pytest.mark.parametrize("name", sorted(EMBEDDINGS))
def test_gives_finite_vectors_one_by_one_as_in_a_batch(name):
    policy, _, samples = policy_and_states(name)
    vectors = vectors_of(fitted(name), policy, samples)
    assert vectors.shape[0] == len(samples)
    assert vectors.dtype == np.float32
    assert np.isfinite(vectors).all()
    single = vectors_of(fitted(name), policy, samples.take(np.arange(1)))
    np.testing.assert_allclose(single[0], vectors[0], atol=2e-3)


@pytest.mark.parametrize("name", sorted(EMBEDDINGS))
def test_loaded_arrays_transform_the_same(name):
    policy, _, samples = policy_and_states(name)
    one = samples.take(np.arange(5))
    loaded = make_embedding(name).load(fitted(name).arrays())
    np.testing.assert_array_equal(
        vectors_of(loaded, policy, one), vectors_of(fitted(name), policy, one)
    )


@pytest.mark.parametrize("name", sorted(EMBEDDINGS))
def test_attached_again_it_reads_the_same(name):
    policy, _, _ = policy_and_states(name)
    readers = fitted(name).attach(policy)
    assert fitted(name).attach(policy) == readers
    assert len(set(readers)) == len(readers)


def test_the_pooled_convolutions_keep_every_layer():
    one = held_out().take(np.arange(1))
    vectors = vectors_of(fitted("pooled-convolutions"), fitted_policy("cnn"), one)
    assert vectors.shape == (1, (16 + 32 + 32) * 4 * 4)


@pytest.mark.parametrize("name", ["two-scale-contrasts", "foveal-contrasts"])
def test_contrast_leaves_as_many_numbers_as_asked_for(name):
    one, embedding = held_out().take(np.arange(1)), fitted(name)
    readers = embedding.attach(fitted_policy("cnn"))
    seen = look(fitted_policy("cnn"), one, readers)
    raw = seen.of(readers)
    wide, most = {"two-scale-contrasts": (16 * 16, 64), "foveal-contrasts": (0, 32)}[name]
    assert raw.shape == (1, 32 * 4 + wide)
    kept = embedding.transform(seen).shape[1]
    assert 0 < kept <= most
    assert embedding.arrays()["matrix"].shape == (raw.shape[1], kept)


def test_random_convolutions_do_not_depend_on_the_weights():
    some = held_out().take(np.arange(3))
    plain = fitted_policy("plain-cnn")
    other = fitted_embedding(make_embedding("random-convolutions"), plain, training())
    np.testing.assert_array_equal(
        vectors_of(other, plain, some),
        vectors_of(fitted("random-convolutions"), fitted_policy("cnn"), some),
    )


@pytest.mark.parametrize("name", SPATIAL)
@pytest.mark.parametrize("change", ["shifted", "occluded"])
def test_tells_unseen_pictures_from_seen_ones(name, change):
    samples, embedding = held_out(), fitted(name)
    pictures = samples.images["top"]
    if change == "shifted":
        unseen = np.roll(pictures, -45, axis=1)
    else:
        unseen = pictures.copy()
        unseen[:, :50] = 0
    policy = fitted_policy("cnn")
    support = OneClassSupport().fit(vectors_of(embedding, policy, training()))
    scores = [
        support.decision_function(
            vectors_of(embedding, policy, replace(samples, images={"top": images}))
        )
        for images in (pictures, unseen)
    ]
    truth = np.repeat([1, 0], len(samples))
    # In float32, as a CPU without bfloat16 trains, the least of them has .988.
    assert roc_auc_score(truth, np.concatenate(scores)) > 0.98


@pytest.mark.parametrize("name", sorted(SPATIAL_EMBEDDINGS))
def test_every_view_of_several_tells_unseen_pictures_and_features_from_seen_ones(name):
    policy, samples, embedding = reach.fitted_policy(), reach.held_out(), fitted(name)
    support = OneClassSupport().fit(vectors_of(embedding, policy, reach.training()))
    black = {**samples.images, "wrist": np.zeros_like(samples.images["wrist"])}
    natural, *others = (
        support.decision_function(vectors_of(embedding, policy, states))
        for states in (
            samples,
            replace(samples, features=samples.features + 3.0),
            replace(samples, images=black),
        )
    )
    # Where nothing stands out a channel points to the middle, as it may in training.
    for unseen in others[:1] if name.startswith("image-points") else others:
        truth = np.repeat([1, 0], len(samples))
        assert roc_auc_score(truth, np.concatenate([natural, unseen])) > 0.95


@pytest.mark.parametrize("name", sorted(TOOL_EMBEDDINGS))
def test_only_an_egocentric_policy_sees_from_the_tool(name):
    with pytest.raises(ParameterError, match="needs the policy egocentric-cnn, not SpatialPolicy"):
        make_embedding(name).attach(reach.fitted_policy())


def test_a_camera_that_is_not_there_is_named():
    embedding = CameraConvolutions(cameras=("elbow",))
    with pytest.raises(
        ParameterError,
        match=r"no camera 'elbow' .* there is above,wrist; ",
    ):
        embedding.attach(reach.fitted_policy())


WITHOUT_CONVOLUTIONS = {"pixels", "pixels-whitened", "pixels-and-features"}


@pytest.mark.parametrize(
    "name", sorted((IMAGE_EMBEDDINGS | SPATIAL_EMBEDDINGS).keys() - WITHOUT_CONVOLUTIONS)
)
def test_convolutions_are_asked_for_in_one_line(name):
    asked = "policy with convolutions|policy has no convolutions|gives no 'penultimate'"
    with pytest.raises(ParameterError, match=asked) as caught:
        fitted_embedding(make_embedding(name), fitted_policy("hog-svm"), training())
    assert "\n" not in str(caught.value)
    if name != "penultimate":  # a signal's latent is no embedding, so that one suggests none
        assert "'scaled-features' where there is no camera: --gate.embedding" in str(caught.value)


def test_pixels_need_no_convolutions():
    policy = fitted_policy("hog-svm")
    embedding = fitted_embedding(make_embedding("pixels"), policy, training())
    assert vectors_of(embedding, policy, held_out().take(np.arange(1))).shape == (1, 768)


def test_features_are_not_scaled_so_that_distances_count_the_bits_that_differ():
    policy, states = linear_policy(), buttons.training()
    embedding = fitted_embedding(make_embedding("features"), policy, states)
    vectors = vectors_of(embedding, policy, states)
    differing = (states.features[0] != states.features[1]).sum()
    assert ((vectors[0] - vectors[1]) ** 2).sum() == differing > 0


def test_weighted_features_are_as_far_apart_as_the_policy_can_tell_them():
    policy, states = linear_policy(), buttons.training()
    weights = policy.arrays()["machines"][:, :-1]
    embedding = fitted_embedding(make_embedding("weighted-features"), policy, states)
    lit = np.eye(weights.shape[1], dtype=np.float32)
    lit_alone = replace(states.take(np.arange(len(lit))), features=lit)
    lengths = np.linalg.norm(vectors_of(embedding, policy, lit_alone), axis=1)
    expected = np.linalg.norm(weights, axis=0)
    np.testing.assert_allclose(lengths, expected / expected.max(), rtol=1e-5)


def test_weighted_features_want_a_policy_that_weighs_them():
    with pytest.raises(ParameterError, match="ConvPolicy does not say what it makes of each"):
        make_embedding("weighted-features").attach(fitted_policy("cnn"))


def test_embeddings_of_features_keep_out_of_a_comparison_of_images():
    assert embeddings_like("pixels") == list(IMAGE_EMBEDDINGS)
    assert embeddings_like("features") == list(FEATURE_EMBEDDINGS)
    assert embeddings_like("image-points") == list(SPATIAL_EMBEDDINGS)
    assert embeddings_like("tool-points") == list(TOOL_EMBEDDINGS)
    assert embeddings_like("latent") == list(LATENT_EMBEDDINGS)
    assert embeddings_like("scaled-features") == list(MEASURED_EMBEDDINGS)
    tables = (
        IMAGE_EMBEDDINGS,
        SPATIAL_EMBEDDINGS,
        TOOL_EMBEDDINGS,
        FEATURE_EMBEDDINGS,
        MEASURED_EMBEDDINGS,
        LATENT_EMBEDDINGS,
        ENCODER_EMBEDDINGS,
    )
    assert list(EMBEDDINGS) == [name for table in tables for name in table]


def test_unknown_name():
    with pytest.raises(UnknownNameError, match="pooled-convolutions"):
        make_embedding("pooled")

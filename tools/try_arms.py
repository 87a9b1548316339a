"""What each arm does: grasps of easy scenes, cuts of gauze, time of inverse kinematics.

    python -m tools.try_arms [--arms own ur5e ...] [--quick] [--results DIRECTORY] [--films FOLDER]

writes arms.json, from which the docs' page of arms is made; arms that are not named keep what is
in it. --films draws one grasp of each arm as GIF. Times are of the CPU on one thread.
"""

import argparse
import json
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sheath_manip.learning.first_episodes import demonstrations
from sheath_manip.playback.film import film_of
from sheath_manip.playback.frames import frames
from sheath_manip.playback.gif import gif
from sheath_manip.playback.making import drawn
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.seeding import scene_seed
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.entry import GAUZE_CUTTING
from sheath_manip.tasks.gauze_cutting.scenario import Scenario as GauzeScenario
from sheath_manip.tasks.gauze_cutting.task import GauzeTask
from sheath_manip.tasks.grasp_clutter.entry import GRASP_CLUTTER
from sheath_manip.tasks.grasp_clutter.expert import GraspExpert
from sheath_manip.tasks.grasp_clutter.scene import EASY
from sheath_manip.tasks.grasp_clutter.task import GraspTask, Scenario
from sheath_manip.tasks.robots.arm_file import house_arms, path_of, read_arm
from sheath_manip.tasks.robots.described import arm_with_blade, arm_with_gripper
from sheath_manip.tasks.robots.drive import TWIST_SCALE
from sheath_manip.tasks.robots.jaco import JACO_WITH_BLADE, JACO_WITH_JAW
from sheath_manip.tasks.robots.motions import lacking
from sheath_manip.tasks.robots.own_arm import ARM_WITH_BLADE, ARM_WITH_JAW
from sheath_manip.tasks.robots.robot import RobotDescription
from sheath_manip.types import Outcome, Purpose

SEEDS = "arms"
"""of scenes that no tuning has seen, but that of these arms"""
OWN = {
    "own": ("the house's arm with its jaw", "MIT", "sheath-manip"),
    "jaco": ("Kinova's Jaco with the same jaw", "Apache-2.0", "dm-control"),
}
"""title, licence and package of the arms that are no files"""
_EVERY = 2
"""steps, a frame of a film"""


@dataclass(frozen=True)
class Sizes:
    """How much is tried."""

    grasps: int = 20
    cuts: int = 5


QUICK = Sizes(grasps=1, cuts=1)


def robots_of(arm: str) -> tuple[RobotDescription, RobotDescription]:
    """Return the arm with its gripper, and with the knife."""
    if arm == "own":
        return ARM_WITH_JAW, ARM_WITH_BLADE
    if arm == "jaco":
        return JACO_WITH_JAW, JACO_WITH_BLADE
    return arm_with_gripper(arm), arm_with_blade(arm)


def grasps(robot: RobotDescription, scenes: int) -> dict[str, object]:
    """The expert's grasps of easy scenes, without cameras."""
    task = GraspTask(Scenario(difficulty=EASY, robot=robot, cameras=()))
    environment = ComposerEnvironment(task)
    expert = GraspExpert(environment)
    outcomes, limits = Counter[str](), Counter[str]()
    draws, spent, steps, deepest_m = list[int](), list[float](), 0, 0.0
    for number in range(scenes):
        observation = environment.reset(scene_seed(Purpose.EVALUATION, SEEDS, number))
        expert.reset()
        draws.append(task.draws)
        ended = False
        while not ended:
            start = time.process_time()
            action = expert.act(observation)
            # What the drive makes of the action once more: two solutions a step.
            task.drive.control.joint_targets(task.drive.targets_rad(), action[:6] * TWIST_SCALE)
            spent.append(time.process_time() - start)
            transition = environment.step(action)
            observation, steps = transition.observation, steps + 1
            contact = environment.physics.data.ptr.contact
            deepest_m = min(deepest_m, float(contact.dist.min(initial=0.0)))
            if transition.commanded is not None:
                limits.update(each.limit for each in transition.commanded.limited)
            ended = transition.terminated or transition.truncated
        outcomes[environment.outcome().value] += 1
    environment.close()
    return {
        "scenes": scenes,
        "grasped": outcomes[Outcome.SUCCESS.value],
        "toppled": outcomes[Outcome.FAILURE.value],
        "scenes_drawn": sum(draws),
        "deepest_contact_mm": -1e3 * deepest_m,
        "seconds": steps * 0.05 / scenes,
        "ik_ms": 1e3 * float(np.mean(spent)),
        "ik_ms_95": 1e3 * float(np.quantile(spent, 0.95)),
        "limited_share": {name: count / steps for name, count in sorted(limits.items())},
    }


def cuts(robot: RobotDescription, scenes: int) -> dict[str, object]:
    """The expert's cuts of gauze, without cameras."""
    environment = ComposerEnvironment(GauzeTask(GauzeScenario(robot=robot, cameras=())))
    expert = GAUZE_CUTTING.expert(environment)
    figures = list[dict[str, float]]()
    for number in range(scenes):
        observation = environment.reset(scene_seed(Purpose.EVALUATION, SEEDS, number))
        ended = False
        while not ended:
            transition = environment.step(expert.act(observation))
            observation = transition.observation
            ended = transition.terminated or transition.truncated
        figures.append(dict(environment.metrics()))
    environment.close()
    return {
        "scenes": scenes,
        "freed": int(sum(each["freed"] for each in figures)),
        "iou": float(np.mean([each["iou"] for each in figures])),
        "deviation_mm": float(np.mean([each["deviation_mm"] for each in figures])),
    }


def tried(arm: str, sizes: Sizes) -> dict[str, object]:
    """All that is told of an arm."""
    gripper, knife = robots_of(arm)
    title, licence, package = OWN[arm] if arm in OWN else _told(arm)
    with single_threaded():
        return {
            "title": title,
            "licence": licence,
            "package": package,
            "joints": len(gripper.home_rad),
            "lacks": list(lacking(gripper)),
            "grasp": grasps(gripper, sizes.grasps),
            "gauze": cuts(knife, sizes.cuts),
        }


def film_of_grasp(arm: str) -> bytes:
    """Return the GIF of one grasp, from the film maker that makes all films."""
    variant = "easy" if arm == "own" else f"easy@{arm}"
    episode = demonstrations(GRASP_CLUTTER, 1, variant)[0]
    environment = GRASP_CLUTTER.make(variant)
    film = film_of(environment, episode)
    # The end is shown in any case.
    moments = [*range(0, len(film), _EVERY), len(film)]
    pictures = drawn(GRASP_CLUTTER, environment, film)
    assert pictures is not None
    shown = list(frames(film.trace.so_far(), film.outcome, pictures, moments=moments))
    environment.close()
    return gif(shown, 1000 * _EVERY / film.info.control_rate_hz, (0, len(shown) // 2, -1))


def main(arguments: Sequence[str] | None = None) -> None:
    """Try, print a line an arm, write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    every = [*OWN, *house_arms()]
    parser.add_argument("--arms", nargs="+", default=every, help="names, or files")
    parser.add_argument("--quick", action="store_true", help="one scene each")
    parser.add_argument("--results", type=Path, default=Path("results"))
    parser.add_argument("--films", type=Path, help="folder for one GIF an arm, and nothing else")
    options = parser.parse_args(arguments)
    path = options.results / "arms.json"
    found = json.loads(path.read_text()) if path.exists() else {}
    for arm in options.arms:
        if options.films is not None:
            (options.films / f"robot-{Path(arm).stem}.gif").write_bytes(film_of_grasp(arm))
            continue
        found[Path(arm).stem] = tried(arm, QUICK if options.quick else Sizes())
        print(arm, json.dumps(found[Path(arm).stem]), flush=True)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(found, indent=2) + "\n")


def _told(arm: str) -> tuple[str, str, str]:
    told = read_arm(path_of(arm))
    return told.title, told.licence, "" if told.package is None else told.package.package


if __name__ == "__main__":
    main()

"""What both pages show and measure; ``guided_scenes.yaml`` holds it."""

from importlib.resources import files
from typing import Any

from furuta.quantities import QUANTITIES
from furuta.settings.nodes import FRICTION_OBSERVER
from furuta_ros.yaml_files import parse_yaml

FILE = "guided_scenes.yaml"
CONTENT = parse_yaml(files(__package__).joinpath(FILE).read_text(encoding="utf-8"), FILE)
# Plain name and symbol of each parameter in sight.
IN_SIGHT: dict[str, dict[str, Any]] = CONTENT["in_sight"]
COMPENSATION = f"{FRICTION_OBSERVER}.compensation"


def scenes() -> list[dict[str, Any]]:
    """The scenes with their steps; what is always set is part of each one's settings."""
    return [
        scene
        | {
            "steps": [
                step | {"settings": CONTENT["always"] | step.get("settings", {})}
                for step in scene["steps"]
            ]
        }
        for scene in CONTENT["scenes"]
    ]


def scene_names() -> list[str]:
    """Full names of all parameters that the steps of scenes change."""
    steps = [step for scene in scenes() for step in scene["steps"]]
    own = {name for step in steps for name in (*step["settings"], *step.get("times", {}))}
    return sorted(own)


def page_content() -> dict[str, Any]:
    """What the page over a graph shows; it learns the rest from the nodes."""
    shown = {name: CONTENT[name] for name in ("measured", "what_if", "words")}
    look = {name: each._asdict() for name, each in QUANTITIES.items()}
    return shown | {"scenes": scenes(), "names": scene_names(), "quantities": look}

"""Why the robot asks: a sentence and figures at once, and all that there is in a tab."""

from sheath_manip.dashboard import explanation_markup
from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.explainer import Explainer
from sheath_manip.dashboard.markup import caption, note
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext

NOTHING = (
    "At a request, and in a recording wherever it stands, this says which signal rang, shows the "
    "training states most like the present one, and what the expert did there."
)


class Why:
    """The sentence and the figures, while there is something to ask about."""

    def __init__(self, context: WidgetContext, explainer: Explainer) -> None:
        self._explainer = explainer
        self._spec = context.spec.action
        explainer.on_change = context.wake
        self._box = context.viser.gui.add_html("", visible=False)
        self._shown: object = None

    def draw(self, snapshot: Snapshot) -> None:
        """Show the moment's explanation, once it is there."""
        found = self._explainer.ask(snapshot)
        if found is not None and found.explanation is not self._shown:
            self._shown = found.explanation
            text = explanation_markup.sentence(found.explanation)
            self._box.content = text + explanation_markup.figures(found.explanation, self._spec)
        set_changed(self._box, visible=found is not None)


class WhyDetails:
    """What the score is made of, and the actions side by side."""

    def __init__(self, context: WidgetContext, explainer: Explainer) -> None:
        self._explainer = explainer
        self._spec = context.spec.action
        context.viser.gui.add_html(caption("Why", "what the gate has against the proposal"))
        self._box = context.viser.gui.add_html(note(NOTHING))
        self._shown: object = None

    def draw(self, snapshot: Snapshot) -> None:
        """Show the moment's signals and actions; the last ones stay until there are others."""
        found = self._explainer.ask(snapshot)
        if found is None or found.explanation is self._shown:
            return
        self._shown = explanation = found.explanation
        text = explanation_markup.signals(explanation)
        self._box.content = text + explanation_markup.actions(explanation, self._spec)

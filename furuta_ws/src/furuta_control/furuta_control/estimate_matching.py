"""Which friction estimate answers which state.

Estimates carry no stamp. The observer sends one for every state that it receives, so they are
matched by counting. Around a repeated state counting is not enough: of the states and estimates
some are lost, some come twice, and an estimate can come before its state. There an estimate that
was sent before the state is an old one, because an observer answers what it has received.
"""

from enum import Enum, auto

# An estimate that was sent so long [ns] after its state belongs to the next one. Shorter than what
# a plant in lock-step waits until it goes on although some repetitions are without an answer.
REPETITION_TIME = 1_000_000_000
# Estimates in a row that were sent before the state they should answer, until it is said.
SUSPICIOUS = 3


class Answer(Enum):
    """What to do about a state or an estimate that has arrived."""

    NONE = auto()
    """Wait."""
    STEP = auto()
    """Compute the command for the state with the estimate ``friction``, and publish it."""
    STEP_WITHOUT = auto()
    """The same, but the estimate is late: ``friction`` belongs to an earlier state."""
    CORRECT = auto()
    """The late estimate is here, and no newer state: ``STEP`` in place of ``STEP_WITHOUT``."""
    AGAIN = auto()
    """Publish the last command again: the state was repeated, and so was its estimate."""


class EstimateMatching:
    """Matches friction estimates to states.

    If a state arrives before the estimate for the previous one, that estimate is late: the new
    state is answered at once, and the late estimate is not taken for a later state. If
    ``in_transit`` estimates in a row are late, as many as can be on the way, they count as lost.

    For each repetition of a state (same stamp) the command is published once more when its
    estimate has arrived. So whoever repeats it knows that nothing is left on the way.

    Attributes:
        friction: Estimate that was taken last [V].
        missed: Number of states that were answered without their estimates.
        refused_in_a_row: Number of estimates since the last answer that were older than the state.
    """

    def __init__(self, in_transit: int) -> None:
        self._in_transit = in_transit
        self.friction = 0.0
        self.missed = 0
        self.refused_in_a_row = 0
        self._sent = 0  # when the state was sent first
        self._sent_last = 0  # and when it was repeated last
        self._expected = 0  # estimates for the states so far
        self._stepped = False  # whether the state has its command
        self._repetitions = 0  # of the state, whose estimates have not arrived
        self._early: tuple[float, int] | None = None  # estimate before its state, and when sent
        self._missed_in_a_row = 0
        self._any_state = False
        # Whether this state, or the one before it, was repeated or is the first of a motion.
        self._uncertain = self._previous_uncertain = True

    @property
    def suspicious(self) -> bool:
        """Whether estimates keep being older than the state, as if two clocks differed."""
        return self.refused_in_a_row >= SUSPICIOUS

    def state(self, sent: int, anew: bool = False) -> Answer:
        """A state that was sent at ``sent`` [ns]; ``anew`` if it does not continue the motion."""
        self._previous_uncertain, self._uncertain = self._uncertain, anew or not self._any_state
        self._any_state = True
        self._sent = self._sent_last = sent
        # An older estimate is recognised after an uncertain state: none is waited for.
        self._expected = 1 if anew or self._previous_uncertain else self._expected + 1
        self._stepped = False
        self._repetitions = 0
        if self._takes_early():
            self._expected -= 1
        if self._expected == 0:
            return self._step()
        if self._expected == 1:
            return Answer.NONE
        self.missed += 1
        self._missed_in_a_row += 1
        if self._missed_in_a_row >= self._in_transit:
            self._expected = 1
        self._stepped = True
        return Answer.STEP_WITHOUT

    def repetition(self, sent: int) -> Answer:
        """The same state again, sent at ``sent`` [ns]."""
        self._uncertain = True
        self._sent_last = sent
        if self._stepped and self._takes_early():
            return Answer.AGAIN
        self._repetitions += 1
        return Answer.NONE

    def estimate(self, friction: float, sent: int) -> Answer:
        """An estimate [V] that was sent at ``sent`` [ns]."""
        if self._is_old(sent):
            self.refused_in_a_row += 1
            return Answer.NONE
        if sent < self._sent_last + REPETITION_TIME:
            if self._expected > 0:
                self.friction = friction
                self._expected -= 1
                return self._step() if self._expected == 0 else Answer.NONE
            if self._repetitions > 0:
                self._repetitions -= 1
                return Answer.AGAIN
        self._early = (friction, sent)
        return Answer.NONE

    def _step(self) -> Answer:
        answer = Answer.CORRECT if self._stepped else Answer.STEP
        self._stepped = True
        self._missed_in_a_row = 0
        self.refused_in_a_row = 0
        return answer

    def _takes_early(self) -> bool:
        """Take the estimate that came before its state, unless it is an old one."""
        if self._early is None:
            return False
        (friction, sent), self._early = self._early, None
        if self._is_old(sent):
            return False
        self.friction = friction
        return True

    def _is_old(self, sent: int) -> bool:
        """Whether an estimate answers an earlier state, where counting is not enough.

        Otherwise only if it is much older, as that of a repetition which did not arrive here: the
        clocks of two computers may differ a little.
        """
        uncertain = self._uncertain or self._previous_uncertain
        return sent < self._sent - (0 if uncertain else REPETITION_TIME)

"""The parameter services of a node, which give way to its samples."""

from collections.abc import Callable, Sequence
from time import monotonic

from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_service import ParameterService

# Changes per second that a process makes in the long run, and at once.
RATE, BURST = 50.0, 20.0


class Allowance:
    """Permits ``RATE`` changes per second, and ``BURST`` at once."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._left, self._at = BURST, clock()

    def take(self) -> bool:
        """Whether one more change is permitted now."""
        now = self._clock()
        self._left = min(BURST, self._left + RATE * (now - self._at))
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


# All nodes of a process share a thread with its samples.
_allowance = Allowance()


class FurutaParameterService(ParameterService):
    """Refuses changes beyond a rate, and those that ROS cannot read, with a reason.

    Without ``limited`` it accepts any number, for a node that may be late.
    """

    def __init__(self, node: Node) -> None:
        super().__init__(node)
        self.limited = True

    def _set_parameters_callback(
        self, request: SetParameters.Request, response: SetParameters.Response
    ) -> SetParameters.Response:
        """Set each parameter by itself; all at once if they are valid, which costs one change."""
        together = self._change(request.parameters)
        separate = not together.successful and len(request.parameters) > 1
        response.results = [
            self._change([parameter]) if separate else together for parameter in request.parameters
        ]
        return response

    def _set_parameters_atomically_callback(
        self, request: SetParametersAtomically.Request, response: SetParametersAtomically.Response
    ) -> SetParametersAtomically.Response:
        response.result = self._change(request.parameters)
        return response

    def _change(self, messages: Sequence[ParameterMessage]) -> SetParametersResult:
        """Set all of the parameters or none."""
        if self.limited and not _allowance.take():
            return _refused(f"more than {RATE:g} changes of parameters per second; try again")
        try:
            given = [Parameter.from_parameter_msg(message) for message in messages]
            return self._get_node().set_parameters_atomically(given)
        except (ParameterException, ValueError) as error:
            return _refused(str(error))


def _refused(reason: str) -> SetParametersResult:
    return SetParametersResult(successful=False, reason=reason)

"""The program of a `Guard`'s child process: simulates what comes through a pipe until that is closed."""

import os
import sys
from multiprocessing.connection import Connection

from divideropt.campaign.load import parse_campaign
from divideropt.campaign.parentage import end_with_parent
from divideropt.campaign.plan import build_problem


def main(descriptor: int) -> None:
    """Serve the pipe: the campaign's text first, then designs, each answered by their evaluations."""
    os.set_inheritable(descriptor, False)  # what the model starts shall not keep it open
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # standard output is the command's
    end_with_parent()
    link = Connection(descriptor)
    problem = build_problem(parse_campaign(link.recv()))
    link.send(None)
    while True:
        try:
            designs = link.recv()
        except EOFError:
            return
        link.send(problem.simulate(designs))


if __name__ == "__main__":
    main(int(sys.argv[1]))

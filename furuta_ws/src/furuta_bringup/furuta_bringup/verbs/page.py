"""``furuta page``."""

from pathlib import Path

import click

from furuta_bringup.options import option


@click.command()
@option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    default=Path("furuta.html"),
    help="File to write.",
)
@option("--no-open", is_flag=True, help="Open no browser.")
def command(out: Path, no_open: bool) -> None:
    """Open the simulation in a browser: pendulum, charts, and five lessons.

    It needs neither ROS nor a network: the page is one file, which computes the closed loop itself.
    Give it to others, also for a phone. Its path is printed on standard output.
    """
    from furuta_bringup.page.one_file import one_file, open_in_browser
    from furuta_ros.whole_files import whole_file

    with whole_file(out) as path:
        path.write_bytes(one_file())
    print(out, flush=True)
    if not no_open:
        open_in_browser(out.absolute().as_uri())

"""Groups of commands, alike in all versions of click."""

import click


class HelpfulGroup(click.Group):
    """A group that without arguments shows its help on standard error, with exit status 2.

    click itself does so since 8.2; before, it shows the help as a result.
    """

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Show the help if there is nothing to parse."""
        if not args and not ctx.resilient_parsing:
            click.echo(ctx.get_help(), err=True)
            ctx.exit(2)
        return super().parse_args(ctx, args)

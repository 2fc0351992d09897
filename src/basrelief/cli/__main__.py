"""`python -m basrelief.cli` is the command `basrelief`."""

from basrelief.cli.main import main

main()

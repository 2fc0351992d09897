"""`python -m basrelief` is the command `basrelief`."""

from basrelief.cli.main import main

main()

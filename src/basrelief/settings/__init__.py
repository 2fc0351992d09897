"""Settings of the records that users fill in: declarations, and the values of enumerations.

It lies below all other packages and imports little, since the command line's help needs it.
"""

from basrelief.settings.declaration import (
    Setting,
    check_choice,
    check_choices,
    parameters_of,
    setting,
    settings_of,
)

__all__ = ["Setting", "check_choice", "check_choices", "parameters_of", "setting", "settings_of"]

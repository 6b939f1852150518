# SPDX-License-Identifier: GPL-3.0-or-later
class Refused(Exception):
    """What cannot be baked, in a sentence that names the object and what to change."""

"""Is a machine safe to touch? Its ports, and what it does there whatever touches it."""

from symflex.contact.port import at_port, with_branch

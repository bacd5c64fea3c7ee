"""What a cycloidal disc's own flexibility adds to the twist, by plane finite elements."""

"""From a study to a drive: compare drives side by side, best variants, templates of files."""

"""Text of scene files."""


class Writer:
    """XML text with indentation."""

    def __init__(self):
        self.lines = []

    def add(self, depth, text):
        self.lines.append("  " * depth + text)


class Channel:
    """One attribute: `constant`, or the lines of its <animate>."""

    def __init__(self, name, constant=None, animate=None):
        self.name, self.constant, self.animate = name, constant, animate


def write_element(out, depth, tag, attributes, channels, closing_lines=()):
    """An element with its constant attributes, then its animated channels."""
    words = [f'{name}="{value}"' for name, value in attributes]
    words += [f'{c.name}="{c.constant}"' for c in channels if c.animate is None]
    inner = [line for c in channels if c.animate for line in c.animate] + list(closing_lines)
    start = " ".join([f"<{tag}"] + words)
    if not inner:
        out.add(depth, start + "/>")
        return
    out.add(depth, start + ">")
    for line in inner:
        out.add(depth + 1, line)
    out.add(depth, f"</{tag}>")

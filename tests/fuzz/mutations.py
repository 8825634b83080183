"""Changes of a document that keep most of its form, so that they reach what lies behind parsing."""

import re

from hypothesis import strategies as st

WORDS = [
    b"", b"0", b"-1", b"1e400", b"NaN", b"INF", b"18446744073709551616", b"true", b'"', b"'", b"<",
    b">", b"&amp;", b"&#0;", b"\0", b"\xff", b"\xef\xbb\xbf", b"\n", b"\r", b",", b";", b"=", b"[",
    b"]", b"{", b"}", b".", b"/", b"..", b"\\", b"%n", b"9" * 400, b"a" * 5000, b"\xc3\xa4",
    b"[[", b"#", b"1 2 3", b"<!--", b"<![CDATA[", b"0x10", b"1_000", b"1979-05-27", b"inf", b"nan",
]  # fmt: skip
_TOKEN = re.compile(rb"\w+|[^\w\s]")


@st.composite
def changed(draw: st.DrawFn, examples: list[bytes]) -> bytes:
    """One of `examples` with a few tokens replaced, removed, repeated or exchanged."""
    content = draw(st.sampled_from(examples))
    for _ in range(draw(st.integers(0, 4))):
        tokens = [match.span() for match in _TOKEN.finditer(content)]
        if not tokens:
            return content
        first, last = tokens[draw(st.integers(0, len(tokens) - 1))]
        how = draw(st.sampled_from(["word", "other", "cut", "repeat", "end", "bytes"]))
        if how == "word":
            new = draw(st.sampled_from(WORDS))
        elif how == "other":
            start, end = tokens[draw(st.integers(0, len(tokens) - 1))]
            new = content[start:end]
        elif how == "cut":
            start, end = tokens[draw(st.integers(0, len(tokens) - 1))]
            first, last, new = min(first, start), max(last, end), b""
        elif how == "repeat":
            start, end = tokens[draw(st.integers(0, len(tokens) - 1))]
            first, last = min(first, start), max(last, end)
            new = content[first:last] * draw(st.integers(2, 3))
        elif how == "end":
            last, new = len(content), b""
        else:
            new = draw(st.binary(max_size=12))
        content = content[:first] + new + content[last:]
    return content

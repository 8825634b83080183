"""Table 2 of Ahn & Truong 2009, transcribed a second time from its rows as printed."""

from controllers.papers.ahn2009.fuzzy_pid import TABLE_2

# Rows |e| = Z, VS, S, M, B; columns |de| = Z, VS, S, M, B; entries (U_p,U_i,U_d).
PRINTED = """
(VS,B,M) (VS,B,M) (Z,B,M)   (Z,B,B)   (Z,B,B)
(VS,B,S) (VS,B,M) (VS,B,M)  (Z,M,M)   (Z,M,B)
(S,M,VS) (S,M,VS) (S,M,VS)  (VS,S,S)  (VS,S,S)
(M,Z,Z)  (M,Z,Z)  (M,VS,VS) (S,VS,VS) (S,VS,VS)
(B,Z,Z)  (B,Z,Z)  (B,Z,Z)   (B,Z,Z)   (M,Z,Z)
"""


def test_every_entry() -> None:
    rows = [line.split() for line in PRINTED.strip().splitlines()]
    expected = tuple(tuple(tuple(cell.strip("()").split(",")) for cell in row) for row in rows)
    assert expected == TABLE_2
